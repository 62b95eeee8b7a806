// The page: one state (configuration and selection), redrawn on change.
import { make_configurations, unpack } from './data.js';
import { show_barriers } from './barriers_view.js';
import { show_change, show_choices } from './choices.js';
import { pass_details, resource_details } from './details.js';
import { by_id, bytes_text, h } from './dom.js';
import { show_frames } from './frames_view.js';
import { make_graph_view } from './graph_view.js';
import { show_history } from './history_view.js';
import { make_list } from './list_view.js';
import { show_memory } from './memory_view.js';
import { make_source_view } from './source_view.js';
import { make_tabs } from './tabs.js';
import { make_theme_button } from './theme.js';

async function start() {
  const data = await unpack(by_id('data').textContent);
  const configurations = make_configurations(data);
  const first = configurations.at(configurations.first).plan;
  const state = { values: configurations.first, plan: first, kind: null, name: null };
  const declared = { pass: new Map(data.passes.map((one) => [one.name, one])), resource: new Map(data.resources.map((one) => [one.name, one])) };
  const times = Object.fromEntries((data.frame?.passes ?? []).map((pass) => [pass.pass, pass.milliseconds]));

  document.title = `${data.graph}: frame graph`;
  by_id('title').textContent = data.graph;
  by_id('about').textContent = `${first.view[0]}x${first.view[1]}, ${configurations.count} configuration${configurations.count === 1 ? '' : 's'} · ${data.command}`;

  const describe = (node) => {
    const plan = state.plan;
    const reason = plan.reasons.find((one) => one.about === (node.kind === 'pass' ? 'pass' : 'resource') && one.name === node.name)?.text ?? '';
    if (node.kind === 'pass') return `${node.name}: ${plan.passes[node.pass].kind}\n${reason}`;
    const resource = plan.resources[node.resource];
    return `${node.label}: ${resource.type === 'image' ? `${resource.format.name} ${resource.width}x${resource.height}` : bytes_text(resource.bytes)}\n${reason}`;
  };

  const graph = make_graph_view(by_id('graph'), select, describe);
  const list = make_list(by_id('list'), by_id('search'), select, (names) => graph.mark(names));
  const source = make_source_view(by_id('panel-source'), data.files,
    [...data.passes.map((one) => ({ ...one, kind: 'pass' })), ...data.resources.map((one) => ({ ...one, kind: 'resource' }))], select);
  const source_button = (one) => one.file !== null && h('button', { class: 'place', click: () => { tabs.show('source'); source.show(one.file, one.line); } },
    `${data.files[one.file].name}:${one.line}`);
  const tabs = make_tabs(by_id('tabs'), (name) => {
    const panel = by_id(`panel-${name}`);
    if (name === 'memory') show_memory(panel, state.plan, state.kind === 'resource' ? state.name : null, select);
    if (name === 'barriers') show_barriers(panel, state.plan, state, select);
    if (name === 'history') show_history(panel, state.plan, select);
    if (name === 'frames') show_frames(panel, data.frame, select);
    if (name === 'source') {
      const one = state.kind === null ? null : declared[state.kind].get(state.name);
      source.show(one?.file ?? null, one?.line ?? null);
    }
  });

  function show_details() {
    const tools = { choose: select, source_button };
    const one = state.kind === null ? null : declared[state.kind].get(state.name);
    by_id('details').replaceChildren(...(!one ? [h('p', { class: 'quiet' }, 'Select a pass or a resource: in the graph, in the list, or with the arrow keys in the list.'),
      ...state.plan.reasons.filter((reason) => reason.about === 'order' || reason.about === 'setting').map((reason) => h('p', null, reason.text))]
      : state.kind === 'pass' ? pass_details(state.plan, one, times[one.name], tools) : resource_details(state.plan, one, tools)).filter((part) => part));
  }

  function select(kind, name) {
    Object.assign(state, { kind, name });
    list.select(kind, name);
    graph.select(kind, name);
    show_details();
    tabs.redraw();
    try { history.replaceState(null, '', kind === null ? '#' : `#${kind}=${encodeURIComponent(name)}`); } catch { /* pages without an address */ }
  }

  function show_plan() {
    const plan = state.plan;
    const runs = new Set(plan.passes.map((pass) => pass.name)), there = new Set(plan.resources.map((one) => one.name));
    list.show([
      ...data.passes.map((one) => ({ kind: 'pass', name: one.name, off: !runs.has(one.name), words: `${one.name} ${one.kind} ${one.note}`.toLowerCase() })),
      ...data.resources.map((one) => ({ kind: 'resource', name: one.name, off: !there.has(one.name), words: `${one.name} ${one.note}`.toLowerCase() })),
    ]);
    graph.show(plan, times);
    show_change(by_id('change'), plan, first);
    select(state.kind, state.name);
  }

  function choose_configuration(values) {
    const configuration = configurations.at(values);
    by_id('problem').textContent = configuration.problem ? `There is no plan for these settings: ${configuration.problem}` : '';
    state.values = values;
    show_choices(by_id('choices'), data.settings, values, choose_configuration);
    if (!configuration.plan) return;
    state.plan = configuration.plan;
    show_plan();
  }

  make_theme_button(by_id('theme'), () => { graph.restyle(); tabs.redraw(); });
  by_id('fit').addEventListener('click', () => graph.fit());
  addEventListener('resize', () => graph.resize());
  addEventListener('keydown', (event) => {
    if (event.key === 'Escape') { by_id('search').value = ''; by_id('search').dispatchEvent(new Event('input')); select(null, null); }
    if (event.key === '/' && !['INPUT', 'SELECT'].includes(document.activeElement?.tagName)) { event.preventDefault(); by_id('search').focus(); }
  });

  const asked = /^#(pass|resource)=(.*)$/.exec(location.hash);
  if (asked) try { Object.assign(state, { kind: asked[1], name: decodeURIComponent(asked[2]) }); } catch { /* not an address of ours */ }
  if (state.kind !== null && !declared[state.kind].has(state.name)) Object.assign(state, { kind: null, name: null });
  choose_configuration(configurations.first);
  document.body.dataset.ready = 'true';
  window.dermis_viewer = { counts: graph.counts, place_of: graph.place_of }; // for tests
}

start().catch((problem) => {
  by_id('problem').textContent = `This page cannot be shown: ${problem.message}. It needs a browser of 2023 or later.`;
  throw problem;
});
