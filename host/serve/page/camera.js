// The camera over the machine: its picture in the top view, and its calibration by four points. The
// server has the picture; the page asks for it while it shows it.

import { text } from '/texts.js';

const picture_ms = 250, problem_ms = 2000;  // pauses before the next picture
const answer_ms = 10000;                    // the server answers at once, a link may be slow
const keep_ms = 2000;                       // the image may still decode the picture before
const side = 1000;                          // px: of the picture before its map, as in page.css
const percent = 100;
const fields = ['u', 'v', 'x', 'y'];

// The perspective map of places (u, v) to (x, y), nine numbers in rows of three: two linear equations
// of each point (Heckbert, "Fundamentals of Texture Mapping and Image Warping", 1989).
export function map_of(points) {
  const rows = points.flatMap(({ u, v, x, y }) => [[u, v, 1, 0, 0, 0, -u * x, -v * x, x], [0, 0, 0, u, v, 1, -u * y, -v * y, y]]);
  for (let i = 0; i < 8; ++i) {
    const pivot = rows.slice(i).reduce((best, row) => Math.abs(row[i]) > Math.abs(best[i]) ? row : best);
    rows.splice(rows.indexOf(pivot), 1);
    rows.splice(i, 0, pivot);
    for (const row of rows) {
      if (row === pivot) continue;
      const factor = row[i] / pivot[i];
      pivot.forEach((value, j) => { row[j] -= factor * value; });
    }
  }
  return [...rows.map((row, i) => row[8] / row[i]), 1];
}

export class Camera {
  #link;
  #element;
  #cloud;
  #machine;
  #map = null;
  #url = '';
  #timer = 0;
  #row = 0;  // the one that the next click fills
  #is_current = false;

  // `machine` returns the position of the machine.
  constructor(link, element, cloud, machine) {
    [this.#link, this.#element, this.#cloud, this.#machine] = [link, element, cloud, machine];
    cloud.views.painters.push(this);
    element('camera-points').append(...[0, 1, 2, 3].map((i) => this.#make_row(i)));
    element('camera-show').addEventListener('change', () => this.#change());
    element('camera-calibration').addEventListener('toggle', () => this.#change());
    element('camera-plain').addEventListener('click', (event) => this.#click(event));
    element('camera-save').addEventListener('click', () => this.#save());
  }

  #make_row(i) {
    const row = document.createElement('tr');
    const add = (child) => (row.insertCell().append(child), child);
    add(String(i + 1));
    for (const field of fields) {
      const input = add(document.createElement('input'));
      [input.type, input.id, input.step] = ['number', `camera-${field}${i}`, 'any'];
      if ('uv'.includes(field)) [input.min, input.max] = [0, percent];
      input.setAttribute('aria-label', text('camera.value', { number: i + 1, what: text(`camera.${field}`) }));
      input.addEventListener('focus', () => { this.#row = i; });
    }
    const take = add(document.createElement('button'));
    take.type = 'button';
    take.textContent = text('camera.take');
    take.setAttribute('aria-label', text('camera.value', { number: i + 1, what: text('camera.take') }));
    take.addEventListener('click', () => ['x', 'y'].forEach((field, axis) => {
      this.#input(field, i).value = this.#machine()?.[axis]?.toFixed(3) ?? '';
    }));
    return row;
  }

  #input(field, i) { return this.#element(`camera-${field}${i}`); }
  get #is_shown() { return this.#element('camera-show').checked || this.#element('camera-calibration').open; }

  // After a connection.
  async begin() {
    const { camera, points } = await this.#link.call('camera.get');
    this.#element('camera').hidden = !camera;
    if (!camera) return;
    this.#map = points && map_of(points);
    this.#say(points ? '' : text('camera.none'));
    // Numbers that the user has entered and not saved stay.
    const is_empty = fields.every((field) => [0, 1, 2, 3].every((i) => this.#input(field, i).value === ''));
    if (is_empty)
      points?.forEach((point, i) => fields.forEach((field) => {
        this.#input(field, i).value = 'uv'.includes(field) ? point[field] * percent : point[field];
      }));
    this.#change();
  }

  #change() {
    if (this.#is_shown && !this.#timer) this.#load();
    if (this.#element('camera-show').checked && this.#element('view').hidden) this.#cloud.show_area().catch(() => {});
    this.#cloud.views.draw_soon();
  }

  // Loads one picture after the other, while the section shows them and the connection is open.
  async #load() {
    this.#timer = 1;
    let next_ms = picture_ms;
    try {
      if (document.hidden || !this.#link.is_up) this.#hide();
      else if (await this.#load_one()) next_ms = problem_ms;
    } catch {
      this.#hide();  // the connection is lost, which the page says elsewhere
    }
    this.#timer = this.#is_shown ? setTimeout(() => this.#load(), next_ms) : 0;
  }

  // The reason why the camera has no picture; empty if it has one or has not answered yet.
  async #load_one() {
    const reply = await fetch('/camera', {
      headers: { Authorization: `Bearer ${this.#link.token}` }, signal: AbortSignal.timeout(answer_ms),
    });
    if (reply.ok) return this.#show(await reply.blob());
    const reason = (await reply.text()).trim();
    this.#hide();
    this.#say(reason);
    return reason;
  }

  // Screen readers repeat a text that is set again.
  #say(message) {
    const element = this.#element('camera-text');
    if (element.textContent !== message) element.textContent = message;
  }

  // An old picture could be taken for what the machine does now.
  #hide() {
    this.#is_current = false;
    this.#element('camera-plain').classList.add('old');
    this.#cloud.views.draw_soon();
  }

  #show(blob) {
    const before = this.#url;
    this.#url = URL.createObjectURL(blob);
    for (const id of ['camera-picture', 'camera-plain']) this.#element(id).src = this.#url;
    this.#say(this.#map ? '' : text('camera.none'));
    setTimeout(() => URL.revokeObjectURL(before), keep_ms);
    if (this.#is_current) return '';
    this.#is_current = true;
    this.#element('camera-plain').classList.remove('old');
    this.#cloud.views.draw_soon();
    return '';
  }

  // As a painter of the views: draws the picture in the top view.
  draw(views, panes) {
    const pane = panes.find(({ name }) => name === 'top'), box = this.#element('camera-box');
    box.hidden = !pane || !this.#map || !this.#is_current || !this.#element('camera-show').checked;
    if (box.hidden) return;
    for (const [name, value] of [['left', pane.x], ['top', pane.y], ['width', pane.width], ['height', pane.height]])
      box.style[name] = `${value}px`;
    // Millimetres to pixels of the pane, after the map; a picture has `side` pixels in both directions.
    const s = views.scale, m = this.#map;
    const dx = pane.width / 2 - views.centre[0] * s, dy = pane.height / 2 + views.centre[1] * s;
    const [a, b, c] = [0, 1, 2].map((i) => s * m[i] + dx * m[6 + i]);
    const [d, e, f] = [0, 1, 2].map((i) => -s * m[3 + i] + dy * m[6 + i]);
    this.#element('camera-picture').style.transform = `matrix3d(${[
      a / side, d / side, 0, m[6] / side, b / side, e / side, 0, m[7] / side, 0, 0, 1, 0, c, f, 0, 1].join()})`;
  }

  #click({ offsetX, offsetY, target }) {
    this.#input('u', this.#row).value = (offsetX / target.clientWidth * percent).toFixed(2);
    this.#input('v', this.#row).value = (offsetY / target.clientHeight * percent).toFixed(2);
    this.#row = (this.#row + 1) % 4;
  }

  async #save() {
    const inputs = [0, 1, 2, 3].flatMap((i) => fields.map((field) => this.#input(field, i)));
    if (!inputs.every((input) => input.reportValidity())) return;
    const points = [0, 1, 2, 3].map((i) => Object.fromEntries(fields.map((field) => {
      const { value } = this.#input(field, i);
      return [field, value === '' ? null : Number(value) / ('uv'.includes(field) ? percent : 1)];
    })));
    await this.#link.call('camera.calibrate', { points }).then(() => this.begin()).catch(() => {});
  }
}
