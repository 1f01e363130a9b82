// The inputs and outputs of a chip in rp2040js as a script uses them: edges of pins and bytes of
// UARTs and USB with their times, levels of externally driven pins.

import { GPIOPinState, USBCDC } from 'rp2040js';

const pin_count = 30;
const usb_port = 2;
const bits_of_a_byte = 10;  // 8 bits, start and stop
const reference_volts = 3.3;  // full scale of the ADC, as in `lamplock chip`
const codes = 4096;

/** Records the outputs of `rp2040`; moments are { ps, cycle } with cycles of clk_sys. */
export class Scene {
  #rp2040;
  #clock;
  #since = { ps: 0, cycle: 0 };  // start of the present clk_sys
  #hz;
  #driven = new Array(pin_count).fill(false);
  edges = Array.from({ length: pin_count }, () => []);
  #usb;
  bytes = [[], [], []];
  usb_found = false;

  constructor(rp2040, clock) {
    this.#rp2040 = rp2040;
    this.#clock = clock;
    this.#hz = rp2040.clkSys;
    rp2040.addClockListener((hz) => {
      this.#since = this.now();
      this.#hz = hz;
    });
    rp2040.gpio.forEach((pin, gpio) => pin.addListener((state) => this.#levelled(gpio, state)));
    const hear = (port, byte) => this.bytes[port].push({ at: this.now(), letter: String.fromCharCode(byte) });
    rp2040.uart.forEach((uart, port) => {
      uart.onByte = (byte) => hear(port, byte);
    });
    this.#usb = new USBCDC(rp2040.usbCtrl);
    this.#usb.onDeviceConnected = () => { this.usb_found = true; };
    this.#usb.onSerialData = (bytes) => bytes.forEach((byte) => hear(usb_port, byte));
  }

  now() {
    const ps = Math.round(this.#clock.nanos * 1000);
    return { ps, cycle: this.#since.cycle + (ps - this.#since.ps) * this.#hz / 1e12 };
  }

  after({ ps, cycle }, { amount, cycles }) {
    const cycle_ps = 1e12 / this.#hz;
    return cycles ? { ps: ps + amount * cycle_ps, cycle: cycle + amount }
                  : { ps: ps + amount, cycle: cycle + amount / cycle_ps };
  }

  #levelled(gpio, state) {
    if (state === GPIOPinState.High || state === GPIOPinState.Low) this.#level(gpio, state === GPIOPinState.High);
    else this.#level(gpio, this.#driven[gpio] || state === GPIOPinState.InputPullUp);
  }

  #level(gpio, level) {
    const edges = this.edges[gpio];
    if (level !== (edges.at(-1)?.level ?? false)) edges.push({ at: this.now(), level });
  }

  /** Drives a pin externally. */
  drive(gpio, level) {
    const pin = this.#rp2040.gpio[gpio];
    this.#driven[gpio] = level;
    pin.setInputValue(level);
    if (!pin.outputEnable) this.#level(gpio, level);
  }

  /** Leaves the pin to its pulls and to the chip. */
  release(gpio) {
    const pin = this.#rp2040.gpio[gpio];
    this.drive(gpio, pin.value === GPIOPinState.High || pin.value === GPIOPinState.InputPullUp);
    this.#driven[gpio] = false;
  }

  /** A wire between two pins: low if either drives it low, else high. */
  join(one, other) {
    const pins = [one, other].map((gpio) => this.#rp2040.gpio[gpio]);
    const settle = () => {
      const low = pins.some((pin) => pin.value === GPIOPinState.Low);
      pins.forEach((pin) => pin.setInputValue(!low));
    };
    pins.forEach((pin) => pin.addListener(settle));
    settle();
  }

  /** Calls `call` at the given moment. */
  at(moment, call) {
    this.#clock.createAlarm(call).schedule(Math.max(0, moment.ps / 1000 - this.#clock.nanos));
  }

  /** Sets the voltage of an ADC input: 0 to 3 are pins, 4 is the temperature sensor. */
  set_volts(input, volts) {
    const code = Math.floor(volts / reference_volts * codes);
    this.#rp2040.adc.channelValues[input] = Math.max(0, Math.min(codes - 1, code));
  }

  /** Sends the bytes one after the other at the rate of the image, or all at once by USB. */
  send(port, text) {
    if (port === usb_port) {
      for (const letter of text) this.#usb.sendSerialByte(letter.charCodeAt(0));
      return;
    }
    const uart = this.#rp2040.uart[port];
    const byte_ps = bits_of_a_byte * 1e12 / uart.baudRate;
    let moment = this.now();
    for (const letter of text) {
      moment = this.after(moment, { amount: byte_ps, cycles: false });
      this.at(moment, () => uart.feedByte(letter.charCodeAt(0)));
    }
  }

  /** Level of the pin after its edges up to and including `ps`. */
  level(gpio, ps) {
    return this.edges[gpio].findLast((edge) => edge.at.ps <= ps)?.level ?? false;
  }
}
