// An independent check: the flashed image in a simulator by other authors.
//
// usage: node second_opinion.mjs lamplock-rp2040.uf2
// exit status: 0 it boots, enumerates, answers $I, keeps a setting over a restart and enters the
// boot loader on request; 1 failed; 77 rp2040js is not installed (toolchain/setup test)

import { readFileSync } from 'node:fs';

import { read_uf2 } from './uf2.mjs';

const not_there = 77;
const { Machine } = await import('./machine.mjs').catch((error) => {
  if (error.code !== 'ERR_MODULE_NOT_FOUND') throw error;
  console.log('rp2040js is not installed; run toolchain/setup');
  process.exit(not_there);
});

const boot_ms = 500;

// Each warning once: rp2040js has no FIFO between the cores, which the image polls for 2 ms.
const complaints = new Set();
const complain = console.warn;
console.warn = (what) => {
  if (!complaints.has(what)) complain(what);
  complaints.add(what);
};

function check(what, holds, machine) {
  console.log(`${holds ? 'ok    ' : 'FAILED'}  ${what}`);
  if (holds) return;
  if (machine) console.log(`at ${machine.ms} ms, received: ${JSON.stringify(machine.text)}`);
  process.exit(1);
}

function start(flash) {
  const machine = new Machine(flash);
  machine.run_until(boot_ms, () => machine.connected);
  check(`enumerated as a serial port after ${machine.ms.toFixed(1)} ms`, machine.connected, machine);
  return machine;
}

const file = process.argv[2];
if (file === undefined) {
  console.log('usage: node second_opinion.mjs lamplock-rp2040.uf2');
  process.exit(2);
}
const first = start(read_uf2(readFileSync(file)));
check('$I answers with version, options and ok',
      first.ask('$I', /\[VER:1\.1h[^\]]*lamplock\][^]*\[OPT:[^\]]*\]\r\n\[BOARD:pico\]\r\nok\r\n/), first);
console.log(`        ${first.text.match(/\[VER:[^\]]*\]/)[0]}`);
check('it reports that there is only one core', /Core 1 does not answer/.test(first.text), first);
check('? answers with a status', first.ask('?', /<(Idle|Alarm)[^>]*>/), first);
check('$110=1234 is taken', first.ask('$110=1234', /ok\r\n/), first);
first.run_until(50, () => false);

const second = start(first.flash);
check('... and is there after a restart', second.ask('$$', /\$110=1234/), second);
second.ask('$BOOT', /(?!)/);
check('$BOOT enters the boot loader of the ROM', second.in_boot_loader, second);
process.exit(0);  // rp2040js runs its PIO by timers of the host, which never end
