// The page of a job in a real browser: it opens, shows the numbers of the report, draws, and reacts
// to mouse and keys.
//
// usage: node page.mjs LAMPLOCK [FOLDER_FOR_PICTURES]
// exit status: 0 passed; 1 failed; 77 no Chromium (toolchain/setup test, or the variable CHROMIUM)

import { execFileSync, spawnSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { Browser } from './browser.mjs';

const not_there = 77;
const [program, pictures] = process.argv.slice(2);
if (program === undefined) {
  console.log('usage: node page.mjs LAMPLOCK [FOLDER_FOR_PICTURES]');
  process.exit(2);
}
const chromium = process.env.CHROMIUM ?? 'chromium';
if (spawnSync(chromium, ['--version']).status !== 0) {
  console.log(`${chromium} is not installed; run toolchain/setup`);
  process.exit(not_there);
}
const scale = Number(process.env.LAMPLOCK_TEST_SCALE ?? 1);
// Without a graphics card a picture of a million points takes seconds.
const many = scale < 20 ? 150_000 : 1_000_000;
const bytes_per_point = 15;
const folder = mkdtempSync(join(tmpdir(), 'lamplock-page-'));

let failures = 0;
function check(what, holds, more = '') {
  console.log(`${holds ? 'ok    ' : 'FAILED'}  ${what}`);
  if (holds) return;
  ++failures;
  if (more !== '') console.log(`        ${JSON.stringify(more)}`);
}

function lamplock(...args) {
  execFileSync(program, args, { stdio: ['ignore', 'ignore', 'inherit'] });
}

async function keep_picture(page, name) {
  if (pictures === undefined) return;
  mkdirSync(pictures, { recursive: true });
  writeFileSync(join(pictures, `${name}.png`), await page.picture(true));
}

// A spiral up a vase, in the order of creation, with some jumps.
function vase(count) {
  const lines = [];
  for (let i = 0; i < count; ++i) {
    const t = i / count, turn = 2 * Math.PI * t * Math.sqrt(count) * 0.4;
    const radius = 12 + 5 * Math.sin(9 * t) + (i % 97 === 0 ? 1 : 0);
    lines.push(`${(radius * Math.cos(turn)).toFixed(4)} ${(radius * Math.sin(turn)).toFixed(4)} ${(40 * t - 20).toFixed(4)}`);
  }
  return `${lines.join('\n')}\n`;
}

// Number of painted pixels of the canvas, and a checksum that distinguishes pictures.
function drawn(page) {
  return page.ask(`(() => {
    const view = lamplock.cloud.view, gl = view.gl;
    view.draw();
    const pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
    gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    let painted = 0, sum = 0;
    for (let i = 0; i < pixels.length; i += 4) {
      if (pixels[i + 3] === 0) continue;
      ++painted;
      sum = (sum * 31 + (i ^ pixels[i] ^ (pixels[i + 1] << 8) ^ (pixels[i + 2] << 16))) % 1000000007;
    }
    return {painted, sum};
  })()`);
}

function check_silence(page, what) {
  check(`${what}: no complaint in the console`, page.complaints.length === 0, page.complaints);
  const asked = page.requests.filter((url) => !url.startsWith('file:') && !url.startsWith('data:'));
  check(`${what}: asks no server`, asked.length === 0 && page.requests.length > 0, page.requests);
}

// Compares every number that has a key with the report, and its text with its value.
async function check_numbers(page, report) {
  const shown = await page.ask(`[...document.querySelectorAll('[data-key]')].map((e) =>
    ({key: e.dataset.key, value: e.dataset.value, text: e.textContent}))`);
  const keys = new Set(shown.map(({ key }) => key));
  for (const key of ['points', 'shots', 'beats', 'beats_before', 'utilisation', 'time_s', 'beats_per_point', 'missed', 'doubled'])
    check(`${key} is shown`, keys.has(key));
  const wrong = shown.filter(({ key, value }) => value !== String(report[key]));
  check(`${shown.length} numbers are those of report.json`, wrong.length === 0, wrong);
  const counts = ['points', 'shots', 'beats', 'beats_before', 'missed', 'doubled'];
  const misread = shown.filter(({ key, text }) => counts.includes(key) && text.replace(/\D/g, '') !== String(report[key]));
  check('counts are written out in full', misread.length === 0, misread);
  const use = shown.find(({ key }) => key === 'utilisation').text;
  check('utilisation is written in per cent', use === `${(100 * report.utilisation).toFixed(1)} %`, use);
  const reasons = await page.ask(`Object.fromEntries([...document.querySelectorAll('[data-reason]')].map((e) =>
    [e.dataset.reason, Number(e.dataset.value)]))`);
  const wanted = Object.fromEntries(Object.entries(report.beats_by_reason).filter(([, beats]) => beats > 0));
  check('beats by reason are those of report.json',
        JSON.stringify(Object.entries(reasons).sort()) === JSON.stringify(Object.entries(wanted).sort()), reasons);
  const settings = await page.ask(`Object.fromEntries([...document.querySelectorAll('[data-setting]')].map((e) =>
    [e.dataset.setting, Number(e.textContent)]))`);
  const differ = Object.keys(report.settings).filter((name) => settings[name] !== report.settings[name]);
  check(`${Object.keys(settings).length} settings are those of report.json`, differ.length === 0, differ);
}

async function check_cloud(page) {
  const by_order = await drawn(page);
  check('the cloud is drawn', by_order.painted > 2000, by_order);
  const again = await drawn(page);
  check('the same picture twice', again.sum === by_order.sum);
  const sums = { order: by_order.sum };
  for (const mode of ['beats', 'missed']) {
    await page.click(`label:has(input[value=${mode}])`);
    await page.frames(2);
    sums[mode] = (await drawn(page)).sum;
    check(`colours by ${mode}`, (await page.ask(`document.querySelector('input[value=${mode}]').checked`)) &&
                                (await page.ask(`lamplock.cloud.view.mode`)) === mode);
    await keep_picture(page, `by-${mode}`);
  }
  check('every colouring is another picture', new Set(Object.values(sums)).size === 3, sums);
  const legend = await page.ask(`document.getElementById('legend').textContent`);
  check('the legend counts', /missed: 0/.test(legend), legend);
  await page.click('label:has(input[value=order])');
}

async function check_hands(page) {
  const camera = () => page.ask(`({...lamplock.cloud.view.camera, matrix: 0})`);
  const middle = await page.place('#canvas');
  const before = await camera();
  await page.drag(middle, { x: middle.x + 80, y: middle.y - 30 });
  const turned = await camera();
  check('dragging turns', turned.yaw > before.yaw + 0.3 && turned.tilt < before.tilt - 0.1, [before, turned]);
  await page.mouse('mouseWheel', middle.x, middle.y, { deltaX: 0, deltaY: -400 });
  await page.frames(1);
  check('the wheel zooms', (await camera()).zoom > 1.5 * turned.zoom, await camera());
  await page.ask(`document.getElementById('canvas').focus()`);
  for (const key of ['ArrowLeft', '0']) await page.send('Input.dispatchKeyEvent', { type: 'keyDown', key });
  check('keys turn and reset', (await camera()).zoom === 1 && (await camera()).yaw === before.yaw, await camera());
  await page.click('#turn');
  await page.frames(10);
  check('it turns by itself', (await camera()).yaw > before.yaw);
  await page.click('#turn');
  await page.click('#reset');
  await page.frames(2);
}

async function check_tip(page) {
  // The point nearest to the eye, and its position on the screen.
  const wanted = await page.ask(`(() => {
    const view = lamplock.cloud.view, places = new Uint16Array(view.bytes.buffer);
    view.draw();
    let best = {w: Infinity};
    for (let i = 0; i < view.count; ++i) {
      const at = view.project(...[0, 1, 2].map((k) => places[4 * i + k] / 65535 - 0.5));
      if (at.w < best.w) best = {...at, i};
    }
    const box = view.canvas.getBoundingClientRect();
    return {i: best.i, x: box.x + best.x, y: box.y + best.y};
  })()`);
  await page.mouse('mouseMoved', wanted.x, wanted.y);
  await page.frames(3);
  const tip = await page.ask(`document.getElementById('tip').hidden ? '' : document.getElementById('tip').textContent`);
  check('a tip names the point under the mouse', tip.replace(/\u00a0/g, '').startsWith(`point ${wanted.i}\n`), [tip, wanted]);
}

async function check_controls(page) {
  const all = (await drawn(page)).painted;
  await page.ask(`(() => {
    const slider = document.getElementById('progress');
    slider.value = 250;
    slider.dispatchEvent(new Event('input'));
  })()`);
  await page.frames(2);
  const part = (await drawn(page)).painted;
  const text = await page.ask(`document.getElementById('progress-text').textContent`);
  check('a part of the job can be shown', part < all && part > 0 && /^1\D?000 of 4\D?000 points/.test(text), [part, all, text]);
  await page.click('#play');
  await page.frames(30);
  check('playing continues from there', (await page.ask(`lamplock.cloud.view.shown`)) > 1000);
  await page.click('#play');
  const dark = await page.ask(`document.documentElement.dataset.theme`);
  await page.click('#theme');
  check('the theme changes', (await page.ask(`document.documentElement.dataset.theme`)) !== dark);
  await page.ask(`(() => {
    document.querySelector('details').open = true;
    const filter = document.getElementById('settings-filter');
    filter.value = 'acceleration_x';
    filter.dispatchEvent(new Event('input'));
  })()`);
  const rows = await page.ask(`[...document.querySelectorAll('#settings tbody tr')].filter((r) => !r.hidden).length`);
  check('settings can be filtered', rows >= 1 && rows < 5, rows);
}

async function check_charts(page) {
  const charts = await page.ask(`[...document.querySelectorAll('.chart')].map((chart) => ({
    name: chart.id, bars: chart.querySelectorAll('.bar, .curve').length,
    label: chart.querySelector('svg')?.getAttribute('aria-label') ?? ''}))`);
  for (const { name, bars, label } of charts)
    check(`${name} is drawn and has a text`, bars > 0 && label.length > 10, [bars, label]);
}

// Pairs of texts that overlap in a chart, cards without contents, tiles alone in a row, and open
// bars without a label that says so.
async function check_layout(page, what) {
  const found = await page.ask(`(() => {
    const overlap = (a, b) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1;
    const overlapping = [];
    for (const svg of document.querySelectorAll('.chart svg')) {
      const texts = [...svg.querySelectorAll('text')];
      texts.forEach((a, i) => texts.slice(i + 1).forEach((b) => {
        if (overlap(a.getBoundingClientRect(), b.getBoundingClientRect())) overlapping.push([a.textContent, b.textContent]);
      }));
    }
    const shown = [...document.querySelectorAll('.card')].filter((card) => card.offsetParent !== null);
    const empty = shown.filter((card) => !card.querySelector('canvas, svg, tbody tr, .reason, details')).map((card) => card.id);
    const tiles = [...document.querySelectorAll('.tile')].map((tile) => tile.getBoundingClientRect());
    const row = tiles.filter((tile) => Math.abs(tile.top - tiles[tiles.length - 1].top) < 1);
    const alone = tiles.length > 1 && row.length === 1 && row[0].width < 0.9 * document.getElementById('tiles').clientWidth;
    const labels = [...document.querySelectorAll('#spacing-chart text')].map((text) => text.textContent);
    const closed = lamplock.data.spacing_mm.open && !labels.some((text) => text.startsWith('\u2265'));
    return {overlapping, empty, alone, closed};
  })()`);
  check(`${what}: texts of charts do not overlap`, found.overlapping.length === 0, found.overlapping);
  check(`${what}: no card is empty`, found.empty.length === 0, found.empty);
  check(`${what}: no tile is alone`, !found.alone);
  check(`${what}: the last bar is labelled as open`, !found.closed);
}

// The sizes of the box at its edges, seen from all sides.
async function check_dimensions(page) {
  const overlapping = await page.ask(`(() => {
    const {view} = lamplock.cloud, bad = [];
    for (let turn = 0; turn < 24; ++turn) {
      view.camera.turn(0.27, turn % 5 === 0 ? 0.4 : -0.1);
      view.draw();
      const boxes = [...document.querySelectorAll('#dimensions span')].filter((label) => !label.hidden).map((label) => label.getBoundingClientRect());
      boxes.forEach((a, i) => boxes.slice(i + 1).forEach((b) => {
        if (a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom) bad.push(turn);
      }));
    }
    view.camera.reset();
    return bad;
  })()`);
  check('sizes at the box do not overlap', overlapping.length === 0, overlapping);
}

// How the job was made, and that the folder has what repeats it.
async function check_making(page, report, out) {
  const shown = await page.ask(`Object.fromEntries([...document.querySelectorAll('[data-making]')].map((e) => [e.dataset.making, e.textContent]))`);
  for (const key of ['input', 'order', 'method', 'command'])
    check(`${key} is that of report.json`, shown[key] === report[key], [shown[key], report[key]]);
  check('the command is the one of the run', /lamplock engrave .*small\.xyz --order given --report /.test(report.command ?? ''), report.command);
  check('the description is in the folder', readFileSync(join(out, 'job.toml'), 'utf8').includes('small.xyz'));
}

// Elements that need a name but have none. Clipped text needs a visual check.
async function check_access(page) {
  const nameless = await page.ask(`[...document.querySelectorAll('button, input, canvas, section, svg')].filter((e) =>
    !(e.getAttribute('aria-label') || e.getAttribute('aria-labelledby') || e.textContent.trim() ||
      e.closest('label'))).map((e) => e.outerHTML.slice(0, 80))`);
  check('everything to use has a name', nameless.length === 0, nameless);
  check('the page has a language and a title', await page.ask(`document.documentElement.lang === 'en' && document.title.includes('small.xyz')`));
}

async function small_job(browser) {
  const input = join(folder, 'small.xyz'), out = join(folder, 'small');
  writeFileSync(input, vase(4000));
  lamplock('engrave', input, '--order', 'given', '--report', out);
  const report = JSON.parse(readFileSync(join(out, 'report.json'), 'utf8'));
  const url = `file://${out}/report.html`;
  const page = await browser.open(url);
  await check_numbers(page, report);
  await check_making(page, report, out);
  await check_charts(page);
  await check_layout(page, 'a small job');
  await check_access(page);
  await check_dimensions(page);
  await keep_picture(page, 'light');
  await check_cloud(page);
  await check_hands(page);
  await check_tip(page);
  await check_controls(page);
  check_silence(page, 'a small job');

  const dark = await browser.open(url, { dark: true });
  check('dark where the system is', (await dark.ask(`getComputedStyle(document.body).backgroundColor`)) !== (await page.ask(`getComputedStyle(document.body).backgroundColor`)) ||
                                    (await page.ask(`document.documentElement.dataset.theme`)) === 'dark');
  await keep_picture(dark, 'dark');
  const phone = await browser.open(url, { dark: true, width: 390, height: 844, scale: 2, touch: true });
  const width = await phone.ask(`document.documentElement.scrollWidth`);
  check('nothing is wider than a phone', width <= 390, width);
  await check_layout(phone, 'a phone');
  const tablet = await browser.open(url, { width: 820, height: 1180 });
  await check_layout(tablet, 'a tablet');
  check('the cloud is drawn on a phone', (await drawn(phone)).painted > 2000);
  await keep_picture(phone, 'phone');
  check_silence(phone, 'a phone');
  return url;
}

// A dry run, and the rest of a job with pauses: which points are shown as what, and where the labels
// of the sizes are.
async function parts_of_jobs(browser) {
  const input = join(folder, 'flat.xyz');
  writeFileSync(input, '0 0 0\n8 0 0\n8 8 0\n0 8 0\n4 4 0\n');
  const legend = (page) => page.ask(`document.getElementById('legend').textContent`);
  const dry = join(folder, 'dry'), rest = join(folder, 'rest');
  lamplock('engrave', input, '--order', 'given', '--dry', '--report', dry);
  const page = await browser.open(`file://${dry}/report.html`);
  check('a dry run says so', (await page.ask(`document.getElementById('warnings').textContent`)) === 'Dry run: nothing was fired');
  check('no point of it is fired', (await legend(page)).includes('dry run, not fired: 5'), await legend(page));
  await check_layout(page, 'a dry run');
  check_silence(page, 'a dry run');
  await keep_picture(page, 'dry');

  lamplock('engrave', input, '--order', 'given', '--pause-every', '2', '--pause-beats', '9', '--from', '3', '--report', rest);
  const other = await browser.open(`file://${rest}/report.html`);
  check('the rest of a job begins at a point', (await other.ask(`document.getElementById('subtitle').textContent`)).endsWith('continued at point 2 of 5'));
  check('the points before it are shown', (await legend(other)).includes('fired before this run: 2') && (await other.ask(`lamplock.cloud.view.count`)) === 5, await legend(other));
  check('the description leads to no point twice', (await other.ask(`document.querySelector('[data-making=description]').textContent`)).includes('--board virtual --from 3 repeats this part'));
  const covered = await other.ask(`(() => {
    const {view} = lamplock.cloud, canvas = view.canvas.getBoundingClientRect();
    view.draw();
    const labels = [...document.querySelectorAll('#dimensions span')].filter((label) => !label.hidden);
    const boxes = labels.map((label) => label.getBoundingClientRect());
    const points = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5], [0, 0]].map(([x, y]) => view.project(x, y, 0));
    return {texts: labels.map((label) => label.textContent), covers: points.some((p) => boxes.some((box) =>
      p.x + canvas.left > box.left && p.x + canvas.left < box.right && p.y + canvas.top > box.top && p.y + canvas.top < box.bottom))};
  })()`);
  check('labels of the sizes cover no point', !covered.covers && covered.texts.length === 2, covered);
  check_silence(other, 'the rest of a job');
  await keep_picture(other, 'rest');
}

async function large_job(browser) {
  const input = join(folder, 'many.xyz'), file = join(folder, 'many.html');
  writeFileSync(input, vase(many));
  lamplock('estimate', input, '--order', 'given', '--page', file);
  const size = readFileSync(file).length;
  check(`the page of ${many} points has ${(size / 1e6).toFixed(1)} MB`, size < many * bytes_per_point);
  const start = performance.now();
  const page = await browser.open(`file://${file}`);
  console.log(`        opened in ${((performance.now() - start) / 1000).toFixed(2)} s`);
  check('all points are there', (await page.ask(`lamplock.cloud.view.count`)) === many);
  check('they are drawn', (await drawn(page)).painted > 10000);
  check('an estimate does not know what will be missed', await page.ask(`document.querySelector('input[value=missed]').disabled`));
  const times = [];
  for (let i = 0; i < 5; ++i) times.push(await page.ask(`lamplock.cloud.view.time_of_frame()`));
  console.log(`        a picture of all points by the processor alone: ${Math.min(...times).toFixed(0)} ms`);
  await page.click('#turn');
  await page.frames(20);
  const pace = await page.ask(`({every: lamplock.cloud.view.every, pace: lamplock.cloud.view.pace})`);
  console.log(`        turning: one point in ${pace.every}, ${pace.pace?.toFixed(0)} ms a picture`);
  await page.click('#turn');
  check_silence(page, 'many points');
  await keep_picture(page, 'many');
}

async function without_webgl(url) {
  const browser = new Browser(chromium, { webgl: false });
  const page = await browser.open(url);
  const shown = await page.ask(`!document.getElementById('no-webgl').hidden`);
  check('without WebGL it reports that', shown);
  check('and the charts are shown', (await page.ask(`document.querySelectorAll('.chart svg').length`)) === 3);
  check('there are no complaints', page.complaints.length === 0, page.complaints);
  await keep_picture(page, 'no-webgl');
  await browser.close();
}

const browser = new Browser(chromium);
try {
  const url = await small_job(browser);
  await parts_of_jobs(browser);
  await large_job(browser);
  await without_webgl(url);
} catch (error) {
  check(`no exception: ${error.stack}`, false);
} finally {
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
}
console.log(failures === 0 ? 'all well' : `${failures} failed`);
process.exit(failures === 0 ? 0 : 1);
