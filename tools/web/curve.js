'use strict';
// The plot of acceleration over time: peaks are marked, and a press on it moves the animation (fall.js).
const curves = (() => {
  let landings = [], box, parent, cursor, now = 0, onPress = () => {};
  const step = (range, count) => {
    const raw = range / count, power = 10 ** Math.floor(Math.log10(raw));
    return power * ([1, 2, 5].find(m => m * power >= raw) || 10);
  };
  const x = t => box.left + t / box.end * (box.right - box.left);
  const y = a => box.bottom - a / box.maximum * (box.bottom - box.top);
  const label = (svg, text, attributes) => { make('text', attributes, svg).textContent = text; };

  const axes = svg => {
    const stepY = step(box.maximum, 5), stepX = step(box.end, Math.max(3, (box.right - box.left) / 90));
    const rounded = (value, step) => value.toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));
    for (let a = 0; a <= box.maximum; a += stepY) {
      make('line', {class: 'grid', x1: box.left, x2: box.right, y1: y(a), y2: y(a)}, svg);
      label(svg, rounded(a, stepY), {x: box.left - 6, y: y(a) + 4, 'text-anchor': 'end'});
    }
    for (let t = 0; t <= box.end; t += stepX) label(svg, rounded(t, stepX), {x: x(t), y: box.bottom + 16, 'text-anchor': 'middle'});
    label(svg, 'acceleration [m/s²]', {x: box.left, y: box.top - 10});
    label(svg, 'time from release [s]', {x: box.right, y: box.bottom + 32, 'text-anchor': 'end'});
  };
  const line = (svg, landing, held) => {
    const points = landing.t.map((t, i) => x(t).toFixed(1) + ',' + y(landing.acc[i]).toFixed(1)).join(' ');
    make('polyline', {class: held ? 'curve held' : 'curve', points}, svg);
    const peak = Math.max(...landing.acc), at = landing.t[landing.acc.indexOf(peak)], right = x(at) > box.right - 130;
    make('circle', {class: 'point', cx: x(at), cy: y(peak), r: 4, style: 'stroke-width: 2'}, svg);
    label(svg, `${landing.name}: ${peak.toPrecision(4)}`,
          {class: held ? 'held' : 'mine', x: x(at) + (right ? -8 : 8), y: y(peak) + 4, 'text-anchor': right ? 'end' : 'start'});
  };
  const time = t => {
    now = t;
    if (cursor) for (const key of ['x1', 'x2']) cursor.setAttribute(key, x(t));
  };
  const draw = () => {
    if (!landings.length) return;
    const width = Math.max(280, parent.clientWidth), height = 260;
    box = {left: 48, right: width - 8, top: 28, bottom: height - 40, end: Math.max(...landings.map(l => l.t[l.t.length - 1])),
           maximum: 1.08 * Math.max(1e-9, ...landings.flatMap(l => l.acc))};
    const svg = make('svg', {viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': 'acceleration over time'});
    axes(svg);
    cursor = make('line', {class: 'cursor', y1: box.top, y2: box.bottom}, svg);
    time(now);
    [...landings].reverse().forEach(l => line(svg, l, l.name === 'held'));
    const press = event => {
      if (event.buttons !== 1 && event.type !== 'pointerdown') return;
      const shown = svg.getBoundingClientRect(), at = (event.clientX - shown.left) * width / shown.width;
      onPress(Math.min(box.end, Math.max(0, (at - box.left) / (box.right - box.left) * box.end)));
    };
    svg.addEventListener('pointerdown', press);
    svg.addEventListener('pointermove', press);
    parent.replaceChildren(svg);
  };
  window.addEventListener('resize', draw);
  return {
    show(node, of) { parent = node, landings = of; draw(); },
    onTime(callback) { onPress = callback; },
    time,
  };
})();
