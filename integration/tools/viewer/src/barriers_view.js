// Shows every barrier with its reason.
import { h, table } from './dom.js';

// Returns [{ barrier, where, pass }] in recording order.
export function all_barriers(plan) {
  const all = [];
  for (const pass of plan.passes) {
    for (const barrier of pass.barriers) all.push({ barrier, where: `before ${pass.name}`, pass: pass.name });
    for (const barrier of pass.releases) all.push({ barrier, where: `after ${pass.name}`, pass: pass.name });
  }
  for (const barrier of plan.final_barriers) all.push({ barrier, where: 'end of the frame', pass: null });
  return all;
}

export function reasons_by_barrier(plan) {
  return new Map(plan.reasons.filter((reason) => reason.about === 'barrier').map((reason) => [reason.index, reason.text]));
}

const joined = (mask) => mask.names.join(' ') || 'none';

export function show_barriers(panel, plan, selection, choose) {
  const reasons = reasons_by_barrier(plan);
  const mine = ({ barrier, pass }) => (selection.kind === 'pass' ? pass === selection.name : selection.kind === 'resource' ? barrier.name === selection.name : true);
  const shown = all_barriers(plan).filter(mine);
  panel.replaceChildren(
    h('p', { class: 'quiet' }, selection.kind ? `${shown.length} barriers of ${selection.name}; select nothing (Escape) to see all.` : `${shown.length} barriers.`),
    table(['where', 'resource', 'kind', 'waits for', 'then', 'layout', 'reason'], shown.map(({ barrier, where, pass }) => ({ cells: [
      pass === null ? where : h('button', { class: 'link', click: () => choose('pass', pass) }, where),
      h('button', { class: 'link', click: () => choose('resource', barrier.name) }, barrier.name + (barrier.frames_back > 0 ? `@-${barrier.frames_back}` : '')),
      barrier.why.replaceAll('_', ' '),
      barrier.from_host ? 'state bound by the host' : `${joined(barrier.source_stages)}: ${joined(barrier.source_access)}`,
      barrier.to_host ? 'state requested by the host' : `${joined(barrier.destination_stages)}: ${joined(barrier.destination_access)}`,
      barrier.old_layout.name === barrier.new_layout.name ? barrier.new_layout.name : `${barrier.old_layout.name} → ${barrier.new_layout.name}`,
      reasons.get(barrier.index) ?? '',
    ] }))));
}
