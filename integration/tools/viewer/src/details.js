// Shows all properties of the selected pass or resource.
import { reasons_by_barrier } from './barriers_view.js';
import { bytes_text, h, milliseconds_text } from './dom.js';
import { accesses_of, users_of } from './flow.js';

function facts(pairs) {
  return h('dl', null, pairs.filter(([, value]) => value !== null && value !== undefined && value !== '').flatMap(([name, value]) => [h('dt', null, name), h('dd', null, value)]));
}

function image_range_text(range, resource) {
  if (range.mips === (resource.mips ?? 1) && range.layers === (resource.layers ?? 1)) return '';
  const span = (first, count) => (count > 1 ? `${first}..${first + count - 1}` : `${first}`);
  return ` mips ${span(range.first_mip, range.mips)}, layers ${span(range.first_layer, range.layers)}`;
}

function reason_list(plan, about, name) {
  const texts = plan.reasons.filter((reason) => reason.about === about && reason.name === name).map((reason) => reason.text);
  return texts.length > 0 && h('ul', { class: 'reasons' }, texts.map((text) => h('li', null, text)));
}

const chain = (names, kind, choose) => (names.length === 0 ? 'nobody' : names.map((name, i) => [i > 0 ? ', ' : '', h('button', { class: 'link', click: () => choose(kind, name) }, name)]).flat());

function access_list(title, accesses, plan, choose) {
  return accesses.length > 0 && [h('h3', null, title), h('ul', null, accesses.map((access) => h('li', null,
    h('button', { class: 'link', click: () => choose('resource', access.name) }, access.name + (access.frames_back > 0 ? `@-${access.frames_back}` : '')),
    ` as ${access.port}: ${access.usage.replaceAll('_', ' ')}${image_range_text(access.range, plan.resources[access.resource])}${access.when === 'always' ? '' : `, when ${access.when.replaceAll('_', ' ')}`}`)))];
}

export function pass_details(plan, declared, time, tools) {
  const pass = plan.passes.find((one) => one.name === declared.name);
  const head = [h('h2', null, declared.name), h('p', { class: 'quiet' }, `pass of type ${declared.kind}`), declared.note && h('p', null, declared.note),
    tools.source_button(declared)];
  if (!pass) return [...head, h('p', { class: 'off' }, 'Does not run with these settings.'), reason_list(plan, 'pass', declared.name)];
  const uses = accesses_of(pass), reasons = reasons_by_barrier(plan);
  return [...head,
    facts([['position', plan.passes.indexOf(pass)], ['runs', pass.dispatch.replaceAll('_', ' ')], ['queue', pass.queue],
      ['measured', time === undefined ? null : milliseconds_text(time)], ['waits for', pass.wait === null ? null : `point ${pass.wait} of the other queue`]]),
    reason_list(plan, 'pass', pass.name),
    access_list('Reads', uses.reads, plan, tools.choose), access_list('Writes', uses.writes, plan, tools.choose),
    pass.settings.length > 0 && [h('h3', null, 'Settings'), facts(pass.settings.map((one) => [one.name, `${one.value}${one.follows ? ` (follows $${one.follows})` : ''}`]))],
    pass.barriers.length > 0 && [h('h3', null, `${pass.barriers.length} barriers before it`), h('ul', null, pass.barriers.map((one) => h('li', null,
      h('strong', null, one.name), ` ${one.why.replaceAll('_', ' ')}: ${reasons.get(one.index) ?? ''}`)))]].flat(2);
}

export function resource_details(plan, declared, tools) {
  const index = plan.resources.findIndex((one) => one.name === declared.name);
  const head = [h('h2', null, declared.name), declared.note && h('p', null, declared.note), tools.source_button(declared)];
  if (index < 0) return [...head, h('p', { class: 'off' }, 'Not in this plan.'), reason_list(plan, 'resource', declared.name)];
  const resource = plan.resources[index], users = users_of(plan, index);
  const placements = plan.placements.map((one, at) => [one, at]).filter(([one]) => one.resource === index);
  return [...head,
    facts([['type', `${resource.origin === 'import' ? 'import, ' : ''}${resource.exported ? 'export, ' : ''}${resource.type}`],
      ['format', resource.format?.name], ['size', resource.type === 'image' ? `${resource.width}x${resource.height}` : bytes_text(resource.bytes)],
      ['mips', resource.mips > 1 ? resource.mips : null], ['layers', resource.layers > 1 ? resource.layers : null],
      ['instances', resource.instances > 1 ? resource.instances : null], ['written by', chain(users.writers, 'pass', tools.choose)], ['read by', chain(users.readers, 'pass', tools.choose)]]),
    reason_list(plan, 'resource', resource.name),
    placements.length > 0 && [h('h3', null, 'Memory'), h('ul', null, placements.map(([one, at]) => h('li', null,
      `heap ${one.heap} at ${one.offset}, ${bytes_text(one.size)}; ${plan.reasons.find((reason) => reason.about === 'placement' && reason.index === at)?.text ?? ''}`)))]].flat(2);
}
