// The camera over the machine: its picture below the view from above, and its calibration by four
// points. The server has the picture; pages ask for it while they show it.

import { text } from '/texts.js';

const picture_ms = 250, problem_ms = 2000, side = 1000, percent = 100;
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
  #row = 0;  // that takes the next click

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
      input.setAttribute('aria-label', text('camera.value', { number: i + 1, what: text(`camera.${field}`) }));
      input.addEventListener('focus', () => { this.#row = i; });
    }
    const take = add(document.createElement('button'));
    take.type = 'button';
    take.textContent = text('camera.take');
    take.addEventListener('click', () => ['x', 'y'].forEach((field, axis) => {
      this.#input(field, i).value = this.#machine()?.[axis]?.toFixed(3) ?? '';
    }));
    return row;
  }

  #input(field, i) { return this.#element(`camera-${field}${i}`); }
  get #is_shown() { return this.#element('camera-show').checked || this.#element('camera-calibration').open; }

  // After a connection.
  async begin() {
    const { camera, points } = await this.#link.call('camera.get').catch(() => ({ camera: false }));
    this.#element('camera').hidden = !camera;
    if (!camera) return;
    this.#map = points && map_of(points);
    this.#element('camera-text').textContent = points ? '' : text('camera.none');
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

  // One picture after the other, while they are shown and the server is there.
  async #load() {
    this.#timer = 1;
    let next_ms = picture_ms;
    if (!document.hidden && this.#link.is_up) {
      const reply = await fetch('/camera', { headers: { Authorization: `Bearer ${this.#link.token}` } }).catch(() => null);
      if (reply?.ok) this.#show(await reply.blob());
      else if (reply) {
        this.#element('camera-text').textContent = (await reply.text()).trim();
        if (this.#element('camera-text').textContent) next_ms = problem_ms;
      }
    }
    this.#timer = this.#is_shown ? setTimeout(() => this.#load(), next_ms) : 0;
  }

  #show(blob) {
    const before = this.#url;
    this.#url = URL.createObjectURL(blob);
    for (const id of ['camera-picture', 'camera-plain']) this.#element(id).src = this.#url;
    this.#element('camera-text').textContent = this.#map ? '' : text('camera.none');
    setTimeout(() => URL.revokeObjectURL(before), problem_ms);
  }

  // As a painter of the views: the picture in the plane from above.
  draw(views, panes) {
    const pane = panes.find(({ name }) => name === 'top'), box = this.#element('camera-box');
    box.hidden = !pane || !this.#map || !this.#element('camera-show').checked;
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
    const points = [0, 1, 2, 3].map((i) => Object.fromEntries(fields.map((field) => {
      const { value } = this.#input(field, i);
      return [field, value === '' ? null : Number(value) / ('uv'.includes(field) ? percent : 1)];
    })));
    await this.#link.call('camera.calibrate', { points }).then(() => this.begin(), () => {});
  }
}
