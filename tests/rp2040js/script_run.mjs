// Runs a script (docs/chip-script.md) beside rp2040js. Unlike `lamplock chip` it continues after an
// expectation that is not met, at the end of what it saw instead, so that one difference does not
// hide the others.

const look_ps = 1e6;       // the script sees an edge up to 1 us late
const cause_ps = 200e6;    // time-out for an edge that must cause a reaction
const late_ps = 10e9;      // extra wait for a late text, so that later steps stay in sync
const shown = 40;          // maximum number of characters shown of a port's output
const tiny = 1e-3;         // ps, cycles: rounding

const units = [['s', 1e12], ['ms', 1e9], ['us', 1e6], ['ns', 1e3]];

/** In the unit of the expectation's window: cycles, or the unit in which it is above 1. */
function length(from, to, cycles) {
  if (cycles) return `${Number((to.cycle - from.cycle).toFixed(2))} cycles`;
  const ps = to.ps - from.ps;
  const [unit, size] = units.find(([, each]) => ps >= each) ?? ['ps', 1];
  return `${Number((ps / size).toFixed(3))} ${unit}`;
}

const excess = (from, to, span) =>
  (span.cycles ? to.cycle - from.cycle : to.ps - from.ps) - span.amount;
const is_kind = (edge, kind) => kind === 'edge' || edge.level === (kind === 'rise');

/** One run of `script` at a Scene; `results` has { says, met, seen } of each expectation. */
export class ScriptRun {
  #scene;
  #script;
  #time;
  #beside = [];
  #trains = new Map();  // by pin: the external driver
  #used = [0, 0, 0];    // consumed bytes of each port
  #main;
  results = [];
  done = false;

  constructor(scene, script) {
    this.#scene = scene;
    this.#script = script;
    this.#time = scene.now();
    this.#main = this.#steps();
    this.#look();
  }

  #look() {
    this.#beside = this.#beside.filter((check) => !check.next().done);
    const { value, done } = this.#main.next();
    this.done = done;
    if (done) return;
    const now = this.#scene.now();
    const ps = Math.min(value?.ps ?? Infinity, now.ps + look_ps);
    this.#scene.at({ ps }, () => this.#look());
  }

  *#steps() {
    for (const step of this.#script) {
      if (step.kind === 'end') break;
      if (step.says === undefined) {
        yield* this.#act(step);
        continue;
      }
      const result = { says: step.says };
      this.results.push(result);
      if (step.meanwhile) this.#beside.push(this.#check(step, result));
      else this.#time = yield* this.#check(step, result);
    }
    while (this.#beside.length > 0) yield;
  }

  *#act(step) {
    const scene = this.#scene;
    if (step.kind === 'after' || step.kind === 'at') {
      const past = step.kind === 'at' ? this.#time.ps : 0;
      const span = { ...step.span, amount: step.span.amount - past };
      if (span.amount < 0) throw new Error('a time that has passed already');
      this.#time = scene.after(this.#time, span);
      yield* this.#until(this.#time);
      return;
    }
    const now = scene.now();
    if (now.ps > this.#time.ps) this.#time = now;
    if (step.kind === 'send') {
      scene.send(step.port, step.text);
    } else if (step.kind === 'join') {
      scene.join(step.gpio, step.other);
    } else if (step.kind === 'volts') {
      scene.set_volts(step.input, step.volts);
    } else {
      const train = {};
      this.#trains.set(step.gpio, train);
      if (step.kind === 'set') scene.drive(step.gpio, step.level);
      else if (step.kind === 'release') scene.release(step.gpio);
      else this.#pulse(step, train, this.#time, step.times);
    }
  }

  #pulse(step, train, begin, left) {
    const scene = this.#scene;
    const mine = () => this.#trains.get(step.gpio) === train;
    if (left === 0 || !mine()) return;
    scene.drive(step.gpio, step.level);
    scene.at(scene.after(begin, step.width), () => mine() && scene.drive(step.gpio, !step.level));
    const next = scene.after(begin, step.period);
    if (left > 1) scene.at(next, () => this.#pulse(step, train, next, left - 1));
  }

  *#until({ ps }) {
    while (this.#scene.now().ps < ps - tiny) yield { ps };
  }

  /** Fills `result`; returns the script's time after it. */
  *#check(step, result) {
    const start = this.#time;
    const { at, seen } = yield* this[`_${step.kind}`](step, start);
    result.met = seen === undefined;
    if (!result.met) result.seen = seen;
    return at;
  }

  /** The first edge after `from` for which `fits`, searched up to `end`. */
  *#edge(gpio, kind, from, end) {
    const edges = this.#scene.edges[gpio];
    let next = edges.findLastIndex((edge) => edge.at.ps <= from.ps + tiny) + 1;
    for (;;) {
      for (; next < edges.length; ++next) {
        if (edges[next].at.ps > end.ps + tiny) return undefined;
        if (is_kind(edges[next], kind)) return edges[next].at;
      }
      if (this.#scene.now().ps > end.ps) return undefined;
      yield;
    }
  }

  *_edge({ gpio, edge, limit }, start) {
    const end = this.#scene.after(start, limit);
    const at = yield* this.#edge(gpio, edge, start, end);
    return at ? { at } : { at: end, seen: 'none' };
  }

  /** Waits until the host has found a serial port. */
  *_usb({ limit }, start) {
    const end = this.#scene.after(start, limit);
    while (!this.#scene.usb_found && this.#scene.now().ps < end.ps) yield;
    const now = this.#scene.now();
    return this.#scene.usb_found ? { at: now.ps > start.ps ? now : start } : { at: end, seen: 'none' };
  }

  *_reaction(step, start) {
    const { gpio, edge, least, most, cause, cause_edge, times } = step;
    let from = this.#scene.edges[cause].findLast((each) => each.at.ps <= start.ps + tiny && is_kind(each, cause_edge))?.at;
    let first;  // first unexpected result
    for (let n = 1; ; ++n) {
      if (from === undefined || n > 1) {
        const after = from ?? start;
        const end = this.#scene.after(after, { amount: cause_ps, cycles: false });
        from = yield* this.#edge(cause, cause_edge, after, end);
        if (from === undefined) return { at: after, seen: first ?? `no gpio${cause} ${cause_edge}` };
      }
      // A late edge is more informative than none: search ten times as long.
      const long = this.#scene.after(from, { ...most, amount: 10 * most.amount });
      const at = yield* this.#edge(gpio, edge, from, long);
      const which = n === 1 ? '' : ` (time ${n})`;
      if (at === undefined) return { at: this.#scene.after(from, most), seen: first ?? `none${which}` };
      if (excess(from, at, most) > tiny || excess(from, at, least) < -tiny)
        first ??= length(from, at, most.cycles) + which;
      if (n === times) return { at, seen: first };
    }
  }

  /** Edges in the window after `start`. */
  *#window(gpio, start, window) {
    const end = this.#scene.after(start, window);
    while (this.#scene.now().ps <= end.ps + tiny) yield end.ps > this.#scene.now().ps ? end : undefined;
    const within = ({ at }) => at.ps > start.ps + tiny && at.ps <= end.ps + tiny;
    return { end, edges: this.#scene.edges[gpio].filter(within) };
  }

  *_count({ gpio, edge, least, most, window }, start) {
    const { end, edges } = yield* this.#window(gpio, start, window);
    const count = edges.filter((each) => is_kind(each, edge)).length;
    return count >= least && count <= most ? { at: end } : { at: end, seen: `${count}` };
  }

  *_never({ gpio, level, window }, start) {
    const { end, edges } = yield* this.#window(gpio, start, window);
    const so = this.#scene.level(gpio, start.ps) === level || edges.some((edge) => edge.level === level);
    return so ? { at: end, seen: level ? 'high' : 'low' } : { at: end };
  }

  *_frequency({ gpio, hz, share, window }, start) {
    const { end, edges } = yield* this.#window(gpio, start, window);
    const rises = edges.filter((edge) => edge.level);
    if (rises.length < 2) return { at: end, seen: `${rises.length} rises` };
    const seen = (rises.length - 1) * 1e12 / (rises.at(-1).at.ps - rises[0].at.ps);
    return Math.abs(seen - hz) <= share * hz ? { at: end } : { at: end, seen: `${Number((seen / 1e6).toFixed(4))} MHz` };
  }

  *_level({ gpio, level }, start) {
    yield* this.#until(start);
    yield;  // let simultaneous edges arrive
    const seen = this.#scene.level(gpio, start.ps + tiny);
    return seen === level ? { at: start } : { at: start, seen: seen ? 'high' : 'low' };
  }

  /** The text; or a line that begins with the same word, which was sent instead. */
  *_text({ port, text, limit }, start) {
    const bytes = this.#scene.bytes[port];
    const said = () => bytes.slice(this.#used[port]).map(({ letter }) => letter).join('');
    const use = (end) => {
      this.#used[port] += end;
      const { at } = bytes[this.#used[port] - 1];
      return at.ps > start.ps ? at : start;
    };
    const end = this.#scene.after(start, limit);
    const last = this.#scene.after(end, { amount: late_ps, cycles: false });
    const first = new RegExp(`(^|\\n)${text.match(/^\w*/)[0]}[^\n]*\n`);
    let seen;
    for (let count = -1; ; yield) {
      const over = this.#scene.now().ps > last.ps;
      if (bytes.length !== count) {
        count = bytes.length;
        const heard = said();
        const found = heard.indexOf(text);
        if (found >= 0) {
          const at = use(found + text.length);
          return at.ps <= end.ps ? { at } : { at, seen: `after ${length(start, at, false)}` };
        }
        seen = heard.match(first);
        if (seen !== null && !text.startsWith(seen[0].trimStart())) break;
      }
      if (over) return { at: last, seen: JSON.stringify(said().slice(-shown)) };
    }
    return { at: use(seen.index + seen[0].length), seen: JSON.stringify(seen[0].trimStart()) };
  }
}
