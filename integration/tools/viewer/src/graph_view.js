// Shows the graph as nodes and edges.
import cytoscape from 'cytoscape';

import { explain_on_hover, by_id } from './dom.js';
import { make_flow } from './flow.js';
import { place } from './layout.js';
import { color } from './theme.js';

const max_passes_with_resources = 150; // with more passes, edges connect passes directly
const labels_legible = 7; // pixels on screen
const max_curves = 900; // edges drawn as curves; with more, edges are straight
// smaller labels are illegible: the view then shows the start of the graph
const min_first_zoom = 0.55;

function measure(label, font) {
  measure.context ??= document.createElement('canvas').getContext('2d');
  measure.context.font = font;
  return measure.context.measureText(label).width;
}

function style() {
  const text = color('--text'), line = color('--line');
  return [
    { selector: 'node', style: { label: 'data(label)', width: 'data(width)', height: 'data(height)', 'text-valign': 'center',
      'font-size': 12, 'font-family': 'system-ui, sans-serif', color: text, 'border-width': 1, 'border-color': line,
      'background-color': color('--panel'), shape: 'ellipse', 'min-zoomed-font-size': labels_legible, 'text-wrap': 'wrap' } },
    { selector: 'node[kind = "pass"]', style: { shape: 'round-rectangle', 'background-color': color('--pass'), 'border-color': color('--pass-line') } },
    { selector: 'node[kind = "pass"][heat]', style: { 'background-color': color('--hot'), 'background-opacity': 'data(heat)' } },
    { selector: 'node[?slot]', style: { 'border-style': 'double', 'border-width': 4, 'border-color': color('--slot') } },
    { selector: 'node[kind = "past"]', style: { 'border-style': 'dashed', 'border-color': color('--past') } },
    { selector: 'edge', style: { width: 1.2, 'line-color': line, 'target-arrow-color': line, 'target-arrow-shape': 'triangle',
      'arrow-scale': 0.8, 'curve-style': 'bezier' } },
    { selector: 'edge[kind = "past"]', style: { 'line-style': 'dashed', 'line-color': color('--past'), 'target-arrow-color': color('--past') } },
    { selector: 'edge[?straight]', style: { 'curve-style': 'haystack' } },
    { selector: 'edge[kind = "keep"]', style: { 'line-style': 'dotted' } },
    { selector: '.far', style: { opacity: 0.25 } },
    { selector: '.found', style: { 'border-width': 3, 'border-color': color('--accent') } },
    { selector: 'edge.near', style: { 'line-color': color('--accent'), 'target-arrow-color': color('--accent'), width: 2.4 } },
    { selector: 'node:selected', style: { 'border-width': 4, 'border-color': color('--accent') } },
  ];
}

// `times` holds milliseconds by pass and may be empty. `choose(kind, name)` is called on a tap;
// `describe(kind, name)` returns the tooltip's text.
export function make_graph_view(container, choose, describe) {
  const view = cytoscape({ container, style: style(), layout: { name: 'preset' }, minZoom: 0.02, maxZoom: 3,
    boxSelectionEnabled: false, autoungrabify: true, hideEdgesOnViewport: true, textureOnViewport: true });
  let hovered = null;
  explain_on_hover(container, () => (hovered === null ? '' : describe(hovered)));
  view.on('tap', 'node', (event) => choose(event.target.data('kind') === 'pass' ? 'pass' : 'resource', event.target.data('name')));
  view.on('tap', (event) => { if (event.target === view) choose(null, null); });
  view.on('mouseover', 'node', (event) => {
    hovered = event.target.data();
    by_id('tip').textContent = describe(hovered);
    by_id('tip').hidden = false;
  });
  view.on('mouseout', 'node', () => { hovered = null; by_id('tip').hidden = true; });
  container.addEventListener('keydown', (event) => {
    const step = 60, zoom = 1.25;
    const moves = { ArrowLeft: [step, 0], ArrowRight: [-step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] };
    if (moves[event.key]) view.panBy({ x: moves[event.key][0], y: moves[event.key][1] });
    else if (event.key === '+' || event.key === '-')
      view.zoom({ level: view.zoom() * (event.key === '+' ? zoom : 1 / zoom), renderedPosition: { x: container.clientWidth / 2, y: container.clientHeight / 2 } });
    else if (event.key === '0') view.fit(undefined, 20);
    else return;
    event.preventDefault();
  });

  // Shows the left end at half height.
  function show_start() {
    view.zoom(min_first_zoom);
    const box = view.elements().boundingBox(), first = view.nodes('[kind = "pass"]')[0].position();
    view.pan({ x: 20 - box.x1 * min_first_zoom, y: container.clientHeight / 2 - first.y * min_first_zoom });
  }

  return {
    show(plan, times) {
      const { nodes, edges } = make_flow(plan, plan.passes.length <= max_passes_with_resources);
      const slowest = Math.max(0, ...Object.values(times));
      for (const node of nodes) {
        const time = node.kind === 'pass' ? times[node.name] : undefined;
        if (time !== undefined) node.label += `\n${time.toFixed(2)} ms`;
        node.width = Math.max(...node.label.split('\n').map((line) => measure(line, '12px system-ui, sans-serif'))) + (node.kind === 'pass' ? 18 : 30);
        node.height = time !== undefined ? 42 : 28;
        if (time !== undefined && slowest > 0) node.heat = 0.08 + 0.92 * Math.sqrt(time / slowest);
        node.slot = node.kind === 'resource' && plan.resources[node.resource].slot !== null ? 1 : 0;
      }
      const places = place(nodes, edges);
      view.batch(() => {
        view.elements().remove();
        view.add([
          ...nodes.map((data) => ({ group: 'nodes', data, position: places.get(data.id) })),
          ...edges.map((edge) => ({ group: 'edges', data: { id: edge.id, source: edge.from, target: edge.to, kind: edge.kind, straight: edges.length > max_curves ? 1 : 0 } })),
        ]);
      });
      view.fit(undefined, 20);
      if (view.zoom() < min_first_zoom) show_start();
    },
    select(kind, name) {
      view.batch(() => {
        view.elements().removeClass('near far').unselect();
        if (kind === null) return;
        const chosen = view.nodes().filter((node) => (node.data('kind') === 'pass') === (kind === 'pass') && node.data('name') === name);
        const near = chosen.union(chosen.neighborhood());
        view.elements().difference(near).addClass('far');
        near.edges().addClass('near');
        chosen.select();
      });
      const chosen = view.nodes(':selected');
      if (chosen.length > 0 && view.zoom() < 0.7) view.zoom(0.9);
      if (chosen.length > 0) view.center(chosen);
    },
    mark(names) {
      view.batch(() => {
        view.nodes().removeClass('found');
        if (names !== null) view.nodes().filter((node) => names.has(node.data('name'))).addClass('found');
      });
    },
    restyle() { view.style(style()); },
    resize() { view.resize(); },
    fit() { view.fit(undefined, 20); },
    counts() { return { nodes: view.nodes().length, edges: view.edges().length }; },
    // For tests: returns the position of a node on screen.
    place_of(name) {
      const node = view.nodes().filter((one) => one.data('name') === name);
      return node.length > 0 ? node[0].renderedPosition() : null;
    },
  };
}
