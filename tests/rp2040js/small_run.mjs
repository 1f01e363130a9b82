// One run of a small image in rp2040js, as it is or with the corrections that it needs.

import { ConsoleLogger, GPIOPinState, LogLevel, Simulator } from 'rp2040js';

import { enter_boot2, install_rom } from './boot_rom.mjs';

const watchdog_base = 0x40058000;

/** Makes a PIO step only on request, not by timers of the host. */
function stop_free_run(pio) {
  pio.run = () => {};
}

/** One clock of a PIO for enabled machines only; its own step() also runs disabled ones. */
function step_enabled(pio) {
  if (pio.stopped) return;
  for (const machine of pio.machines) if (machine.enabled) machine.step();
  pio.checkChangedPins();
}

/** The input of a pin is the level of its pad for any driver (RP2040 datasheet, 2.19.1). */
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
 * Runs `image`, the bytes of the flash, for `ms` of its time; `prepare(rp2040, clock)` may add
 * listeners and may return a function that ends the run. `clocked`: the PIO is stepped once a cycle
 * of the CPU, enabled machines only, and sees pins that the chip drives; rp2040js does not.
 */
export function run_in_rp2040js(image, ms, clocked, prepare) {
  const { rp2040, clock } = new Simulator();
  rp2040.logger = new ConsoleLogger(LogLevel.Error);
  install_rom(rp2040, () => { throw new Error('the image enters the boot loader'); });
  rp2040.findPeripheral(watchdog_base).onWatchdogTrigger = () => { throw new Error('the watchdog restarts the chip'); };
  rp2040.flash.set(image);
  enter_boot2(rp2040.core);
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
