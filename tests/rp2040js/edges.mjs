// Edges of pins of one image in both simulators, in cycles of clk_sys since a first one.

import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { ConsoleLogger, GPIOPinState, LogLevel, Simulator } from 'rp2040js';

import { install_rom } from './boot_rom.mjs';

const flash_base = 0x10000000;
const watchdog_base = 0x40058000;
const stack_top = 0x20041f00;  // where the ROM's stack is when it calls the second-stage boot
const pin_count = 30;

/** Edges {pin, ps} in the VCD text of `lamplock chip`; the levels at time 0 are no edges. */
export function vcd_edges(text) {
  const names = new Map();
  const edges = [];
  let ps = 0;
  for (const line of text.split('\n')) {
    const variable = line.match(/^\$var wire 1 (\S+) (\S+) \$end/);
    if (variable) names.set(variable[1], variable[2]);
    else if (line[0] === '#') ps = Number(line.slice(1));
    else if (/^[01]/.test(line) && ps > 0) edges.push({ pin: names.get(line.slice(1)), ps });
  }
  return edges;
}

/** Edges of `image` in `lamplock chip`, up to the time `until`. */
export function edges_in_lamplock(program, image, until) {
  const folder = mkdtempSync(join(tmpdir(), 'edges-'));
  try {
    const file = join(folder, 'image.bin');
    const vcd = join(folder, 'trace.vcd');
    writeFileSync(file, image);
    execFileSync(program, ['chip', file, '--until', until, '--vcd', vcd], { stdio: 'pipe' });
    return vcd_edges(readFileSync(vcd, 'latin1'));
  } finally {
    rmSync(folder, { recursive: true });
  }
}

/** A PIO that steps when it is told to, not by timers of the host. */
function stop_free_run(pio) {
  pio.run = () => {};
}

/** One clock of a PIO; its own step() runs machines that are not enabled as well. */
function step_enabled(pio) {
  if (pio.stopped) return;
  for (const machine of pio.machines) if (machine.enabled) machine.step();
  pio.checkChangedPins();
}

/** The input of a pin is what is on its pad, whoever drives it (RP2040 datasheet, 2.19.1). */
function see_own_output(pin) {
  pin.addListener((state) => {
    if (state === GPIOPinState.High || state === GPIOPinState.Low)
      pin.setInputValue(state === GPIOPinState.High);
  });
}

/** Pads after reset have their inputs on (RP2040 datasheet, 2.19.6.3: 0x56); those of rp2040js do not. */
export function enable_inputs(rp2040) {
  for (const pin of rp2040.gpio) {
    if (pin.inputEnable) throw new Error('inputs are on after reset: rp2040js needs no help any more');
    pin.padValue = 0x56;
  }
}

/**
 * Runs `image` in rp2040js for `ms` of its time; `prepare(rp2040, clock)` may listen, and may return
 * what says whether the run is over. `clocked`: its PIO is stepped once a cycle of the CPU, enabled machines only, and sees pins that the chip drives,
 * none of which rp2040js does by itself.
 */
export function run_in_rp2040js(image, ms, clocked, prepare) {
  const { rp2040, clock } = new Simulator();
  rp2040.logger = new ConsoleLogger(LogLevel.Error);
  install_rom(rp2040, () => { throw new Error('the image enters the boot loader'); });
  rp2040.findPeripheral(watchdog_base).onWatchdogTrigger = () => { throw new Error('the watchdog restarts the chip'); };
  rp2040.flash.set(image);
  rp2040.core.SP = stack_top;
  rp2040.core.PC = flash_base;
  if (clocked) {
    rp2040.pio.forEach(stop_free_run);
    rp2040.gpio.forEach(see_own_output);
  }
  const is_over = prepare(rp2040, clock) ?? (() => false);
  while (clock.nanos < ms * 1e6 && !is_over()) {
    const cycle_ns = 1e9 / rp2040.clkSys;
    const { waiting } = rp2040.core;
    if (waiting && !clocked) {
      if (clock.nextAlarm === null) break;  // nothing will ever wake it
      clock.tick(clock.nanosToNextAlarm);
      continue;
    }
    const cycles = waiting ? 1 : rp2040.core.executeInstruction();
    if (!clocked) {
      clock.tick(cycles * cycle_ns);
      continue;
    }
    for (let i = 0; i < cycles; ++i) {
      clock.tick(cycle_ns);
      for (const pio of rp2040.pio) step_enabled(pio);
    }
  }
  rp2040.pio.forEach((pio) => pio.stop());
}

/** Edges of `image` in rp2040js, in `ms` of its time. */
export function edges_in_rp2040js(image, ms, clocked) {
  const edges = [];
  run_in_rp2040js(image, ms, clocked, (rp2040, clock) => {
    for (let n = 0; n < pin_count; ++n) {
      let level;
      rp2040.gpio[n].addListener((state) => {
        const now = state === GPIOPinState.High || state === GPIOPinState.InputPullUp;
        if (level !== undefined && now !== level) edges.push({ pin: `gpio${n}`, ps: clock.nanos * 1000 });
        level = now;
      });
    }
  });
  return edges;
}

/** For each pin of `pins` its cycles since the first edge of `origin`, as many as are asked for. */
export function cycles_of(edges, origin, pins, hz) {
  const first = edges.find((edge) => edge.pin === origin);
  const result = {};
  for (const [pin, count] of Object.entries(pins))
    result[pin] = first === undefined ? [] : edges
      .filter((edge) => edge.pin === pin && edge.ps >= first.ps)
      .slice(0, count)
      .map((edge) => Math.round((edge.ps - first.ps) * hz / 1e12 * 100) / 100);
  return result;
}
