// Opens pages of the command one by one in a headless Chromium, and runs checks on them.
import { mkdirSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join, resolve } from 'node:path';

const [modules, executablePath] = process.argv.slice(2);
export const [dermis, out] = process.argv.slice(4);
const { chromium } = createRequire(join(resolve(modules), '..', 'package.json'))('playwright-core');

rmSync(out, { recursive: true, force: true });
mkdirSync(out, { recursive: true });

const browser = await chromium.launch({ executablePath, args: ['--no-sandbox', '--disable-gpu'] });

// Opens a page offline and collects all errors; `ready` exists once the page is complete.
export async function open(url, scheme = 'light', ready = 'body') {
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, colorScheme: scheme, offline: true });
  const page = await context.newPage();
  page.setDefaultTimeout(60000); // Busy machines need more time.
  const problems = [];
  page.on('pageerror', (error) => problems.push(String(error)));
  page.on('console', (message) => { if (['error', 'warning'].includes(message.type())) problems.push(message.text()); });
  page.on('request', (request) => { if (!request.url().startsWith('file:') && !/^(data|blob):/.test(request.url())) problems.push(`asks for ${request.url()}`); });
  const before = performance.now();
  await page.goto(url);
  await page.waitForSelector(ready);
  // The page is painted.
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  return { page, problems, seconds: (performance.now() - before) / 1000, close: () => context.close() };
}

export const shot = (page, name, options = {}) => page.screenshot({ path: join(out, `${name}.png`), ...options });

// Returns the sum of the channels of the background, 0 to 765.
export const shade = (page, element) =>
  page.evaluate((one) => getComputedStyle(document.querySelector(one)).backgroundColor.match(/\d+/g).map(Number).reduce((a, b) => a + b, 0), element);

const checks = [];
export const check = (name, work) => checks.push([name, work]);

// Runs all checks and ends the program.
export async function finish() {
  let failed = 0;
  for (const [name, work] of checks) {
    const before = performance.now();
    try {
      await work();
      console.log(`ok: ${name} (${((performance.now() - before) / 1000).toFixed(1)} s)`);
    } catch (problem) {
      failed += 1;
      console.log(`FAILED: ${name}\n${problem.stack}`);
    }
  }
  await browser.close();
  process.exit(failed === 0 ? 0 : 1);
}
