// Shows lifetimes of resources over the passes, next to the heaps. Resources that overlap
// vertically in a heap and not horizontally share memory.
import { bytes_text, explain_on_hover, h, s } from './dom.js';

const row = 18, label_width = 150, heap_height = 320, between = 80;
const hues = 12;

// Width of a pass in pixels: both pictures fit side by side if they are legible at that width.
const cell_width = (panel_width, passes) => Math.max(0.6, Math.min(26, Math.max(260, (panel_width - label_width - between) / 2) / passes));
const hue = (index) => Math.round((index * 360 * 0.618034) % 360 / (360 / hues)) * (360 / hues);

function words(plan, placement, index) {
  const reason = plan.reasons.find((one) => one.about === 'placement' && one.index === index);
  return `${placement.name}: ${bytes_text(placement.size)} at ${placement.offset} of heap ${placement.heap}` +
    (placement.persistent ? ', keeps its contents across frames' : `, passes ${placement.first_use} to ${placement.last_use}`) +
    (reason ? `\n${reason.text}` : '');
}

function block(plan, placement, index, box, selected, choose) {
  const rect = s('rect', { ...box, rx: 2, class: `block${placement.persistent ? ' kept' : ''}${selected === placement.name ? ' chosen' : ''}`,
    style: `--hue:${hue(placement.resource)}`, click: () => choose('resource', placement.name) });
  return explain_on_hover(rect, () => words(plan, placement, index));
}

function lifetimes(plan, cell, order, selected, choose) {
  const width = label_width + cell * plan.passes.length + 4, height = row * order.length + 24;
  const parts = [];
  const step = Math.max(1, Math.ceil(30 / cell));
  for (let p = 0; p < plan.passes.length; p += step)
    parts.push(s('line', { x1: label_width + p * cell, x2: label_width + p * cell, y1: 18, y2: height, class: 'tick' }),
      s('text', { x: label_width + p * cell + 2, y: 13, class: 'axis' }, p));
  order.forEach((index, at) => {
    const placement = plan.placements[index], y = 20 + at * row;
    parts.push(s('text', { x: label_width - 6, y: y + 13, class: 'label', 'text-anchor': 'end', click: () => choose('resource', placement.name) },
      placement.name.length > 20 ? `${placement.name.slice(0, 19)}…` : placement.name),
    block(plan, placement, index, { x: label_width + placement.first_use * cell, y: y + 2,
      width: Math.max(2, (placement.last_use - placement.first_use + 1) * cell - 1), height: row - 4 }, selected, choose));
  });
  return s('svg', { width, height, role: 'img', 'aria-label': 'Lifetimes of resources over passes' }, parts);
}

function heap_map(plan, cell, heap, heap_index, selected, choose) {
  const width = cell * plan.passes.length + 4;
  const scale = heap_height / Math.max(1, heap.size);
  const parts = [s('rect', { x: 0, y: 0, width, height: heap_height, class: 'heap' })];
  plan.placements.forEach((placement, index) => {
    if (placement.heap !== heap_index) return;
    const box = { x: placement.first_use * cell, y: placement.offset * scale,
      width: Math.max(2, (placement.last_use - placement.first_use + 1) * cell - 1), height: Math.max(1.5, placement.size * scale - 0.5) };
    parts.push(block(plan, placement, index, box, selected, choose));
    if (box.height > 13 && box.width > 7 * placement.name.length)
      parts.push(s('text', { x: box.x + 4, y: box.y + 12, class: 'inside' }, placement.name));
  });
  return h('figure', null,
    h('figcaption', null, `Heap ${heap_index}: ${bytes_text(heap.size)}${heap.persistent ? ', kept across frames' : ''}; at most ${bytes_text(heap.max_live_bytes)} live at once`),
    s('svg', { width, height: heap_height, role: 'img', 'aria-label': `Heap ${heap_index}: addresses downwards, passes to the right` }, parts));
}

export function show_memory(panel, plan, selected, choose) {
  const order = plan.placements.map((_, index) => index)
    .sort((a, b) => plan.placements[a].first_use - plan.placements[b].first_use || plan.placements[a].last_use - plan.placements[b].last_use || a - b);
  const cell = cell_width(panel.clientWidth, plan.passes.length);
  panel.replaceChildren(h('div', { class: 'memory' },
    h('figure', null, h('figcaption', null, `Lifetimes: ${plan.placements.length} placements over ${plan.passes.length} passes`),
      lifetimes(plan, cell, order, selected, choose)),
    h('div', null, plan.heaps.map((heap, index) => heap_map(plan, cell, heap, index, selected, choose)))));
}
