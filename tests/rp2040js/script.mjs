// Reads a script for the chip (docs/chip-script.md); supports the subset used by the small images.

const ps_of = { ps: 1, ns: 1e3, us: 1e6, ms: 1e9, s: 1e12 };
const hz_of = { Hz: 1, kHz: 1e3, MHz: 1e6 };

/** A length of time, in picoseconds or in cycles of clk_sys. */
function span(word) {
  const [, amount, unit] = word.match(/^([\d.]+)(cycles|ps|ns|us|ms|s)$/) ?? [];
  if (unit === undefined) throw new Error(`no length of time: ${word}`);
  if (unit === 'cycles') return { amount: Number(amount), cycles: true };
  return { amount: Math.round(Number(amount) * ps_of[unit]), cycles: false };
}

function pin(word) {
  const [, number] = word.match(/^gpio(\d+)$/) ?? [];
  if (number === undefined) throw new Error(`no pin: ${word}`);
  return Number(number);
}

/** 0 and 1 are UARTs, 2 is USB. */
const port = (word) => (word === 'usb' ? 2 : Number(word.match(/^uart([01])$/)?.[1]));

/** "a..b", or "b" from `nothing` on. */
function range(word, read, nothing) {
  const [least, most] = word.includes('..') ? word.split('..') : [undefined, word];
  return { least: least === undefined ? nothing : read(least), most: read(most) };
}

const is_edge = (word) => ['rise', 'fall', 'edge'].includes(word);
const is_level = (word) => ['high', 'low', '1', '0'].includes(word);
const level = (word) => word === 'high' || word === '1';

/** Words of a line; a quoted string is one word, comments are dropped. */
const words_of = (line) => line.match(/"(?:\\.|[^"\\])*"|#.*|\S+/g)?.filter((word) => word[0] !== '#') ?? [];

function text(word) {
  const escapes = { r: '\r', n: '\n', t: '\t' };
  return word.slice(1, -1).replace(/\\(x..|.)/g, (_, code) =>
    code.length === 3 ? String.fromCharCode(parseInt(code.slice(1), 16)) : escapes[code] ?? code);
}

function reaction(words) {
  const [gpio, edge, , window, , cause, cause_edge, times, count] = words;
  if (times !== undefined && times !== 'times') throw new Error(`no "times": ${times}`);
  return { kind: 'reaction', gpio: pin(gpio), edge, ...range(window, span, { amount: 0, cycles: false }),
           cause: pin(cause), cause_edge, times: Number(count ?? 1) };
}

function expectation(words) {
  const [what, second, third, fourth, fifth, sixth] = words;
  if (what === 'usb' && second === 'within') return { kind: 'usb', limit: span(third) };
  if (!Number.isNaN(port(what))) return { kind: 'text', port: port(what), text: text(second), limit: span(fourth) };
  const gpio = pin(what);
  if (is_edge(second) && fifth === 'of') return reaction(words);
  if (is_edge(second)) return { kind: 'edge', gpio, edge: second, limit: span(fourth) };
  if (['edges', 'rises', 'falls'].includes(second))
    return { kind: 'count', gpio, edge: second.slice(0, -1), ...range(third, Number, Number(third)), window: span(fifth) };
  if (second === 'never') return { kind: 'never', gpio, level: level(third), window: span(fifth) };
  if (second === 'frequency') {
    const [, number, unit] = third.match(/^([\d.]+)(\D+)$/);
    const share = parseFloat(fourth.slice(2)) / 100;
    return { kind: 'frequency', gpio, hz: number * hz_of[unit], share, window: span(sixth) };
  }
  if (is_level(second)) return { kind: 'level', gpio, level: level(second) };
  throw new Error(`no expectation: ${words.join(' ')}`);
}

function pulse([gpio, ...rest]) {
  const high = rest[0] !== 'low';
  const [width, , period, , times] = high ? rest : rest.slice(1);
  return { kind: 'pulse', gpio: pin(gpio), level: high, width: span(width),
           period: span(period ?? '0ps'), times: period === undefined ? 1 : Number(times ?? Infinity) };
}

/** Voltage of an input of the ADC; of the temperature sensor as in the RP2040 datasheet, 4.9.5. */
function converter([what, value]) {
  if (what === 'temperature') return { kind: 'volts', input: 4, volts: 0.706 - (parseFloat(value) - 27) * 0.001721 };
  return { kind: 'volts', input: pin(what) - 26, volts: parseFloat(value) };
}

function statement(words) {
  const [first, ...rest] = words;
  switch (first) {
    case 'at':
    case 'after':
      return [{ kind: first, span: span(rest[0]) }, ...(rest.length > 1 ? statement(rest.slice(1)) : [])];
    case 'set':
      if (/[VC]$/.test(rest[1])) return [converter(rest)];
      return [{ kind: 'set', gpio: pin(rest[0]), level: level(rest[1]) }];
    case 'release':
      return [{ kind: 'release', gpio: pin(rest[0]) }];
    case 'join':
      return [{ kind: 'join', gpio: pin(rest[0]), other: pin(rest[1]) }];
    case 'pulse':
      return [pulse(rest)];
    case 'allow':  // affects only the exit status of lamplock chip
      return [];
    case 'end':
      return [{ kind: 'end' }];
    case 'wait':
    case 'expect':
      return [{ ...expectation(rest), says: words.join(' ') }];
    case 'meanwhile':
      return statement(rest).map((step) => ({ ...step, meanwhile: true }));
    default:
      if (rest[0] !== 'send') throw new Error(`no statement: ${words.join(' ')}`);
      return [{ kind: 'send', port: port(first), text: text(rest[1]) }];
  }
}

/** Steps of a script in order; `says` is an expectation as written. */
export function read_script(source) {
  const lines = source.split('\n').map(words_of).filter((words) => words.length > 0);
  return lines.flatMap(statement);
}
