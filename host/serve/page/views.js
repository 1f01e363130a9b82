// Four views of one place: three planes and one that turns. None has perspective, so that each is
// three directions (right, up, towards the eye), and lengths can be compared.
//
// Coordinates of the canvas are CSS pixels; all others are millimetres of the machine.

import { text } from '/texts.js';

const planes = {
  top: { title: text('view.title', { name: text('view.top'), axes: 'X Y' }), right: [1, 0, 0], up: [0, 1, 0], back: [0, 0, 1] },
  front: { title: text('view.title', { name: text('view.front'), axes: 'X Z' }), right: [1, 0, 0], up: [0, 0, 1], back: [0, -1, 0] },
  side: { title: text('view.title', { name: text('view.side'), axes: 'Y Z' }), right: [0, 1, 0], up: [0, 0, 1], back: [1, 0, 0] },
};
const order = [['top', 'camera'], ['front', 'side']];
const axis_names = 'XYZ';
const zoom_step = 1.25, key_px = 40, key_turn = 0.15, turn_px = 0.008;
const late_ms = 45, early_ms = 20, max_pace_ms = 1500, rest_ms = 250;

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const add = (a, b, factor = 1) => a.map((value, i) => value + factor * b[i]);

// The eight corners of a box [low, high]; corners that differ in one bit are joined by an edge.
export function corners_of([low, high]) {
  return [...Array(8).keys()].map((n) => [0, 1, 2].map((axis) => (n >> axis & 1 ? high : low)[axis]));
}
const edges = [...Array(8).keys()].flatMap((n) => [1, 2, 4].filter((bit) => !(n & bit)).map((bit) => [n, n | bit]));

// 1, 2 or 5 times a power of ten, at least this.
function nice_step(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].find((digit) => digit * power >= least) * power;
}

export class Views {
  centre = [0, 0, 0];
  scale = 4;  // pixels of a millimetre
  yaw = -0.6;
  tilt = 0.5;
  which = 'four';
  // Painters of points and paths have draw(views, panes, ...); marks have draw(context, pane); both
  // in this order.
  painters = [];
  layers = [];
  // May take a drag: returns a function for its moves, or null.
  press = () => null;
  hover = () => {};
  #canvas;
  #frame;
  #context;
  #waits = false;
  #drag = null;
  #points_change = false;  // not the marks alone
  #moves = false;
  #moved = false;  // in the frame before
  #pace = 0;       // ms
  #rest = 0;
  #drawn_at = 0;
  // Share of the points that is drawn while the view moves: less where frames are late.
  #share = 1;

  constructor(frame, canvas) {
    this.#frame = frame;
    this.#canvas = canvas;
    this.#context = canvas.getContext('2d');
    new ResizeObserver(() => this.draw_soon()).observe(frame);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.draw_soon());
    canvas.addEventListener('pointerdown', (event) => this.#press(event));
    canvas.addEventListener('pointermove', (event) => this.#move(event));
    for (const name of ['pointerup', 'pointercancel', 'lostpointercapture'])
      canvas.addEventListener(name, () => { this.#drag = null; });
    canvas.addEventListener('pointerleave', () => this.hover(null));
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      this.zoom(event.deltaY < 0 ? zoom_step : 1 / zoom_step, this.#at(event));
    }, { passive: false });
    canvas.addEventListener('keydown', (event) => this.#key(event));
  }

  get width() { return this.#frame.clientWidth; }
  get height() { return this.#frame.clientHeight; }

  directions(name) {
    if (name !== 'camera') return planes[name];
    const [c, s, e, f] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.tilt), Math.sin(this.tilt)];
    return { title: text('view.camera'), right: [c, s, 0], up: [-s * f, c * f, e], back: [s * e, -c * e, f] };
  }

  // The parts of the canvas, each with its view.
  panes() {
    const pane = (name, x, y, width, height) => ({ name, x, y, width, height, ...this.directions(name) });
    if (this.which !== 'four') return [pane(this.which, 0, 0, this.width, this.height)];
    const [width, height] = [this.width / 2, this.height / 2];
    return order.flatMap((row, j) => row.map((name, i) => pane(name, i * width, j * height, width, height)));
  }

  pane_at({ x, y }) {
    return this.panes().find((pane) => x >= pane.x && y >= pane.y && x < pane.x + pane.width && y < pane.y + pane.height);
  }

  to_canvas(pane, place) {
    const from = add(place, this.centre, -1);
    return {
      x: pane.x + pane.width / 2 + dot(from, pane.right) * this.scale,
      y: pane.y + pane.height / 2 - dot(from, pane.up) * this.scale,
    };
  }

  // The place under a position, as deep as the centre.
  to_place(pane, { x, y }) {
    const right = (x - pane.x - pane.width / 2) / this.scale, up = (pane.y + pane.height / 2 - y) / this.scale;
    return add(add(this.centre, pane.right, right), pane.up, up);
  }

  fit([low, high]) {
    this.centre = low.map((value, i) => (value + high[i]) / 2);
    const size = Math.hypot(...low.map((value, i) => high[i] - value)) || 1;
    const pane = this.panes()[0];
    this.scale = 0.85 * Math.min(pane.width, pane.height) / size || 1;
    this.draw_soon();
  }

  // Zooms; what is under `at` stays there.
  zoom(factor, at = null) {
    const pane = at && this.pane_at(at);
    const before = pane && this.to_place(pane, at);
    this.scale = Math.min(Math.max(this.scale * factor, 0.02), 20000);
    if (pane) this.centre = add(add(this.centre, before), this.to_place(pane, at), -1);
    this.#move_on();
  }

  #at(event) {
    const box = this.#canvas.getBoundingClientRect();
    return { x: event.clientX - box.x, y: event.clientY - box.y };
  }

  #pan(pane, x, y) {
    this.centre = add(add(this.centre, pane.right, -x / this.scale), pane.up, y / this.scale);
  }

  #turn(yaw, tilt) {
    this.yaw += yaw;
    this.tilt = Math.min(Math.max(this.tilt + tilt, -Math.PI / 2), Math.PI / 2);
  }

  #press(event) {
    if (event.button !== 0) return;
    const at = this.#at(event), pane = this.pane_at(at);
    if (!pane) return;
    this.#canvas.setPointerCapture(event.pointerId);
    const own = this.press(pane, at);
    let last = at;
    this.#drag = own ?? ((now) => {
      if (pane.name === 'camera') this.#turn((last.x - now.x) * turn_px, (now.y - last.y) * turn_px);
      else this.#pan(pane, now.x - last.x, now.y - last.y);
      last = now;
    });
  }

  #move(event) {
    const at = this.#at(event);
    if (this.#drag) this.#drag(at, event);
    const pane = this.pane_at(at);
    this.hover(pane ? { pane, at } : null);
    if (this.#drag) this.#move_on();
    else this.draw_marks_soon();
  }

  // Keys of the view are not those of jogs.
  #key(event) {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    const factor = { '+': zoom_step, '=': zoom_step, '-': 1 / zoom_step }[event.key];
    if ((!way && !factor) || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    event.stopPropagation();
    if (factor) return this.zoom(factor);
    const pane = this.panes()[0];
    if (pane.name === 'camera') this.#turn(way[0] * key_turn, way[1] * key_turn);
    else this.#pan(pane, -way[0] * key_px, -way[1] * key_px);
    this.#move_on();
  }

  draw_soon() {
    this.#points_change = true;
    this.draw_marks_soon();
  }

  // The view moves: another frame will follow, or all points are drawn a little later.
  #move_on() {
    this.#moves = true;
    clearTimeout(this.#rest);
    this.#rest = setTimeout(() => {
      this.#moves = false;
      this.draw_soon();
    }, rest_ms + 3 * this.#pace);
    this.draw_soon();
  }

  draw_marks_soon() {
    if (this.#waits) return;
    this.#waits = true;
    requestAnimationFrame((time) => {
      this.#waits = false;
      if (this.width > 0) this.#draw(time);
    });
  }

  // Fewer points where frames are late, more where there is time.
  #keep_pace(time) {
    const took = time - this.#drawn_at, both = this.#moves && this.#moved;
    this.#drawn_at = time;
    this.#moved = this.#moves;
    if (!both) return;
    this.#pace = Math.min(took, max_pace_ms);
    if (took > late_ms) this.#share = Math.max(this.#share / 2, 1 / 32);
    else if (took < early_ms) this.#share = Math.min(this.#share * 2, 1);
  }

  #draw(time) {
    const ratio = Math.min(devicePixelRatio || 1, 2), style = getComputedStyle(this.#frame);
    const colour = (name) => style.getPropertyValue(name).trim();
    const panes = this.panes(), context = this.#context;
    if (this.#points_change) {
      this.#keep_pace(time);
      this.#points_change = false;
      for (const painter of this.painters) painter.draw(this, panes, ratio, colour, this.#moves ? this.#share : 1);
    }
    const [width, height] = [Math.round(this.width * ratio), Math.round(this.height * ratio)];
    if (this.#canvas.width !== width) this.#canvas.width = width;
    if (this.#canvas.height !== height) this.#canvas.height = height;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, this.width, this.height);
    for (const pane of panes) {
      context.save();
      context.beginPath();
      context.rect(pane.x, pane.y, pane.width, pane.height);
      context.clip();
      if (pane.name !== 'camera') this.#grid(context, pane, colour);
      for (const layer of this.layers) layer.draw(context, pane, colour);
      context.fillStyle = colour('--weak');
      context.font = '12px system-ui, sans-serif';
      context.fillText(pane.title, pane.x + 8, pane.y + 16);
      context.restore();
      context.strokeStyle = colour('--line');
      context.strokeRect(pane.x + 0.5, pane.y + 0.5, pane.width - 1, pane.height - 1);
    }
  }

  // Lines in millimetres with their numbers at the lower and the left edge.
  #grid(context, pane, colour) {
    const step = nice_step(48 / this.scale), digits = Math.max(0, -Math.floor(Math.log10(step)));
    const low = this.to_place(pane, { x: pane.x, y: pane.y + pane.height });
    const high = this.to_place(pane, { x: pane.x + pane.width, y: pane.y });
    context.lineWidth = 1;
    context.font = '11px system-ui, sans-serif';
    context.fillStyle = colour('--weak');
    for (const [way, is_right] of [[pane.right, true], [pane.up, false]]) {
      const axis = way.findIndex((value) => value !== 0);
      context.strokeStyle = colour('--grid');
      context.beginPath();
      for (let k = Math.ceil(low[axis] / step); k * step <= high[axis]; ++k) {
        const place = [...this.centre];
        place[axis] = k * step;
        const { x, y } = this.to_canvas(pane, place);
        if (is_right) context.moveTo(x, pane.y), context.lineTo(x, pane.y + pane.height);
        else context.moveTo(pane.x, y), context.lineTo(pane.x + pane.width, y);
        const number = (k * step).toFixed(digits);
        if (is_right) context.fillText(number, x + 2, pane.y + pane.height - 5);
        else if (y > pane.y + 30 && y < pane.y + pane.height - 18) context.fillText(number, pane.x + 3, y - 2);
      }
      context.stroke();
    }
    const { x, y } = { x: pane.x + pane.width - 58, y: pane.y + 16 };
    context.fillText(text('view.mm', { place: step.toFixed(digits) }), x, y);
  }

  // Frame of a box, its corners placed by `place`.
  frame(context, pane, box, place = (corner) => corner) {
    const ends = corners_of(box).map((corner) => this.to_canvas(pane, place(corner)));
    context.beginPath();
    for (const [a, b] of edges) {
      context.moveTo(ends[a].x, ends[a].y);
      context.lineTo(ends[b].x, ends[b].y);
    }
    context.stroke();
  }

  // What a cursor in a plane knows: two coordinates.
  text_of({ pane, at }) {
    const place = this.to_place(pane, at);
    return text('view.mm', { place: [pane.right, pane.up].map((way) => {
      const axis = way.findIndex((value) => value !== 0);
      return `${axis_names[axis]} ${place[axis].toFixed(3)}`;
    }).join('  ') });
  }
}
