'use strict';
// The animation of landings; figures over time follow it.
const fall = (() => {
  const element = (name, parent, text) => {
    const node = parent.appendChild(document.createElement(name));
    if (text !== undefined) node.textContent = text;
    return node;
  };
  const circled = n => n <= 20 ? String.fromCodePoint(0x245f + n) : '(' + n + ')';

  // Index of the last row at or before a time, and the fraction of the interval to the next row. Of the two rows of an event it
  // is the second, after the jump. Times are rounded to 1 us.
  const findRow = (times, t) => {
    const rounding = 1e-6;
    let low = 0, high = times.length - 1;
    if (t >= times[high]) return [high, 0];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (times[middle] <= t + rounding) low = middle; else high = middle;
    }
    const step = times[high] - times[low];
    return [low, step > 0 ? Math.max(0, (t - times[low]) / step) : 0];
  };

  // Interpolates columns of a landing between row i and the next.
  const between = (l, i, part) => {
    const k = Math.min(i + 1, l.t.length - 1);
    return column => column[i] + part * (column[k] - column[i]);
  };

  // Hip, knee and foot of a posture; (x, y) is the middle of the thigh.
  const posture = (x, y, phi0, phi1, length) => {
    const a = length / 2, s = Math.sin(phi0), c = Math.cos(phi0), s1 = Math.sin(phi0 + phi1), c1 = Math.cos(phi0 + phi1);
    const knee = [x + a * s, y - a * c];
    return [[x - a * s, y + a * c], knee, [knee[0] + length * s1, knee[1] - length * c1]];
  };
  // Links, contacts and traced point of a landing at one time; `mix` interpolates a column.
  const shape = (l, mix, length) => {
    if (!l.links) {
      const p = posture(mix(l.x), mix(l.y), mix(l.phi_0), mix(l.phi_1), length);
      return {links: [p.slice(0, 2), p.slice(1)], joints: p, trace: p[0]};
    }
    const at = (k, [along, across]) => {
      const theta = mix(k.theta), s = Math.sin(theta), c = Math.cos(theta);
      return [mix(k.x) + along * s + across * c, mix(k.y) - along * c + across * s];
    };
    return {links: l.links.map(k => k.points.map(p => at(k, p))), joints: l.contacts.map(c => at(l.links[c.link], c.at)),
            trace: at(l.links[l.peak.link], l.peak.at)};
  };
  const points = list => list.map(p => p[0].toFixed(4) + ',' + (-p[1]).toFixed(4)).join(' ');

  const names = ['hip', 'knee', 'foot'];

  class Stage {
    constructor(landing, box, forceScale, parent) {
      this.landing = landing;
      this.names = landing.contacts ? landing.contacts.map(c => c.name) : names;
      this.forceScale = forceScale;
      const stage = element('div', parent);
      stage.className = 'stage';
      element('strong', stage, landing.name);
      const svg = make('svg', {viewBox: [box.x0, -box.y1, box.x1 - box.x0, box.y1 - box.y0].join(' '), role: 'img',
                               'aria-label': 'animation: ' + landing.name}, stage);
      const slope = landing.slope || 0;
      make('line', {x1: box.x0, x2: box.x1, y1: -slope * box.x0, y2: -slope * box.x1, class: 'ground'}, svg);
      if (landing.rail) {
        const [x, y] = [landing.links[0].x[0], landing.links[0].y[0]], [dx, dy] = landing.rail;
        make('line', {x1: x - 9 * dx, y1: -y + 9 * dy, x2: x + 9 * dx, y2: -y - 9 * dy, class: 'ghost'}, svg);
      }
      this.ghosts = (landing.ghosts || []).map(ghost => [ghost, make('polyline', {class: 'ghost'}, svg)]);
      this.trace = make('polyline', {class: 'trace'}, svg);
      const count = landing.links ? landing.links.length : 2;
      this.links = Array.from({length: count}, (_, k) => make('polyline', {class: k === count - 1 ? 'link shank' : 'link'}, svg));
      this.target = landing.links && make('circle', {r: .012, class: 'target'}, svg);
      this.forces = this.names.map(() => [make('line', {class: 'force'}, svg), make('path', {class: 'head'}, svg)]);
      this.joints = this.names.map(() => make('circle', {r: .016, class: 'point'}, svg));
      this.badge = make('text', {class: 'badge'}, svg);
      this.said = element('div', stage);
      this.said.className = 'said';
      this.traced = landing.t.map((_, i) => this.at(i, 0).trace);
    }
    at(i, part) {
      const l = this.landing, mix = between(l, i, part), degrees = phi => (mix(phi) * 180 / Math.PI).toFixed(1) + '°';
      return {...shape(l, mix, l.length), acceleration: mix(l.acc), forces: l.force.map(f => [mix(f[0]), mix(f[1])]),
              angles: l.links ? l.joints.map(j => j.name + ' ' + degrees(j.phi)).join(', ') : 'joint ' + degrees(l.phi_1)};
    }
    show(t) {
      const [i, part] = findRow(this.landing.t, t), frame = this.at(i, part);
      this.links.forEach((line, k) => line.setAttribute('points', points(frame.links[k])));
      for (const [ghost, line] of this.ghosts)
        line.setAttribute('points', points(shape(ghost, between(ghost, ...findRow(ghost.t, t)), this.landing.length).joints));
      this.trace.setAttribute('points', points(this.traced.slice(0, i + 1).concat([frame.trace])));
      if (this.target) this.target.setAttribute('cx', frame.trace[0]), this.target.setAttribute('cy', -frame.trace[1]);
      const touching = [];
      this.names.forEach((name, j) => {
        const [x, y] = frame.joints[j], force = frame.forces[j], size = Math.hypot(force[0], force[1]);
        this.joints[j].setAttribute('cx', x);
        this.joints[j].setAttribute('cy', -y);
        this.joints[j].classList.toggle('touches', size > 0);
        const [line, head] = this.forces[j], shown = size > 0;
        line.style.display = head.style.display = shown ? '' : 'none';
        if (!shown) return;
        touching.push(name + ' ' + size.toFixed(0) + ' N');
        const s = this.forceScale, ex = x + force[0] * s, ey = -(y + force[1] * s), ux = force[0] / size, uy = -force[1] / size;
        for (const [key, value] of [['x1', x], ['y1', -y], ['x2', ex], ['y2', ey]]) line.setAttribute(key, value);
        head.setAttribute('d', `M${ex + ux * .03} ${ey + uy * .03}L${ex - uy * .014} ${ey + ux * .014}L${ex + uy * .014} ${ey - ux * .014}Z`);
      });
      const peak = this.landing.peaks.find(p => Math.abs(p.t - t) < 1e-3);
      // Two events may be closer than the rounding of times: at a peak its value is exact.
      if (peak && Math.abs(peak.t - t) < 2e-6) frame.acceleration = peak.acceleration;
      this.badge.textContent = peak ? circled(peak.n) : '';
      this.badge.setAttribute('x', frame.trace[0]);
      this.badge.setAttribute('y', -frame.trace[1] - .05);
      this.said.textContent = `${this.target ? '|a|' : '|ddr_0|'} ${frame.acceleration.toFixed(1)} m/s², ${frame.angles}` +
        (touching.length ? ', floor: ' + touching.join(', ') : ', in the air') +
        (peak ? `; peak ${circled(peak.n)} of contact ${peak.contact}: ${peak.acceleration.toFixed(1)} m/s²` : '');
    }
  }

  const bounds = landings => {
    const box = {x0: Infinity, x1: -Infinity, y0: -.06, y1: .1};
    const ghosts = landings.flatMap(l => (l.ghosts || []).map(g => ({...g, length: l.length})));
    for (const l of landings.concat(ghosts))
      for (let i = 0; i < l.t.length; ++i)
        for (const [x, y] of shape(l, column => column[i], l.length).links.flat()) {
          box.x0 = Math.min(box.x0, x - .06), box.x1 = Math.max(box.x1, x + .06);
          box.y0 = Math.min(box.y0, y - .03), box.y1 = Math.max(box.y1, y + .12);
        }
    return box;
  };

  class Player {
    constructor(data, parent) {
      this.end = Math.max(...data.landings.map(l => l.t[l.t.length - 1]));
      curves.onTime(t => { this.pause(); this.show(t); });
      const stages = element('div', parent);
      stages.className = 'stages';
      const box = bounds(data.landings), maxForce = Math.max(1e-9, ...data.landings.flatMap(l => l.force.flatMap(f => f[1])));
      this.stages = data.landings.map(l => new Stage(l, box, .3 / maxForce, stages));
      this.stops = data.landings[0].peaks.map(p => p.t);
      this.build(parent, data.landings[0].peaks);
      this.show(this.stops.length ? data.landings[0].peaks.reduce((a, b) => b.acceleration > a.acceleration ? b : a).t : 0);
    }
    build(parent, peaks) {
      const controls = element('div', parent);
      controls.className = 'controls';
      this.button = element('button', controls, 'Play');
      this.button.type = 'button';
      this.slider = element('input', controls);
      Object.assign(this.slider, {type: 'range', min: 0, max: this.end, step: 'any'});
      this.slider.setAttribute('aria-label', 'time from release in seconds');
      this.said = element('output', controls);
      this.speed = element('select', controls);
      this.speed.setAttribute('aria-label', 'speed');
      for (const [factor, text] of [[1, 'real time'], [.2, '5 times slower'], [.05, '20 times slower'], [.01, '100 times slower']])
        Object.assign(element('option', this.speed, text), {value: factor, selected: factor === .05});
      const label = element('label', controls);
      this.pauses = element('input', label);
      Object.assign(this.pauses, {type: 'checkbox', checked: true});
      label.append(' stop at each peak');
      for (const p of peaks) {
        const jump = element('button', controls, circled(p.n) + ' ' + p.contact);
        jump.type = 'button';
        jump.addEventListener('click', () => { this.pause(); this.show(p.t); });
      }
      this.button.addEventListener('click', () => this.playing ? this.pause() : this.play());
      this.slider.addEventListener('input', () => { this.pause(); this.show(Number(this.slider.value)); });
    }
    show(t) {
      this.t = Math.min(Math.max(t, 0), this.end);
      this.slider.value = this.t;
      this.said.textContent = this.t.toFixed(4) + ' s';
      this.stages.forEach(s => s.show(this.t));
      curves.time(this.t);
    }
    play() {
      if (this.t >= this.end) this.show(0);
      this.playing = true;
      this.button.textContent = 'Pause';
      let lastFrame;
      const frame = now => {
        if (!this.playing) return;
        const from = this.t, to = from + (lastFrame === undefined ? 0 : (now - lastFrame) / 1000 * Number(this.speed.value));
        lastFrame = now;
        const stop = this.pauses.checked ? this.stops.find(s => s > from + 1e-9 && s <= to) : undefined;
        this.show(stop === undefined ? to : stop);
        if (stop !== undefined || this.t >= this.end) return this.pause();
        requestAnimationFrame(frame);
      };
      requestAnimationFrame(frame);
    }
    pause() {
      this.playing = false;
      this.button.textContent = 'Play';
    }
  }

  return {Player, element, circled};
})();
