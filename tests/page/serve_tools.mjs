// What the tests of the page of `lamplock serve` share: the server, its methods, checks, waits.
//
// In:  the arguments of the test: LAMPLOCK [FOLDER_FOR_PICTURES]. Out: functions; the test ends by end().
// Who: serve.mjs, serve_cloud.mjs, serve_place.mjs. Exit status: 0 passed; 1 failed; 2 usage; 77 no Chromium.

import { spawn, spawnSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';

const not_there = 77;
export const [program, pictures] = process.argv.slice(2);
if (program === undefined) {
  console.log(`usage: node ${basename(process.argv[1])} LAMPLOCK [FOLDER_FOR_PICTURES]`);
  process.exit(2);
}
export const chromium = process.env.CHROMIUM ?? 'chromium';
if (spawnSync(chromium, ['--version']).status !== 0) {
  console.log(`${chromium} is not installed; run toolchain/setup`);
  process.exit(not_there);
}
export const folder = mkdtempSync(join(tmpdir(), 'lamplock-serve-'));
export const jobs = join(folder, 'jobs');
export const sleep = (ms) => new Promise((done) => setTimeout(done, ms));

let failures = 0;
export function check(what, holds, more = '') {
  console.log(`${holds ? 'ok    ' : 'FAILED'}  ${what}`);
  if (holds) return;
  ++failures;
  if (more !== '') console.log(`        ${JSON.stringify(more)}`);
}

export async function keep_picture(page, name, whole = true) {
  if (pictures === undefined) return;
  mkdirSync(pictures, { recursive: true });
  writeFileSync(join(pictures, `${name}.png`), await page.picture(whole));
}

// The server; its address is in its first line.
export function start_server(...options) {
  const child = spawn(program, ['serve', '--board', 'virtual', '--port', '0', '--folder', jobs,
                               '--library', join(folder, 'library.db'), ...options],
                      { stdio: ['ignore', 'pipe', 'inherit'] });
  return new Promise((resolve, reject) => {
    child.on('exit', (code) => reject(new Error(`serve has ended (${code})`)));
    child.stdout.setEncoding('utf8');
    child.stdout.on('data', (text) => {
      const address = /page: (\S+)/.exec(text)?.[1];
      if (address) resolve({ child, address, origin: new URL(address).origin, token: address.split('token=')[1] });
    });
  });
}

let calls = 0;
export async function call(server, method, params = {}) {
  const reply = await fetch(`${server.origin}/api`, {
    method: 'POST', headers: { Authorization: `Bearer ${server.token}`, 'Content-Type': 'application/json' },
    body: JSON.stringify({ jsonrpc: '2.0', id: ++calls, method, params }),
  });
  return (await reply.json()).result;
}

export async function comes_true(holds, ms = 8000) {
  const end = Date.now() + ms;
  let value = false;
  while (Date.now() < end && !(value = await holds())) await sleep(20);
  return Boolean(value);
}

export const until = async (what, holds, ms) => check(what, await comes_true(holds, ms));

export const text_of = (page, id) => page.ask(`document.getElementById('${id}')?.textContent ?? ''`);

export async function open(browser, server, options) {
  const page = await browser.open(server.address, options);
  await until('the page shows the state', async () => /Idle/.test(await text_of(page, 'state')));
  return page;
}

export async function drop(page, name, text) {
  await page.ask(`(() => {
    const files = new DataTransfer();
    files.items.add(new File([${JSON.stringify(text)}], ${JSON.stringify(name)}));
    document.getElementById('drop').dispatchEvent(new DragEvent('drop', { dataTransfer: files, bubbles: true }));
  })()`);
}

// Ends the test; the server has ended, or is killed.
export function end(server) {
  server?.child.kill('SIGKILL');
  rmSync(folder, { recursive: true, force: true });
  console.log(failures === 0 ? 'passed' : `${failures} failed`);
  process.exit(failures === 0 ? 0 : 1);
}
