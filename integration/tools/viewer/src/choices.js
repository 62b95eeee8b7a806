// Shows the settings that the reader may switch, and how each switch changes the plan.
import { bytes_text, h } from './dom.js';

// `chosen` holds the value index of each switchable setting; `choose(chosen)` is called on a
// change.
export function show_choices(panel, settings, chosen, choose) {
  const switched = settings.filter((setting) => setting.switched !== null);
  const fixed = settings.filter((setting) => setting.switched === null);
  panel.replaceChildren(...[
    ...switched.map((setting) => {
      const id = `set-${setting.name}`;
      const select = h('select', { id, change: () => {
        const next = [...chosen];
        next[setting.switched] = select.selectedIndex;
        choose(next);
      } }, setting.values.map((value) => h('option', null, value)));
      select.selectedIndex = chosen[setting.switched];
      return h('div', { class: 'choice' },
        h('label', { for: id, title: setting.note || null }, setting.name, setting.by_budget && h('small', null, ' by budget')), select);
    }),
    fixed.length > 0 && h('details', null, h('summary', null, `${fixed.length} fixed in this page`),
      fixed.map((setting) => h('div', { class: 'choice', title: setting.note || null }, h('span', null, setting.name), h('code', null, setting.value)))),
    settings.length === 0 && h('p', { class: 'quiet' }, 'The graph has no settings.')].filter((part) => part));
}

function names_of(plan) {
  return plan.passes.map((pass) => pass.name);
}

function listed(sign, names) {
  const most = 4;
  if (names.length === 0) return null;
  return h('div', { class: sign === '+' ? 'plus' : 'minus' },
    `${sign} ${names.slice(0, most).join(', ')}${names.length > most ? ` and ${names.length - most} more` : ''}`);
}

function memory_change(now, then) {
  if (now === then) return '';
  return ` (${now > then ? '+' : '−'}${bytes_text(Math.abs(now - then))})`;
}

// Compares `plan` with the plan that the page opened with.
export function show_change(panel, plan, first) {
  const now = names_of(plan), then = names_of(first);
  panel.replaceChildren(
    h('div', null, `${now.length} passes, ${plan.passes.reduce((sum, pass) => sum + pass.barriers.length, plan.final_barriers.length)} barriers`),
    h('div', null, `transients ${bytes_text(plan.transient_bytes)}${memory_change(plan.transient_bytes, first.transient_bytes)}`),
    h('div', null, `histories ${bytes_text(plan.history_bytes)}${memory_change(plan.history_bytes, first.history_bytes)}`),
    listed('+', now.filter((name) => !then.includes(name))) ?? '',
    listed('−', then.filter((name) => !now.includes(name))) ?? '');
}
