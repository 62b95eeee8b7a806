// Checks the viewer's page in a headless Chromium for what a reader can do with it. Screenshots are
// written to OUT.
// node viewer_test.mjs NODE_MODULES CHROMIUM DERMIS OUT
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { dermis, finish, check, open as open_page, out, shade, shot } from './browser.mjs';

const most_bytes = 1.5 * 1024 * 1024; // Per page.
const passes_of_large = 1000;
const hostile = '</script><img src=x onerror="window.hurt=1"><!--';

function make_page(name, ...options) {
  const file = join(out, `${name}.html`);
  execFileSync(dermis, ['graph', ...options, '--html', file, '--quiet']);
  return { file, url: pathToFileURL(file).href, bytes: statSync(file).size };
}

// Writes a chain of sums that also read earlier passes, of a pass type of the host.
function write_large_graph() {
  const kinds = join(out, 'kinds.json'), graph = join(out, 'large.json');
  writeFileSync(kinds, JSON.stringify({ dermis_pass_types: 2, pass_types: [{ name: 'test.sum', ports: [
    { name: 'a', usage: 'sampled_image' }, { name: 'b', usage: 'sampled_image' }, { name: 'sum', usage: 'storage_image_write' }] }] }));
  const resources = {}, passes = [];
  const source = (i) => (i < 0 ? 'start' : `r${i}`);
  for (let i = 0; i < passes_of_large; ++i) {
    if (i + 1 < passes_of_large) resources[`r${i}`] = { format: 'rgba16f', size: 'view' };
    passes.push({ pass: `sum_${i}`, type: 'test.sum', read: { a: source(i - 1), b: source(i - 1 - (i * 7) % 40) },
      write: { sum: i + 1 < passes_of_large ? `r${i}` : 'end' } });
  }
  writeFileSync(graph, JSON.stringify({ dermis: 2, name: 'large', imports: { start: { format: 'rgba16f', size: 'view' } },
    resources: { ...resources, end: { format: 'rgba16f', size: 'view' } }, passes, exports: ['end'] }, null, 1));
  return [graph, '--pass-types', kinds];
}

function write_hostile_graph() {
  const graph = join(out, '<img src=x onerror=window.hurt=1>.json');
  writeFileSync(graph, JSON.stringify({ dermis: 2, name: 'hostile', note: hostile, imports: { light: { format: 'rgba16f', size: 'view', note: hostile } },
    settings: { mode: { enum: ['a', 'b'], default: 'a', note: hostile } }, passes: [], exports: [] }, null, 1));
  return [graph];
}

function write_frame_report() {
  const file = join(out, 'report.json');
  const frame = (i) => ({ frame: i, configuration: 'technique=sap, variant=smooth', why: hostile, budget_ms: 30, predicted_ms: 18 - i, measured_ms: i === 0 ? -1 : 17 + i % 3,
    predicted_rmse: 6e-4, view_tiles: 920, scattering_tiles: 300 + i, uniform_tiles: 40, copied_tiles: 10 });
  writeFileSync(file, JSON.stringify({ scene: 'bust', graph: 'configs/graphs/skin.json', device: 'a device', width: 320, height: 180,
    passes: [{ pass: 'classify', milliseconds: 1.4, frames: 7 }, { pass: 'gather', milliseconds: 2.9, frames: 7 }], choices: Array.from({ length: 8 }, (_, i) => frame(i)) }));
  return file;
}

const open = (page_file, scheme = 'light') => open_page(page_file.url, scheme, 'body[data-ready=true]');
const skin = () => ['configs/graphs/skin.json'];

check('the page is small, opens without an error and sends no request', async () => {
  for (const graph of ['skin', 'hybrid', 'sap_residual']) {
    const made = make_page(graph, `configs/graphs/${graph === 'skin' ? '' : 'papers/'}${graph}.json`);
    assert.ok(made.bytes <= most_bytes, `${graph}: ${made.bytes} bytes`);
    const view = await open(made);
    assert.deepEqual(view.problems, []);
    assert.equal(await view.page.title(), `${graph}: frame graph`);
    assert.ok((await view.page.evaluate(() => window.dermis_viewer.counts())).nodes > 0);
    console.log(`  ${graph}: ${made.bytes} bytes, drawn after ${view.seconds.toFixed(2)} s`);
    await view.close();
  }
});

check('selecting a pass in the graph describes it and links to its line of JSON', async () => {
  const view = await open(make_page('select', ...skin()));
  const { page } = view;
  const box = await page.locator('#graph').boundingBox();
  const at = await page.evaluate(() => window.dermis_viewer.place_of('classify'));
  await page.mouse.click(box.x + at.x, box.y + at.y);
  assert.equal(await page.locator('#details h2').textContent(), 'classify');
  assert.match(await page.locator('#details').textContent(), /runs: '[a-z_]+' reads its/);
  assert.match(page.url(), /#pass=classify$/);
  await page.locator('#details .place').click();
  assert.match(await page.locator('.source .here').textContent(), /"pass": "classify"/);
  await page.locator('.source button', { hasText: '"pass": "gather"' }).click();
  assert.equal(await page.locator('#details h2').textContent(), 'gather');
  assert.deepEqual(view.problems, []);
  await view.close();
});

check('switching a choice shows the new plan and the differences', async () => {
  const view = await open(make_page('switch', ...skin()));
  const { page } = view;
  const before = await page.locator('#change').textContent();
  await page.selectOption('#set-technique', 'separable');
  const after = await page.locator('#change').textContent();
  assert.notEqual(after, before);
  assert.match(after, /\+ /);
  assert.equal(await page.locator('#list button[data-name=sap_setup]').evaluate((one) => one.classList.contains('off')), true);
  await page.selectOption('#set-technique', 'sap');
  assert.equal(await page.locator('#change').textContent(), before);
  await page.selectOption('#set-technique', 'off');
  assert.deepEqual(view.problems, []);
  await view.close();
});

check('every tab shows its contents', async () => {
  const view = await open(make_page('tabs', 'configs/graphs/papers/sap_residual.json'));
  const { page } = view;
  assert.ok(await page.locator('#panel-memory rect.block').count() > 20);
  for (const [tab, words] of [['barriers', /read after write/], ['history', /@-1/], ['frames', /dermis render/], ['source', /"passes"/]]) {
    await page.locator(`#tab-${tab}`).click();
    assert.match(await page.locator(`#panel-${tab}`).textContent(), words);
    if (tab === 'history') await shot(page, 'history_of_sap_residual');
  }
  await page.locator('#tab-memory').click();
  await page.locator('#panel-memory rect.block').first().hover();
  assert.match(await page.locator('#tip').textContent(), /of heap 0/);
  assert.deepEqual(view.problems, []);
  await view.close();
});

check('everything can be reached with the keyboard', async () => {
  const view = await open(make_page('keys', ...skin()));
  const { page } = view;
  await page.keyboard.press('/');
  await page.keyboard.type('level_li');
  assert.equal(await page.locator('#list button[data-kind=pass]').count(), 1);
  await page.keyboard.press('Enter');
  assert.equal(await page.locator('#details h2').textContent(), 'level_list');
  await page.keyboard.press('Escape');
  assert.equal(await page.locator('#details h2').count(), 0);
  const reached = new Set();
  await page.evaluate(() => document.activeElement.blur());
  for (let i = 0; i < 40; ++i) {
    await page.keyboard.press('Tab');
    reached.add(await page.evaluate(() => { const at = document.activeElement; return at.id || at.dataset.name || at.tagName; }));
  }
  for (const id of ['search', 'fit', 'theme', 'set-technique', 'graph', 'tab-memory', 'panel-memory', 'details', 'classify'])
    assert.ok(reached.has(id), `Tab does not reach '${id}', only ${[...reached].join(' ')}`);
  await page.locator('#list button').first().focus();
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('ArrowDown');
  assert.equal(await page.locator('#details h2').textContent(), await page.evaluate(() => document.activeElement.dataset.name));
  await page.locator('#tab-memory').focus();
  await page.keyboard.press('ArrowRight');
  assert.equal(await page.locator('#panel-barriers').isVisible(), true);
  assert.deepEqual(view.problems, []);
  await view.close();
});

check('measured times and tiles of a report are in the page', async () => {
  const view = await open(make_page('frame', ...skin(), '--frame', write_frame_report()));
  const { page } = view;
  await page.locator('#tab-frames').click();
  assert.match(await page.locator('#panel-frames').textContent(), /gather2\.90 ms/);
  assert.equal(await page.locator('#panel-frames .uplot').count(), 2);
  assert.match(await page.locator('#panel-frames').textContent(), /technique=sap, variant=smooth/);
  assert.equal(await page.evaluate(() => window.hurt), undefined);
  assert.deepEqual(view.problems, []);
  await shot(page, 'frames_light');
  await view.close();
});

check('text of a file never becomes markup', async () => {
  const made = make_page('hostile', ...write_hostile_graph());
  const view = await open(made);
  await view.page.locator('#list button[data-name=light]').click();
  assert.match(await view.page.locator('#details').textContent(), /<\/script><img/);
  await view.page.locator('#tab-source').click();
  assert.equal(await view.page.evaluate(() => window.hurt), undefined);
  assert.equal(await view.page.locator('img').count(), 0);
  assert.deepEqual(view.problems, []);
  await view.close();
});

check('a graph of 1,000 passes is rendered, and the time is reported', async () => {
  const made = make_page('large', ...write_large_graph());
  const times = [];
  for (let i = 0; i < (process.env.DERMIS_TESTS_FULL ? 3 : 1); ++i) {
    const view = await open(made);
    times.push(view.seconds);
    assert.deepEqual(view.problems, []);
    assert.equal((await view.page.evaluate(() => window.dermis_viewer.counts())).nodes, passes_of_large);
    if (i === 0) await shot(view.page, 'large_light');
    await view.close();
  }
  times.sort((a, b) => a - b);
  console.log(`  ${made.bytes} bytes, drawn after ${times.map((one) => one.toFixed(2)).join(', ')} s`);
});

check('light and dark themes are both rendered', async () => {
  for (const scheme of ['light', 'dark']) {
    const view = await open(make_page(`shown_${scheme}`, ...skin()), scheme);
    const { page } = view;
    assert.equal(await shade(page, 'body') > 3 * 128, scheme === 'light');
    await page.locator('#list button[data-name=gather]').click();
    await shot(page, `graph_${scheme}`);
    for (const tab of ['barriers', 'source']) {
      await page.locator(`#tab-${tab}`).click();
      await shot(page, `${tab}_${scheme}`);
    }
    await page.locator('#theme').click(); // auto -> light
    assert.equal(await shade(page, 'body') > 3 * 128, true);
    await page.locator('#theme').click(); // -> dark
    assert.equal(await shade(page, 'body') > 3 * 128, false);
    assert.deepEqual(view.problems, []);
    await view.close();
  }
});

await finish();
