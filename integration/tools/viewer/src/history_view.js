// Shows histories across frames: which instance of a resource each frame writes and reads.
import { h, table } from './dom.js';
import { accesses_of } from './flow.js';

const frames_shown = 6;

function users(plan, resource) {
  const writers = [], readers = new Map();
  for (const pass of plan.passes) {
    const uses = accesses_of(pass);
    if (uses.writes.some((access) => access.resource === resource)) writers.push(pass.name);
    for (const access of uses.reads)
      if (access.resource === resource && access.frames_back > 0)
        readers.set(access.frames_back, [...(readers.get(access.frames_back) ?? []), pass.name]);
  }
  return { writers, readers };
}

function one_history(plan, history, choose) {
  const resource = plan.resources[history.resource], count = resource.instances;
  const { writers, readers } = users(plan, history.resource);
  const rows = [];
  for (let instance = 0; instance < count; ++instance) {
    const cells = [h('strong', null, `instance ${instance}`)];
    for (let frame = 0; frame < frames_shown; ++frame) {
      const lines = [];
      for (let back = 1; back <= history.frames; ++back)
        if ((((frame - back) % count) + count) % count === instance)
          lines.push(h('div', { class: frame < back ? 'void' : 'read' }, frame < back ? `@-${back}: not valid yet` : `@-${back} → ${(readers.get(back) ?? ['no pass']).join(', ')}`));
      if (frame % count === instance) lines.push(h('div', { class: 'written' }, `written by ${writers.join(', ') || 'no pass'}`));
      cells.push(h('div', null, lines.length > 0 ? lines : '·'));
    }
    rows.push({ cells });
  }
  return h('section', null,
    h('h3', null, h('button', { class: 'link', click: () => choose('resource', history.name) }, history.name)),
    h('p', { class: 'quiet' }, `${history.frames} earlier frame${history.frames === 1 ? '' : 's'} in ${count} instance${count === 1 ? '' : 's'}; at first: ${history.first}; on a cut: ${history.on_cut}; on resize: ${history.on_resize}.`),
    table(['', ...Array.from({ length: frames_shown }, (_, frame) => `frame ${frame}`)], rows));
}

export function show_history(panel, plan, choose) {
  panel.replaceChildren(...(plan.histories.length > 0 ? plan.histories.map((history) => one_history(plan, history, choose))
    : [h('p', { class: 'quiet' }, 'No pass of this plan reads an earlier frame.')]));
}
