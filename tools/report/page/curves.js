'use strict';
// Zoom and read-out of figures. gnuplot's drawings stay in the page; a zoomed one is covered by its lines, enlarged, with axes
// of their own. The page is complete without this script.
const curves = (() => {
  // About `count` ticks [value, text] from low to high; on a logarithmic axis over more than a decade 1, 2 and 5 times 10^k.
  const ticks = (low, high, count, log) => {
    const out = [];
    if (log && high / low > 10) {
      for (let k = Math.floor(Math.log10(low)); k <= Math.log10(high); ++k)
        for (const m of high / low > 1000 ? [1] : [1, 2, 5])
          if (m * 10 ** k >= low && m * 10 ** k <= high) out.push([m * 10 ** k, String(Number((m * 10 ** k).toPrecision(3)))]);
      return out;
    }
    const raw = (high - low) / Math.max(2, count), power = 10 ** Math.floor(Math.log10(raw));
    const step = power * ([1, 2, 5].find(m => m * power >= raw) || 10), digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) out.push([k * step, (k * step).toFixed(Math.min(digits, 12))]);
    return out;
  };
  const words = label => label.replace(/ *\[[^\]]*\]/, '');
  const unit = label => (/\[([^\]]*)\]/.exec(label) || ['', ''])[1];

  // The lines that gnuplot drew in a panel, in its pixels: {name, node, x, y, first, dots}; `first`: whether a piece begins there.
  const linesOf = (svg, index, p) => {
    const out = [];
    for (const group of svg.querySelectorAll(`[data-curve^="${index},"]`)) {
      const name = p.names[Number(group.dataset.curve.split(',')[1])] || '';
      const inside = y => y > p.top - 2;  // the key is above
      for (const node of group.querySelectorAll('path')) {
        const line = {name, node, x: [], y: [], first: []};
        for (const [, letter, x, y] of node.getAttribute('d').matchAll(/([ML])(-?[\d.]+),(-?[\d.]+)/g))
          if (inside(Number(y))) line.x.push(Number(x)), line.y.push(Number(y)), line.first.push(letter === 'M');
        if (line.x.length) out.push(line);
      }
      const dots = {name, x: [], y: [], dots: []};
      for (const node of group.querySelectorAll('use')) {
        const [, x, y, rest] = /translate\((-?[\d.]+),(-?[\d.]+)\)(.*)/.exec(node.getAttribute('transform'));
        if (inside(Number(y))) dots.x.push(Number(x)), dots.y.push(Number(y)), dots.dots.push([node, rest]);
      }
      if (dots.x.length) out.push(dots);
    }
    return out;
  };

  // A panel of a figure; `range`: its whole x range, as a logarithm on a logarithmic axis.
  class Panel {
    constructor(figure, index, p) {
      this.svg = figure.svg, this.p = p;
      this.to = p.log ? Math.log10 : x => x, this.from = p.log ? u => 10 ** u : u => u;
      this.range = p.x.map(this.to);
      this.lines = linesOf(this.svg, index, p);
      this.over = make('g', {class: 'zoomed'}, this.svg);
      this.over.style.display = 'none';
      const id = `clip-${figure.node.id}-${index}`, {left, right, top, bottom} = p;
      make('rect', {class: 'cover', x: left - 46, y: top - 4, width: right - left + 60, height: bottom - top + 27}, this.over);
      make('rect', {x: left, y: top, width: right - left, height: bottom - top}, make('clipPath', {id}, this.over));
      this.axes = make('g', {class: 'axes'}, this.over);
      this.inside = make('g', {'clip-path': `url(#${id})`}, this.over);
      for (const l of this.lines) {
        l.copies = (l.dots ? l.dots.map(([node]) => node) : [l.node]).map(node => this.inside.appendChild(node.cloneNode()));
        if (!l.node) continue;
        l.copies[0].setAttribute('stroke-width', l.node.parentNode.getAttribute('stroke-width'));
        l.copies[0].setAttribute('d', l.x.map((x, i) => (l.first[i] ? 'M' : 'L') + x + ',' + l.y[i]).join(' '));
      }
      this.cursor = make('line', {class: 'cursor', y1: top, y2: bottom}, this.svg);
      this.reader = make('line', {class: 'reader', y1: top, y2: bottom}, this.svg);
      this.show(this.range);
      this.at(this.cursor, undefined), this.at(this.reader, undefined);
    }
    has(x, y) { return x >= this.p.left && x <= this.p.right && y >= this.p.top && y <= this.p.bottom; }
    // From a coordinate u on the axis to pixels, and back in the current view.
    pixel(u, [low, high]) { return this.p.left + (u - low) / (high - low) * (this.p.right - this.p.left); }
    number(x) { return this.view[0] + (x - this.p.left) / (this.p.right - this.p.left) * (this.view[1] - this.view[0]); }
    height(y) {
      const {top, bottom, log} = this.p, [low, high] = this.p.y.map(this.to), u = low + (bottom - y) / (bottom - top) * (high - low);
      return log ? 10 ** u : u;
    }
    // Range of the lines in y between two x of the whole drawing [px], with a margin.
    span(from, to) {
      let low = Infinity, high = -Infinity;
      for (const l of this.lines)
        for (let i = 0; i < l.x.length; ++i) {
          const crosses = !l.dots && i > 0 && !l.first[i] && l.x[i] > from && l.x[i - 1] < to;
          if (!(l.x[i] >= from && l.x[i] <= to) && !crosses) continue;
          // Height of a line where it crosses the edge of the interval.
          const heightAtEdge = (x, y, ox, oy) => x < from ? y + (from - x) / (ox - x) * (oy - y) : x > to ? y + (x - to) / (x - ox) * (oy - y) : y;
          const ys = crosses ? [heightAtEdge(l.x[i], l.y[i], l.x[i - 1], l.y[i - 1]), heightAtEdge(l.x[i - 1], l.y[i - 1], l.x[i], l.y[i])] : [l.y[i]];
          low = Math.min(low, ...ys), high = Math.max(high, ...ys);
        }
      if (!(low <= high)) return [this.p.top, this.p.bottom];
      const margin = Math.max(.08 * (high - low), .02);
      return [low - margin, high + margin];
    }
    show(view) {
      this.view = view;
      const {left, right, top, bottom} = this.p, whole = view[0] === this.range[0] && view[1] === this.range[1];
      this.over.style.display = whole ? 'none' : '';
      this.box = whole ? [left, right, top, bottom] : [this.pixel(view[0], this.range), this.pixel(view[1], this.range)];
      if (whole) return;
      const [from, to] = this.box, [high, low] = this.span(from, to);
      this.box.push(high, low);
      const sx = (right - left) / (to - from), sy = (bottom - top) / (low - high), dx = left - from * sx, dy = top - high * sy;
      for (const l of this.lines)
        l.copies.forEach((copy, i) => copy.setAttribute('transform', l.dots ? `translate(${l.x[i] * sx + dx},${l.y[i] * sy + dy})${l.dots[i][1]}` : `matrix(${sx} 0 0 ${sy} ${dx} ${dy})`));
      this.drawAxes(view, sy, dy);
      for (const [x, y, text] of this.p.marks) {
        const px = this.pixel(this.to(x), view), py = this.place(y) * sy + dy;
        if (px >= left && px <= right && py >= top && py <= bottom) this.text(px, Math.max(py - 6, top + 10), 'middle', text);
      }
    }
    // y of a value in the whole drawing [px].
    place(value) {
      const [low, high] = this.p.y.map(this.to);
      return this.p.bottom - (this.to(value) - low) / (high - low) * (this.p.bottom - this.p.top);
    }
    text(x, y, anchor, text) { make('text', {x, y, 'text-anchor': anchor}, this.axes).textContent = text; }
    drawAxes(view, sy, dy) {
      const {left, right, top, bottom, log} = this.p;
      this.axes.replaceChildren();
      for (const [value, text] of ticks(...view.map(this.from), (right - left) / 80, log)) {
        const x = this.pixel(this.to(value), view);
        make('path', {class: 'grid', d: `M${x} ${bottom}V${top}`}, this.axes), this.text(x, bottom + 18, 'middle', text);
      }
      const [, , high, low] = this.box;
      for (const [value, text] of ticks(this.height(low), this.height(high), (bottom - top) / 28, log)) {
        const y = this.place(value) * sy + dy;
        make('path', {class: 'grid', d: `M${left} ${y}H${right}`}, this.axes), this.text(left - 6, y + 4, 'end', text);
      }
      make('path', {class: 'frame', d: `M${left} ${top}V${bottom}H${right}`}, this.axes);
      for (const [value, text] of this.p.levels) {
        const y = this.place(value) * sy + dy;
        if (y < top || y > bottom) continue;
        make('path', {class: 'level', d: `M${left} ${y}H${right}`}, this.axes), this.text(right - 6, y - 4 < top + 10 ? y + 14 : y - 4, 'end', text);
      }
    }
    // Places a vertical line at u on the axis; hides it outside the view.
    at(line, u) {
      const inside = u >= this.view[0] && u <= this.view[1], x = inside ? this.pixel(u, this.view) : 0;
      line.style.display = inside ? '' : 'none';
      line.setAttribute('x1', x), line.setAttribute('x2', x);
    }
    // Values of the lines at u on the axis: "best motion 195.3".
    read(u) {
      const x = this.pixel(u, this.range), out = [], tolerance = (this.box[1] - this.box[0]) / 100;
      for (const l of this.lines) {
        let y;
        if (l.dots) {
          const nearest = l.x.reduce((best, at, i) => Math.abs(at - x) < Math.abs(l.x[best] - x) ? i : best, 0);
          if (Math.abs(l.x[nearest] - x) <= tolerance) y = l.y[nearest];
        } else {
          for (let i = 1; i < l.x.length; ++i)
            if (!l.first[i] && l.x[i - 1] <= x && x <= l.x[i])
              y = l.x[i] > l.x[i - 1] ? l.y[i - 1] + (x - l.x[i - 1]) / (l.x[i] - l.x[i - 1]) * (l.y[i] - l.y[i - 1]) : l.y[i];
        }
        if (y === undefined || (!l.name && this.lines.some(other => other.name))) continue;
        out.push((l.name ? l.name + ' ' : '') + Number(this.height(y).toPrecision(4)));
      }
      const of = [this.p.title, words(this.p.y_label)].filter(s => s).join(', ');
      return out.length ? `${of}: ${out.join('; ')} ${unit(this.p.y_label)}`.trim() : '';
    }
  }

  // Figures that share an x axis: all those over the time of the landing; every other figure is a group of its own.
  class Group {
    constructor() { this.figures = []; }
    get panels() { return this.figures.flatMap(f => f.panels); }
    start() {
      this.whole = [Math.min(...this.panels.map(p => p.range[0])), Math.max(...this.panels.map(p => p.range[1]))];
      this.view = this.whole;
    }
    show(low, high) {
      const [first, last] = this.whole, span = Math.min(last - first, Math.max(high - low, (last - first) / 2000));
      const start = Math.min(Math.max(low, first), last - span), all = span > .9999 * (last - first);
      this.view = all ? this.whole : [start, start + span];
      for (const p of this.panels) p.show(all ? p.range : this.view);
      for (const f of this.figures) f.all.disabled = all;
      this.time(this.t), this.read(this.reading);
    }
    zoom(factor, about = this.reading === undefined ? (this.view[0] + this.view[1]) / 2 : this.reading) {
      const at = Math.min(Math.max(about, this.view[0]), this.view[1]);
      this.show(at - (at - this.view[0]) * factor, at + (this.view[1] - at) * factor);
    }
    pan(fraction) {
      const shift = fraction * (this.view[1] - this.view[0]);
      this.show(this.view[0] + shift, this.view[1] + shift);
    }
    time(t) {
      this.t = t;
      for (const p of this.panels) p.at(p.cursor, t);
    }
    // Shows the values of the lines at u; undefined: none.
    read(u) {
      this.reading = u;
      for (const p of this.panels) p.at(p.reader, u);
      for (const f of this.figures) f.say(u);
    }
  }

  class Figure {
    constructor(node, group) {
      this.node = node, this.svg = node.querySelector('svg'), this.group = group;
      this.panels = JSON.parse(node.dataset.panels).flatMap((p, i) => p ? [new Panel(this, i, p)] : []);
      this.svg.setAttribute('tabindex', 0);
      const tools = document.createElement('div');
      tools.className = 'look';
      this.said = tools.appendChild(document.createElement('output'));
      const button = (text, name, act) => {
        const out = tools.appendChild(document.createElement('button'));
        Object.assign(out, {type: 'button', textContent: text, title: name});
        out.setAttribute('aria-label', name);
        out.addEventListener('click', act);
        return out;
      };
      button('+', 'zoom in', () => group.zoom(.5)), button('−', 'zoom out', () => group.zoom(2));
      this.all = button('whole', 'the whole curve', () => group.show(...group.whole));
      this.all.disabled = true;
      node.querySelector('.drawing').after(tools);
      this.select = make('rect', {class: 'select'}, this.svg);
      this.select.style.display = 'none';
      this.listen();
      group.figures.push(this);
    }
    say(u) {
      const read = u === undefined ? [] : this.panels.map(p => p.read(u)).filter(s => s);
      const {x_label, log} = this.panels[0].p, x = log ? 10 ** u : u;
      this.said.textContent = read.length ? `${words(x_label)} ${Number(x.toPrecision(5))} ${unit(x_label)} — ${read.join('; ')}` : 'Drag, + or − to zoom; point to read.';
    }
    // The panel under the pointer and the coordinate u on its axis.
    under(event) {
      const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.svg.getScreenCTM().inverse());
      const panel = this.panels.find(p => p.has(point.x, point.y));
      return {point, panel, u: panel && panel.number(point.x)};
    }
    listen() {
      const {svg, group} = this;
      let from;  // of a drag
      const box = to => {
        const {left, right, top, bottom} = from.panel.p, x = Math.min(Math.max(to.x, left), right);
        const at = {x: Math.min(x, from.point.x), y: top, width: Math.abs(x - from.point.x), height: bottom - top};
        for (const key in at) this.select.setAttribute(key, at[key]);
        return [at.x, at.x + at.width].map(v => from.panel.number(v));
      };
      svg.addEventListener('pointerdown', event => {
        const {point, panel} = this.under(event);
        if (!panel || event.button !== 0) return;
        from = {point, panel, view: group.view, u: panel.number(point.x), dragged: false};
        svg.setPointerCapture(event.pointerId), svg.focus({preventScroll: true});
        event.preventDefault();
      });
      svg.addEventListener('pointermove', event => {
        const {point, u} = this.under(event);
        if (!from) return group.read(u);
        from.dragged ||= Math.abs(point.x - from.point.x) > 4;
        if (!from.dragged) return;
        if (event.shiftKey) {
          const shift = (from.point.x - point.x) / (from.panel.p.right - from.panel.p.left) * (from.view[1] - from.view[0]);
          return group.show(from.view[0] + shift, from.view[1] + shift);
        }
        this.select.style.display = '', box(point);
      });
      svg.addEventListener('pointerup', event => {
        if (!from) return;
        if (!from.dragged) group.onTime?.(from.u);
        else if (!event.shiftKey) group.show(...box(this.under(event).point));
        from = undefined, this.select.style.display = 'none';
      });
      svg.addEventListener('pointercancel', () => { from = undefined, this.select.style.display = 'none'; });
      svg.addEventListener('pointerleave', () => from || group.read(undefined));
      svg.addEventListener('dblclick', () => group.show(...group.whole));
      // The wheel scrolls the page unless the figure has the focus; a pinch arrives as a wheel event with Ctrl.
      svg.addEventListener('wheel', event => {
        const {u} = this.under(event);
        if (u === undefined || !(event.ctrlKey || document.activeElement === svg)) return;
        event.preventDefault();
        if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) group.pan(Math.sign(event.deltaX || event.deltaY) / 10);
        else group.zoom(event.deltaY > 0 ? 1.25 : .8, u);
      }, {passive: false});
      svg.addEventListener('keydown', event => this.key(event));
    }
    key(event) {
      const {group} = this, [low, high] = group.view, step = event.key === 'ArrowLeft' ? -1 : event.key === 'ArrowRight' ? 1 : 0;
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      if (event.key === '+' || event.key === '=') group.zoom(.5);
      else if (event.key === '-') group.zoom(2);
      else if (event.key === '0' || event.key === 'Escape') group.show(...group.whole);
      else if (step && event.shiftKey) group.pan(step / 4);
      else if (step) {
        const u = (group.reading === undefined ? (low + high) / 2 : group.reading) + step * (high - low) / 200;
        if (u < low || u > high) group.pan(step / 4);
        group.read(u);
      } else if (event.key === 'Enter' && group.reading !== undefined) group.onTime?.(group.reading);
      else return;
      event.preventDefault();
    }
  }

  const time = new Group(), groups = [time];
  for (const node of document.querySelectorAll('figure[data-panels]')) {
    const group = node.hasAttribute('data-time') ? time : groups[groups.push(new Group()) - 1];
    new Figure(node, group);
  }
  for (const g of groups) if (g.figures.length) g.start(), g.show(...g.whole);
  return {
    // Moves the cursor to the time of the animation.
    time: t => { if (time.figures.length) time.time(t); },
    // Registers a callback for the time that is chosen in a figure.
    onTime: act => { time.onTime = act; },
  };
})();
