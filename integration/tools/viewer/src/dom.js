// Builds elements from names, attributes and children. Text only becomes text nodes, so that the
// contents of a graph file never become markup.

const svg_space = 'http://www.w3.org/2000/svg';

function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes ?? {})) {
    if (value === undefined || value === null || value === false) continue;
    if (typeof value === 'function') element.addEventListener(name, value);
    else element.setAttribute(name, value === true ? '' : String(value));
  }
  for (const child of children.flat()) {
    if (child === undefined || child === null || child === false) continue;
    element.append(child instanceof Node ? child : document.createTextNode(String(child)));
  }
  return element;
}

export function h(name, attributes, ...children) {
  return fill(document.createElement(name), attributes, children);
}

export function s(name, attributes, ...children) {
  return fill(document.createElementNS(svg_space, name), attributes, children);
}

export function by_id(id) {
  return document.getElementById(id);
}

// Builds a table with a head; each row is an array of cells, each a text or an element.
export function table(titles, rows, attributes) {
  return h('table', attributes, h('thead', null, h('tr', null, titles.map((title) => h('th', { scope: 'col' }, title)))),
    h('tbody', null, rows.map((row) => h('tr', row.attributes, row.cells.map((cell) => h('td', null, cell))))));
}

export function bytes_text(bytes) {
  const units = ['B', 'KiB', 'MiB', 'GiB'];
  let unit = 0;
  for (; bytes >= 1024 && unit + 1 < units.length; ++unit) bytes /= 1024;
  return `${unit === 0 ? bytes : bytes.toFixed(1)} ${units[unit]}`;
}

export function milliseconds_text(milliseconds) {
  return `${milliseconds.toFixed(milliseconds < 1 ? 3 : milliseconds < 10 ? 2 : 1)} ms`;
}

// Shows a tooltip over `element`. `text` is called when the pointer enters.
export function explain_on_hover(element, text) {
  const tip = by_id('tip');
  const move = (event) => {
    tip.style.left = `${Math.min(event.clientX + 14, innerWidth - tip.offsetWidth - 8)}px`;
    tip.style.top = `${Math.min(event.clientY + 14, innerHeight - tip.offsetHeight - 8)}px`;
  };
  element.addEventListener('pointerenter', (event) => {
    tip.textContent = text();
    tip.hidden = false;
    move(event);
  });
  element.addEventListener('pointermove', move);
  element.addEventListener('pointerleave', () => { tip.hidden = true; });
  return element;
}
