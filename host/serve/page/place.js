// Objects in a block: moved, turned, scaled and mirrored by handles and numbers, and written back
// as a description. The points are a sketch; a job is made of the description by the server.
//
// An object is mirrored, scaled, turned about x, y, z and moved, in this order; all but the move
// are about the middle of the block, where a new object is.

import { text } from '/texts.js';
import { add, corners_of, dot } from '/views.js';

const degree = Math.PI / 180, handle_px = 7, knob_px = 26;
const numbers = ['x', 'y', 'z', 'turn-x', 'turn-y', 'turn-z', 'scale', 'size'];
const units = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

// Columns of the rotation about one axis, counter-clockwise seen against it.
function turned_about(axis, angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  return units.map((v) => {
    const along = dot(v, axis);
    const cross = [axis[1] * v[2] - axis[2] * v[1], axis[2] * v[0] - axis[0] * v[2], axis[0] * v[1] - axis[1] * v[0]];
    return v.map((value, i) => value * c + cross[i] * s + axis[i] * along * (1 - c));
  });
}
const turn = (columns, v) => add(add(columns[0].map((value) => value * v[0]), columns[1], v[1]), columns[2], v[2]);
const after = (outer, inner) => inner.map((column) => turn(outer, column));

const rotation_of = ([x, y, z]) => after(turned_about(units[2], z * degree),
                                         after(turned_about(units[1], y * degree), turned_about(units[0], x * degree)));
// Angles about x, then y, then z, of a rotation.
function angles_of(m) {
  const y = Math.asin(Math.min(Math.max(-m[0][2], -1), 1));
  const is_upright = Math.abs(m[0][2]) > 1 - 1e-9;
  const x = is_upright ? Math.atan2(-m[2][1], m[1][1]) : Math.atan2(m[1][2], m[2][2]);
  return [x, y, is_upright ? 0 : Math.atan2(m[0][1], m[0][0])].map((angle) => round(angle / degree, 4));
}
const round = (value, digits) => Number(value.toFixed(digits)) + 0;

export class Placer {
  #link;
  #element;
  #cloud;
  #scene = null;
  #chosen = 0;
  #show_problem;

  // `made` is called with the name of a job that was made.
  constructor(link, element, cloud, show_problem, made) {
    this.#link = link;
    this.#element = element;
    this.#cloud = cloud;
    this.#show_problem = show_problem;
    this.made = made;
    cloud.views.layers.push(this);
    cloud.views.press = (pane, at) => this.#press(pane, at);
    const on = (id, type, act) => element(id).addEventListener(type, () => act().catch?.(() => {}));
    on('place', 'click', () => this.open(element('models').value));
    on('object', 'change', async () => this.#choose(Number(element('object').value)));
    on('object-add', 'click', () => this.#add(element('models').value));
    on('object-remove', 'click', async () => this.#remove());
    on('scene-save', 'click', () => this.save());
    on('job-make', 'click', () => this.make());
    on('close-scene', 'click', async () => this.close());
    for (const name of [...numbers, 'mirror-x', 'mirror-y', 'mirror-z']) on(`object-${name}`, 'input', async () => this.#read_numbers());
  }

  get #object() { return this.#scene?.objects[this.#chosen]; }

  close() {
    this.#scene = null;
    this.#element('placing').hidden = true;
    this.#cloud.close();
  }

  async open(name) {
    if (!name) return this.#show_problem(text('placement.no-file'));
    this.#element('placing-text').textContent = text('placement.reading');
    const scene = await this.#link.call('scene.open', { name }).finally(() => { this.#element('placing-text').textContent = ''; });
    scene.objects.forEach((object, number) => { object.object = number; });
    this.#scene = { ...scene, from: name };
    this.#element('scene-name').value = name.replace(/\.[^.]*$/, '.toml');
    const side = (axis) => scene.block ? round(scene.block[1][axis] - scene.block[0][axis], 3) : '';
    ['x', 'y', 'z'].forEach((axis, i) => { this.#element(`block-${axis}`).value = side(i); });
    this.#element('placing').hidden = false;
    await this.#show_scene(0);
  }

  async #show_scene(chosen) {
    await this.#cloud.show_scene(this.#scene, (object) => this.#map(object));
    this.#choose(chosen);
  }

  async #add(name) {
    if (!this.#scene || !name) return;
    if (/\.toml$/i.test(name)) return this.#show_problem(text('placement.no-model'));
    const { objects } = await this.#link.call('scene.open', { name });
    this.#scene.objects.push(...objects.map((object) => ({ ...object, object: undefined })));
    await this.#show_scene(this.#scene.objects.length - 1);
  }

  #remove() {
    if (!this.#object || this.#scene.objects.length === 1) return this.#show_problem(text('placement.last-object'));
    this.#scene.objects.splice(this.#chosen, 1);
    this.#show_scene(0);
  }

  // The placement as columns and offset.
  #map({ mirror, scale, turn: angles, move }) {
    const rotation = rotation_of(angles), { middle } = this.#scene;
    const columns = rotation.map((column, i) => column.map((value) => value * scale * (mirror[i] ? -1 : 1)));
    return [...columns, add(add(middle, turn(columns, middle), -1), move)];
  }
  #place(object, corner) {
    const map = this.#map(object);
    return add(turn(map, corner), map[3]);
  }
  #middle_of(object) {
    const [low, high] = object.bounds;
    return this.#place(object, low.map((value, i) => (value + high[i]) / 2));
  }

  #choose(number) {
    this.#chosen = number;
    const options = this.#scene.objects.map(({ file }, i) => new Option(`${i + 1}: ${file}`, i, false, i === number));
    this.#element('object').replaceChildren(...options);
    this.#show_numbers();
  }

  #show_numbers() {
    const object = this.#object;
    if (!object) return;
    const values = [...object.move, ...object.turn, object.scale, object.size ?? ''];
    numbers.forEach((name, i) => {
      const input = this.#element(`object-${name}`);
      if (document.activeElement !== input) input.value = values[i] === '' ? '' : round(values[i], 4);
    });
    ['x', 'y', 'z'].forEach((axis, i) => { this.#element(`object-mirror-${axis}`).checked = object.mirror[i]; });
    this.#element('object-kept').textContent = object.kept.length ? text('placement.kept', { kept: object.kept.join(', ') }) : '';
    this.#cloud.place(this.#scene.objects.map((each) => this.#map(each)));
  }

  #read_numbers() {
    const object = this.#object;
    if (!object) return;
    const value = (name) => this.#element(`object-${name}`).valueAsNumber;
    const read = (name, before) => Number.isFinite(value(name)) ? value(name) : before;
    object.move = object.move.map((before, i) => read('xyz'[i], before));
    object.turn = object.turn.map((before, i) => read(`turn-${'xyz'[i]}`, before));
    if (value('scale') > 0) object.scale = value('scale');
    object.wanted_size = value('size') > 0 ? value('size') : null;
    object.mirror = [...'xyz'].map((axis) => this.#element(`object-mirror-${axis}`).checked);
    this.#show_numbers();
  }

  async save() {
    if (!this.#scene) return;
    const name = this.#element('scene-name').value.trim();
    const block = [...'xyz'].map((axis) => this.#element(`block-${axis}`).valueAsNumber);
    const given = { name, from: this.#scene.from, objects: this.#scene.objects.map((object) => ({
      ...(object.object === undefined ? { file: object.file } : { object: object.object }),
      mirror: object.mirror, scale: object.scale, turn: object.turn, move: object.move,
      ...(object.wanted_size ? { size: object.wanted_size } : {}),
    })) };
    if (block.every((side) => side > 0)) given.block = block;
    await this.#link.call('scene.write', given);
    this.#element('placing-text').textContent = text('placement.written', { name });
    await this.made();
    const resized = this.#scene.objects.some(({ wanted_size }) => wanted_size);
    this.#scene.objects.forEach((object, number) => { object.object = number; });
    this.#scene.from = name;
    if (resized || given.block) await this.open(name);
    return name;
  }

  async make() {
    const name = await this.save();
    if (!name) return;
    this.#element('placing-text').textContent = text('placement.making');
    const made = await this.#link.call('job.make', { name })
      .catch((error) => { this.#element('placing-text').textContent = ''; throw error; });
    this.close();
    await this.made(made.name);
    if (made.notices.length > 0) this.#show_problem(made.notices.join('; '));
  }

  // Handles in the planes: the frame moves, its corner scales, the knob above it turns.

  #outline(pane) {
    const ends = corners_of(this.#object.bounds).map((corner) => this.#cloud.views.to_canvas(pane, this.#place(this.#object, corner)));
    const [xs, ys] = [ends.map(({ x }) => x), ends.map(({ y }) => y)];
    return { left: Math.min(...xs), right: Math.max(...xs), top: Math.min(...ys), bottom: Math.max(...ys) };
  }

  draw(context, pane, colour) {
    if (!this.#scene || !this.#object) return;
    const { views } = this.#cloud;
    this.#scene.objects.forEach((object, number) => {
      context.strokeStyle = colour(number === this.#chosen ? '--near' : '--weak');
      views.frame(context, pane, object.bounds, (corner) => this.#place(object, corner));
    });
    if (pane.name === 'camera') return;
    const { left, right, top, bottom } = this.#outline(pane);
    context.fillStyle = context.strokeStyle = colour('--near');
    context.setLineDash([3, 3]);
    context.strokeRect(left, top, right - left, bottom - top);
    context.setLineDash([]);
    for (const x of [left, right])
      for (const y of [top, bottom]) context.fillRect(x - 4, y - 4, 8, 8);
    context.beginPath();
    context.moveTo((left + right) / 2, top);
    context.lineTo((left + right) / 2, top - knob_px);
    context.stroke();
    context.beginPath();
    context.arc((left + right) / 2, top - knob_px, 5, 0, 7);
    context.fill();
  }

  #press(pane, at) {
    if (!this.#scene || !this.#object || pane.name === 'camera') return null;
    const { left, right, top, bottom } = this.#outline(pane), object = this.#object;
    const middle = this.#cloud.views.to_canvas(pane, this.#middle_of(object));
    const is_at = (x, y) => Math.hypot(at.x - x, at.y - y) <= handle_px + 3;
    if (is_at((left + right) / 2, top - knob_px)) return this.#turner(pane, object, middle, at);
    if ([left, right].some((x) => [top, bottom].some((y) => is_at(x, y)))) return this.#scaler(object, middle, at);
    const is_inside = at.x >= left && at.x <= right && at.y >= top && at.y <= bottom;
    return is_inside ? this.#mover(pane, object, at) : null;
  }

  // The middle of the object stays where it is.
  #about_middle(object, change) {
    const before = this.#middle_of(object);
    change();
    object.move = add(add(object.move, before), this.#middle_of(object), -1).map((mm) => round(mm, 4));
    this.#show_numbers();
  }

  #turner(pane, object, middle, at) {
    const start = rotation_of(object.turn), angle = ({ x, y }) => Math.atan2(middle.y - y, x - middle.x);
    const from = angle(at);
    return (now, event) => this.#about_middle(object, () => {
      const step = event.shiftKey ? 15 * degree : 0.1 * degree;
      const by = Math.round((angle(now) - from) / step) * step;
      object.turn = angles_of(after(turned_about(pane.back, by), start));
    });
  }

  #scaler(object, middle, at) {
    const start = object.scale, far = ({ x, y }) => Math.max(Math.hypot(x - middle.x, y - middle.y), 1);
    return (now) => this.#about_middle(object, () => { object.scale = Math.max(round(start * far(now) / far(at), 4), 0.0001); });
  }

  #mover(pane, object, at) {
    const start = object.move, { scale } = this.#cloud.views;
    return (now) => {
      const to = add(add(start, pane.right, (now.x - at.x) / scale), pane.up, (at.y - now.y) / scale);
      object.move = to.map((mm) => round(mm, 3));
      this.#show_numbers();
    };
  }
}
