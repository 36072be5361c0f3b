// Read-out of heat maps, and the animation of a page that has one. The page is complete without this script.
(() => {
  // Shows the value of a heat map under the pointer.
  for (const svg of document.querySelectorAll('svg.map')) {
    const {inside: [left, top, width, height], labels, x, y, values} = JSON.parse(svg.querySelector('metadata').textContent);
    const said = fall.element('p', svg.parentNode, 'Point at the map to read it.');
    said.className = 'said';
    svg.addEventListener('pointermove', event => {
      const shown = svg.getBoundingClientRect(), scale = svg.viewBox.baseVal.width / shown.width;
      const i = Math.floor(((event.clientX - shown.left) * scale - left) / width * x.length);
      const j = Math.floor((1 - ((event.clientY - shown.top) * scale - top) / height) * y.length);
      if (i < 0 || j < 0 || i >= x.length || j >= y.length) return;
      const value = values[j * x.length + i];
      said.textContent = `${labels[0]} ${x[i]}, ${labels[1]} ${y[j]}: ${value === null ? 'none' : value}`;
    });
  }

  const data = document.getElementById('landings');
  if (data) new fall.Player(JSON.parse(data.textContent), document.getElementById('player'));
})();
