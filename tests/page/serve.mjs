// The page of `lamplock serve` in a real browser, with a virtual board: connect, send, check, run,
// hold, resume, stop, settings, console, jog by mouse, key and touch, and pages that die while they jog.
//
// usage: node serve.mjs LAMPLOCK [FOLDER_FOR_PICTURES]
// exit status: 0 passed; 1 failed; 77 no Chromium (toolchain/setup test, or the variable CHROMIUM)

import { spawnSync } from 'node:child_process';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';

import { Browser } from './browser.mjs';
import { call, check, chromium, drop, end, folder, keep_picture, open, program, sleep, start_server, text_of, until } from './serve_tools.mjs';

// Limits of times hold on a computer with time for the test; the test prints what it measures.
const busy_ms = 150;

let server;

const key = (page, type, code) => page.send('Input.dispatchKeyEvent', { type, code, key: code });
const place = async (server) => (await call(server, 'status')).board.machine;

// Moves while `begin` holds, and rests after `end`; prints how long after `end` it moved.
async function jog(server, what, begin, end) {
  const from = (await place(server))[0];
  await begin();
  await sleep(500);
  const held = (await place(server))[0];
  check(`${what}: moves while held`, Math.abs(held - from) > 0.5, { from, held });
  await end();
  const released = Date.now();
  let last = NaN, moved = released;
  while (Date.now() < released + 900) {
    const now = (await place(server))[0];
    if (now !== last) moved = Date.now();
    last = now;
    await sleep(3);
  }
  console.log(`        at rest ${moved - released} ms after the end`);
  // 1000 mm/min at 4 m/s2: 4 ms to brake.
  check(`${what}: at rest within 250 ms`, moved - released <= 254 + busy_ms, moved - released);
}

const zigzag = ['G21G90', 'M3S500'];
for (let i = 0; i < 40; ++i) zigzag.push(`G1X${i % 2 ? -30 : 30}Y${i - 20}F3000`);

async function run_job(page, server) {
  await drop(page, 'zigzag.ngc', `${zigzag.join('\n')}\nM5\n`);
  await until('the file is checked', async () => /lines; .* mm/.test(await text_of(page, 'checked')));
  check('the picture is shown', await page.ask(`document.getElementById('picture').naturalWidth > 0`));
  await page.click('#start');
  await until('the job runs', async () => /zigzag.*of/.test(await text_of(page, 'job-text')));
  await sleep(800);
  await page.ask('scrollTo(0, 0)');
  await page.frames(2);
  await keep_picture(page, 'serve');
  await page.click('#hold');
  await until('hold', async () => /held/.test(await text_of(page, 'job-text')));
  await page.click('#resume');
  await until('resume', async () => !/held/.test(await text_of(page, 'job-text')));
  await page.click('[data-feed=more]');
  await until('faster', async () => /110 %/.test(await text_of(page, 'job-text')));
  await page.click('#stop');
  await until('stop', async () => /stopped/.test(await text_of(page, 'job-text')));
  await until('idle after a stop', async () => (await call(server, 'status')).board.state === 'Idle');
}

async function change_settings(page) {
  await page.click('#read');
  await until('settings are read', () => page.ask(`document.querySelectorAll('#settings tr').length > 50`));
  await page.ask(`(() => {
    const input = document.getElementById('acceleration_x');
    input.value = 1500;
    input.dispatchEvent(new Event('input', { bubbles: true }));
  })()`);
  check('changes are listed', /acceleration_x: \d+ to 1500/.test(await text_of(page, 'changes')), await text_of(page, 'changes'));
  await page.click('#write');
  await until('settings are written', () => page.ask(`document.getElementById('acceleration_x').defaultValue === '1500'`));
}

async function use_console(page) {
  await page.ask(`(() => { document.getElementById('line').value = '$I'; document.getElementById('console').requestSubmit(); })()`);
  await until('the console shows an answer', async () => /VER:/.test(await text_of(page, 'lines')));
}

async function jogs(page, server) {
  const { x, y } = await page.place('[data-jog="1,0"]');
  const press = () => page.mouse('mousePressed', x, y, { button: 'left', buttons: 1, clickCount: 1 });
  const release = () => page.mouse('mouseReleased', x, y, { button: 'left', clickCount: 1 });
  await jog(server, 'mouse', press, release);
  await page.click('#keys');
  await jog(server, 'key', () => key(page, 'keyDown', 'ArrowLeft'), () => key(page, 'keyUp', 'ArrowLeft'));
  const touch = (type, points) => page.send('Input.dispatchTouchEvent', { type, touchPoints: points });
  await jog(server, 'touch', () => touch('touchStart', [{ x, y }]), () => touch('touchEnd', []));
  await jog(server, 'touch cancelled', () => touch('touchStart', [{ x, y }]), () => touch('touchCancel', []));
  await jog(server, 'focus lost', press, () => page.ask(`dispatchEvent(new Event('blur'))`));
  await release();
}

// A page without the token logs in with the password.
async function log_in(browser) {
  const file = join(folder, 'password'), password = 'a good password';
  check('a password is set', spawnSync(program, ['serve', '--set-password', file], { input: `${password}\n` }).status === 0);
  const other = await start_server('--password', file);
  const enter = (page, text) => page.ask(`(() => {
    document.getElementById('password').value = ${JSON.stringify(text)};
    document.getElementById('login').requestSubmit();
  })()`);
  try {
    const page = await browser.open(`${other.origin}/`);
    await until('the page asks for the password', () => page.ask(`!document.getElementById('login').hidden`));
    await enter(page, 'wrong password');
    await until('a wrong password is refused', async () => /is wrong/.test(await text_of(page, 'problem')));
    await enter(page, password);
    await until('the page shows the state after a login', async () => (await text_of(page, 'state')) === 'Idle');
    check('the password is asked for no longer', await page.ask(`document.getElementById('login').hidden`));
  }
end(server);
