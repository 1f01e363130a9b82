// One run of a flash image in rp2040js, with a host at its USB.
//
// rp2040js 1.4.1 does not clock the PIO (no tick, no edge, no lamp): boot, enumeration, text and
// settings only. Differences from the datasheet that affect the image are patched here.

import { ConsoleLogger, LogLevel, Simulator, USBCDC } from 'rp2040js';

import { enter_boot2, install_rom } from './boot_rom.mjs';

const cycle_ns = 8;  // 125 MHz

/** CHAN_ABORT reads 0 once the channels have stopped (datasheet, 2.5.5.3); rp2040js has no read. */
function patch_dma_abort(mcu) {
  const chan_abort = 0x444;
  const read = mcu.dma.readUint32.bind(mcu.dma);
  mcu.dma.readUint32 = (offset) => (offset === chan_abort ? 0 : read(offset));
}

/**
 * An interrupt that software pends is no longer pending once it is taken, unless its line is high
 * (ARMv6-M Architecture Reference Manual, B3.4.1); rp2040js leaves it pending forever.
 */
function patch_pending(core) {
  let lines = 0;
  const set = core.setInterrupt.bind(core);
  core.setInterrupt = (irq, high) => {
    lines = high ? lines | 1 << irq : lines & ~(1 << irq);
    set(irq, high);
  };
  const enter = core.exceptionEntry.bind(core);
  core.exceptionEntry = (number) => {
    const bit = number < 16 ? 0 : 1 << (number - 16);
    if ((lines & bit) === 0) core.pendingInterrupts &= ~bit;
    enter(number);
  };
}

/** A powered Pico with `flash` as its contents and a host at its USB. */
export class Machine {
  #simulator = new Simulator();
  #mcu = this.#simulator.rp2040;
  #usb;
  #text = '';
  connected = false;
  in_boot_loader = false;

  constructor(flash) {
    this.#mcu.logger = new ConsoleLogger(LogLevel.Error);  // throws
    install_rom(this.#mcu, () => { this.in_boot_loader = true; });
    this.#mcu.flash.set(flash);
    patch_dma_abort(this.#mcu);
    patch_pending(this.#mcu.core);
    const watchdog = this.#mcu.findPeripheral(0x40058000);
    watchdog.onWatchdogTrigger = () => { throw new Error('the watchdog restarts the chip'); };
    this.#usb = new USBCDC(this.#mcu.usbCtrl);
    this.#usb.onDeviceConnected = () => { this.connected = true; };
    this.#usb.onSerialData = (bytes) => { this.#text += Buffer.from(bytes).toString('latin1'); };
    enter_boot2(this.#mcu.core);
  }

  get flash() { return this.#mcu.flash; }
  get text() { return this.#text; }
  get ms() { return this.#simulator.clock.nanos / 1e6; }

  send(text) {
    for (const letter of text) this.#usb.sendSerialByte(letter.charCodeAt(0));
  }

  /** Runs until `done()`, for `limit_ms` of simulated time at most; true if done. */
  run_until(limit_ms, done) {
    const { clock } = this.#simulator;
    const { core } = this.#mcu;
    const end = clock.nanos + limit_ms * 1e6;
    while (clock.nanos < end && !this.in_boot_loader) {
      for (let i = 0; i < 1000 && !this.in_boot_loader; ++i) {
        if (core.waiting)
          clock.tick(clock.nanosToNextAlarm);
        else
          clock.tick(core.executeInstruction() * cycle_ns);
      }
      if (done()) return true;
    }
    return done();
  }

  /** Sends `line`; true once `pattern` has arrived. */
  ask(line, pattern, limit_ms = 200) {
    this.#text = '';
    this.send(`${line}\n`);
    const end = this.ms + limit_ms;
    while (this.ms < end) {
      if (this.run_until(20, () => pattern.test(this.#text))) return true;
      if (this.in_boot_loader) return false;
      // rp2040js moves the second of two buffers only together with the first: request more.
      this.send('?');
    }
    return false;
  }
}
