// Checks pages of `dermis bench --html` in a headless Chromium for what a reader sees and can do.
// Screenshots are written to OUT.
// node report_test.mjs NODE_MODULES CHROMIUM DERMIS OUT
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { dermis, finish, check, open, out, shade, shot } from './browser.mjs';

const text_contrast = 4.5, mark_contrast = 3; // WCAG 2.2, 1.4.3 and 1.4.11
const schemes = ['light', 'dark'];

const url_of = (name) => pathToFileURL(join(out, `${name}.html`)).href;
const bench = (suite, name, ...options) => {
  execFileSync(dermis, ['bench', suite, ...options, '--html', join(out, `${name}.html`), '--quiet', '--json', join(out, `${name}.json`)]);
  return url_of(name);
};

const error_time = bench('error-time', 'error-time', '--quick', '--scenes', 'edge', '--techniques', 'sap,afis,burley,fixed,separable',
  '--cache', join(out, 'cache'));
const dynamic = bench('dynamic', 'dynamic', '--quick', '--scenes', 'flashing', '--framings', 'close', '--techniques', 'sap,sap_residual,afis',
  '--cache', join(out, 'cache'));
execFileSync(dermis, ['bench', 'all', '--quick', '--suites', 'record,skip', '--out', join(out, 'all'), '--cache', join(out, 'cache'), '--quiet']);
const index = url_of('all/index'), skip = url_of('all/skip'), record = url_of('all/record');
const pages = { record, error_time, dynamic, index, skip };

// Returns relative luminance and contrast of page elements after WCAG 2.2.
const contrasts = (page, selector, property) => page.evaluate(([selector, property]) => {
  const channels = (color) => color.match(/[\d.]+/g).map(Number);
  const luminance = (color) => channels(color).slice(0, 3).map((c) => c / 255).map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4))
    .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
  const behind = (one) => { for (let at = one; at; at = at.parentElement) { const color = getComputedStyle(at).backgroundColor, c = channels(color); if (c.length < 4 || c[3] > 0) return color; } };
  return [...document.querySelectorAll(selector)].map((one) => {
    const [a, b] = [luminance(getComputedStyle(one)[property]), luminance(behind(one))];
    return { what: `${one.tagName} ${one.textContent.slice(0, 30)}`, ratio: (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05) };
  });
}, [selector, property]);

// Counts the colours of a screenshot: an unpainted page has only a few.
const colours = async (page, png) => page.evaluate(async (data) => {
  const picture = await createImageBitmap(new Blob([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], { type: 'image/png' }));
  const canvas = new OffscreenCanvas(picture.width, picture.height), context = canvas.getContext('2d');
  context.drawImage(picture, 0, 0);
  const texels = new Uint32Array(context.getImageData(0, 0, picture.width, picture.height).data.buffer), seen = new Set();
  for (let i = 0; i < texels.length; i += 7) seen.add(texels[i]);
  return seen.size;
}, png.toString('base64'));

check('every page opens without an error and sends no request', async () => {
  for (const [name, url] of Object.entries(pages)) {
    const view = await open(url);
    assert.deepEqual(view.problems, [], name);
    assert.ok((await view.page.title()).length > 0, name);
    assert.ok(await view.page.locator('tbody tr').count() > 3, name);
    assert.match(await view.page.locator('dl').textContent(), /command.*dermis bench/s, name);
    await view.close();
  }
});

check('a click on a title sorts the rows by number or word, a second click reverses them, and so do keys', async () => {
  const { page, problems, close } = await open(error_time);
  const column = async (title) => {
    const at = await page.locator('thead th').evaluateAll((all, title) => all.findIndex((one) => one.textContent === title), title);
    return page.locator('tbody tr').evaluateAll((rows, at) => rows.map((row) => row.cells[at].dataset.v ?? row.cells[at].textContent), at);
  };
  const title = (text) => page.locator('thead th').filter({ hasText: new RegExp(`^${text}$`) });
  const sorted = (values, down) => values.every((one, i) => i === 0 || (down ? values[i - 1] >= one : values[i - 1] <= one));
  assert.equal(sorted((await column('RMSE')).map(Number), false), false); // In written order.
  await title('RMSE').click();
  assert.ok(sorted((await column('RMSE')).map(Number), false));
  assert.equal(await title('RMSE').getAttribute('aria-sort'), 'ascending');
  await title('RMSE').click();
  assert.ok(sorted((await column('RMSE')).map(Number), true));
  assert.equal(await title('RMSE').getAttribute('aria-sort'), 'descending');
  await title('technique').focus();
  await page.keyboard.press('Enter');
  assert.ok(sorted(await column('technique'), false));
  assert.equal(await title('RMSE').getAttribute('aria-sort'), null);
  assert.deepEqual(problems, []);
  await close();
});

check('rows without a measurement come last in both sort orders', async () => {
  const { page, close } = await open(skip);
  const title = page.locator('thead th').last(); // Largest difference: not every case has one.
  for (let i = 0; i < 2; ++i) {
    await title.click();
    const last = await page.locator('tbody tr').evaluateAll((rows) => rows.map((row) => row.cells[row.cells.length - 1].textContent.includes('–')));
    assert.ok(last.includes(true) && last.includes(false));
    assert.equal(last.indexOf(true), last.length - last.filter(Boolean).length);
  }
  await close();
});

check('plots show a point for each row, a legend names the colours, and labels do not overlap', async () => {
  for (const [url, of_rows] of [[error_time, true], [dynamic, false], [record, false]]) {
    const { page, close } = await open(url);
    const plots = await page.locator('.plots svg').count();
    assert.ok(plots >= 1);
    if (of_rows) assert.equal(await page.locator('.plots circle').count(), await page.locator('tbody tr').count());
    const covered = await page.locator('.plots svg').evaluateAll((all) => all.flatMap((svg) => {
      const boxes = [...svg.querySelectorAll('text')].map((one) => [one.textContent, one.getBoundingClientRect()]);
      // Ascent and descent are in the box.
      const meet = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom - 2 && b.top < a.bottom - 2;
      return boxes.flatMap(([text, a], i) => boxes.slice(i + 1).filter(([, b]) => meet(a, b)).map(([other]) => `${text} and ${other}`));
    }));
    assert.deepEqual(covered, []);
    const outside = await page.locator('.plots svg').evaluateAll((all) => all.flatMap((svg) => {
      const box = svg.getBoundingClientRect();
      return [...svg.querySelectorAll('text,circle')].map((one) => [one, one.getBoundingClientRect()])
        .filter(([, a]) => a.left < box.left - 1 || a.right > box.right + 1 || a.top < box.top - 1 || a.bottom > box.bottom + 1).map(([one]) => one.textContent);
    }));
    assert.deepEqual(outside, []);
    const names = await page.locator('.legend span').allTextContents();
    assert.equal(new Set(names).size, names.length);
    const own = await page.locator('.legend span:not(.base) circle').evaluateAll((all) => all.map((one) => getComputedStyle(one).stroke));
    assert.equal(new Set(own).size, own.length);
    await close();
  }
  const { page, close } = await open(error_time);
  const grey = await page.locator('.legend .base circle').evaluateAll((all) => all.map((one) => getComputedStyle(one).stroke));
  assert.ok(grey.length >= 3 && new Set(grey).size === 1); // afis, burley, fixed, separable
  await close();
});

check('lines of baselines are distinguishable, and each frame is on the axis', async () => {
  const { page, close } = await open(dynamic);
  const lines = await page.locator('.legend .base .line').evaluateAll((all) => all.map((one) => getComputedStyle(one).strokeDasharray));
  assert.ok(lines.length >= 5);
  assert.equal(new Set(lines).size, lines.length);
  const labels = await page.locator('.plots svg').first().locator('text').allTextContents();
  for (const frame of ['0', '1', '2', '3']) assert.ok(labels.includes(frame), labels.join(' '));
  await close();
});

check('pictures are rendered, and rows explain their marks', async () => {
  const { page, close } = await open(error_time);
  const widths = await page.locator('img').evaluateAll((all) => Promise.all(all.map((one) => one.decode().then(() => one.naturalWidth))));
  assert.ok(widths.length > 5 && widths.every((one) => one > 0));
  assert.match(await page.locator('p', { hasText: 'Click a title' }).textContent(), /Marked rows are on the front\.$/);
  // The number depends on times.
  const on_front = JSON.parse(readFileSync(join(out, 'error-time.json'))).rows.filter((row) => row.on_pareto_front).length;
  assert.ok(on_front > 0);
  assert.equal(await page.locator('tr.best').count(), on_front);
  await close();
  const laws = await open(record);
  assert.match(await laws.page.locator('p', { hasText: 'Click a title' }).textContent(), /miss their limits \(column 'goal met'\)/);
  assert.equal(await laws.page.locator('tr.bad').count(), await laws.page.locator('td:last-child', { hasText: 'no' }).count());
  assert.equal(await laws.page.locator('tr.best').count(), 0);
  await laws.close();
});

check('light and dark themes are readable, as wide as the window, and rendered', async () => {
  for (const scheme of schemes)
    for (const [name, url] of Object.entries(pages)) {
      const { page, problems, close } = await open(url, scheme);
      assert.equal(await shade(page, 'body') > 3 * 128, scheme === 'light');
      for (const one of await contrasts(page, 'h1,h2,p,dt,dd,th,td,a,figcaption,.legend span', 'color'))
        assert.ok(one.ratio >= text_contrast, `${name} ${scheme}: '${one.what}' has a contrast of ${one.ratio.toFixed(2)}`);
      for (const one of await contrasts(page, 'svg text', 'fill'))
        assert.ok(one.ratio >= text_contrast, `${name} ${scheme}: '${one.what}' has a contrast of ${one.ratio.toFixed(2)}`);
      for (const one of await contrasts(page, '.plots circle,.line', 'stroke'))
        assert.ok(one.ratio >= mark_contrast, `${name} ${scheme}: a mark has a contrast of ${one.ratio.toFixed(2)}`);
      const sizes = await page.evaluate(() => ({ page: document.documentElement.scrollWidth, window: innerWidth,
        cut: [...document.querySelectorAll('td,th')].filter((one) => one.scrollWidth > one.clientWidth + 1).map((one) => one.textContent) }));
      assert.ok(sizes.page <= sizes.window, `${name}: ${sizes.page} px of ${sizes.window}`);
      assert.deepEqual(sizes.cut, []);
      const png = await shot(page, `${name}_${scheme}`, { fullPage: true });
      assert.ok(await colours(page, png) > 40, `${name} ${scheme}`);
      assert.deepEqual(problems, []);
      await close();
    }
});

check('the index links to the page of each suite, and no link is broken', async () => {
  const { page, problems, close } = await open(index);
  assert.deepEqual(await page.locator('tbody tr td:first-child').allTextContents(),
    ['record', 'skip', 'truth', 'supplement', 'compile', 'stability', 'budget', 'error-time', 'error-table', 'dynamic', 'restir']);
  assert.equal(await page.locator('tbody tr', { hasText: 'not measured' }).count(), 9);
  await page.locator('a', { hasText: /^skip$/ }).click();
  assert.equal(await page.title(), 'Frames that do not need all of a graph');
  assert.match(await page.locator('dl').textContent(), /figures are meaningless/);
  assert.deepEqual(problems, []);
  await close();
});

await finish();
