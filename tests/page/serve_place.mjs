// One job in the page of `lamplock serve` from its model to its end on a virtual board: connect,
// load, place (handles and numbers), check, run, hold, resume, stop.
//
// usage: node serve_place.mjs LAMPLOCK [FOLDER_FOR_PICTURES]
// exit status: 0 passed; 1 failed; 77 no Chromium (toolchain/setup test, or the variable CHROMIUM)

import { spawnSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';

import { Browser } from './browser.mjs';
import { call, check, chromium, drop, end, folder, jobs, keep_picture, open, program, start_server, text_of, until } from './serve_tools.mjs';

// A pyramid on a square of 20 mm, 10 mm high.
const apex = [0, 0, 10], base = [[-10, -10, 0], [10, -10, 0], [10, 10, 0], [-10, 10, 0]];
const faces = [...base.map((corner, i) => [corner, base[(i + 1) % 4], apex]), [base[0], base[3], base[2]], [base[0], base[2], base[1]]];
const stl = ['solid pyramid', ...faces.map((face) => ['facet normal 0 0 0', 'outer loop', ...face.map((at) => `vertex ${at.join(' ')}`),
  'endloop', 'endfacet'].join('\n')), 'endsolid'].join('\n');
const description = '[[object]]\nfile = "pyramid.stl"\nsize = 20\nspacing = 0.8\n';

const value_of = (page, id) => page.ask(`document.getElementById('${id}').value`);
const number_of = async (page, id) => Number(await value_of(page, id));
const enter = (page, id, value) => page.ask(`(() => {
  const input = document.getElementById('${id}');
  input.value = ${JSON.stringify(value)};
  input.dispatchEvent(new Event('input', { bubbles: true }));
})()`);

async function load(page) {
  await drop(page, 'pyramid.stl', stl);
  await until('the model is listed', async () => (await value_of(page, 'models')) === 'pyramid.stl');
  await drop(page, 'pyramid.toml', description);
  await until('the description is listed', async () => (await value_of(page, 'models')) === 'pyramid.toml');
  await page.click('#place');
  await until('the object is shown', () => page.ask(`!document.getElementById('placing').hidden && Number(document.getElementById('views').dataset.shown) > 500`));
  await page.ask(`(() => {
    const which = document.getElementById('which');
    which.value = 'top';
    which.dispatchEvent(new Event('change'));
    document.getElementById('marks').scrollIntoView({ block: 'center', behavior: 'instant' });
  })()`);
  await page.frames(2);
}

// By the handles in the view from above, whose middle is the middle of the work space.
async function use_handles(page) {
  const box = await page.ask(`(() => {
    const { x, y, width, height } = document.getElementById('marks').getBoundingClientRect();
    return { x: x + width / 2, y: y + height / 2, side: Math.min(width, height) };
  })()`);
  const scale = 0.85 * box.side / Math.hypot(100, 100, 100);
  const at = (x_mm, y_mm, up_px = 0) => ({ x: box.x + x_mm * scale, y: box.y - y_mm * scale - up_px });
  await page.drag(at(2, 3), at(14, -5));
  const [x, y] = [await number_of(page, 'object-x'), await number_of(page, 'object-y')];
  check('the frame moves the object', Math.abs(x - 12) < 0.3 && Math.abs(y + 8) < 0.3, { x, y });
  await page.drag(at(x, y + 10, 26), at(x + 15, y));
  const turn = await number_of(page, 'object-turn-z');
  check('the knob turns it', Math.abs(turn + 90) < 1, turn);
  await enter(page, 'object-turn-z', '-90');
  await page.drag(at(x + 10, y + 10), at(x + 15, y + 15));
  const factor = await number_of(page, 'object-scale');
  check('a corner scales it', Math.abs(factor - 1.5) < 0.05, factor);
  check('its middle stays', Math.abs(await number_of(page, 'object-x') - x) < 0.01);
}

async function use_numbers(page) {
  for (const [id, value] of [['object-x', '12'], ['object-y', '-8'], ['object-z', '5'], ['object-scale', '1.5'], ['object-turn-z', '-90']])
    await enter(page, id, value);
  await page.click('#object-mirror-x');
  await enter(page, 'scene-name', 'placed.toml');
  await page.ask(`(() => {
    const which = document.getElementById('which');
    which.value = 'four';
    which.dispatchEvent(new Event('change'));
    document.getElementById('place-title').scrollIntoView();
  })()`);
  await page.frames(3);
  await keep_picture(page, 'serve-place', false);
}

async function make_and_check(page) {
  await page.click('#job-make');
  await until('the job is made and checked', async () => (await value_of(page, 'jobs')) === 'placed.llj' && /points; X/.test(await text_of(page, 'checked')), 30_000);
  const text = readFileSync(join(jobs, 'placed.toml'), 'utf8').replaceAll("'", '"');
  check('the description has the placement', text.includes('transform = ["mirror x", "scale 1.5", "rotate z -90", "move 12 -8 5"]'), text);
  check('the description keeps the rest', /spacing = 0.8/.test(text) && /size = 20/.test(text) && /file = "pyramid.stl"/.test(text), text);
  const again = join(folder, 'again.llj');
  const made = spawnSync(program, ['job', join(jobs, 'placed.toml'), '-o', again]);
  check('lamplock job makes the same job', made.status === 0 && readFileSync(again).equals(readFileSync(join(jobs, 'placed.llj'))), String(made.stderr));
  const facts = await text_of(page, 'checked');
  const [low, high] = /X (-?[\d.]+) to (-?[\d.]+)/.exec(facts).slice(1).map(Number);
  check('the job lies where it was placed', Math.abs(low + 3) < 0.3 && Math.abs(high - 27) < 0.3, facts);
}

async function run(page, server) {
  await page.click('#start');
  await until('the job runs', async () => (await call(server, 'status')).job.done > 50, 20_000);
  await page.click('#hold');
  await until('hold', async () => /held/.test(await text_of(page, 'job-text')));
  const held = (await call(server, 'status')).job.done;
  await page.click('#resume');
  await until('resume', async () => (await call(server, 'status')).job.done > held + 20, 20_000);
  await page.click('#stop');
  await until('stop', async () => /stopped/.test(await text_of(page, 'job-text')));
  await until('idle after a stop', async () => (await call(server, 'status')).board.state === 'Idle');
}

// The report of the stopped job, from the history: a document without access to the page.
async function open_report(browser, page, server) {
  await until('the history links to the report', () => page.ask(
      `(document.getElementById('history-read').click(), document.querySelector('#history a') !== null)`));
  const link = await page.ask(`(({ href, target, rel }) => ({ href, target, rel }))(document.querySelector('#history a'))`);
  check('it opens in another tab', link.target === '_blank' && link.rel === 'noopener', link);
  await page.ask(`document.getElementById('history-title').scrollIntoView()`);
  await page.frames(2);
  await keep_picture(page, 'serve-history', false);
  const report = await browser.open(link.href);
  await until('the report shows the numbers of the job', async () => /placed/.test(await text_of(report, 'title')) &&
      /fired/.test(await text_of(report, 'tiles')));
  check('the report has the beats by reason', /a shot.*moving/.test(await text_of(report, 'reasons')), await text_of(report, 'reasons'));
  check('the report has no access to the page', await report.ask(`(() => {
    try { return sessionStorage.getItem('token') === undefined; } catch { return self.origin === 'null'; }
  })()`));
  check('no complaints of the report', report.complaints.length === 0, report.complaints);
  await keep_picture(report, 'serve-report');
  const phone = await browser.open(link.href, { width: 360, height: 740, dark: true, touch: true });
  check('the report fits into 360 px', await phone.ask('document.documentElement.scrollWidth <= 360'));
  await keep_picture(phone, 'serve-report-phone', false);
}

let server;
try {
  server = await start_server();
  const browser = new Browser(chromium, { webgl: false });
  const page = await open(browser, server, {});
  await load(page);
  await use_handles(page);
  await use_numbers(page);
  await make_and_check(page);
  await run(page, server);
  await open_report(browser, page, server);
  check('no complaints', page.complaints.length === 0, page.complaints);
  const phone = await open(browser, server, { width: 360, height: 740, dark: true, touch: true });
  await until('models are listed', async () => (await value_of(phone, 'models')) !== '');
  await phone.ask(`document.getElementById('models').value = 'placed.toml'`);
  await phone.click('#place');
  await until('the phone shows the object', () => phone.ask(`Number(document.getElementById('views').dataset.shown) > 500`));
  check('fits into 360 px', await phone.ask('document.documentElement.scrollWidth <= 360'), await phone.ask('document.documentElement.scrollWidth'));
  await phone.ask(`document.getElementById('place-title').scrollIntoView()`);
  await phone.frames(3);
  await keep_picture(phone, 'serve-place-phone');
  await browser.close();
  server.child.removeAllListeners('exit');
} catch (error) {
  check(error.stack, false);
}
end(server);
