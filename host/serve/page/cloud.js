// A job or a program in four views: a sample of its points from the server, and the exact ones near
// the cursor; or its path.

import { make_painter, no_map, uses_webgl } from '/cloud_painter.js';
import { PathPainter } from '/path_painter.js';
import { text } from '/texts.js';
import { Views } from '/views.js';

const near_px = 40, pick_px = 8, click_px = 4;

export class CloudView {
  #link;
  #element;
  #cloud = null;  // result of cloud.open
  #bounds = [[-50, -50, -50], [50, 50, 50]];
  #frames = [];   // boxes with a colour
  #near = [];     // exact points near the cursor
  #cursor = null;
  #asks = false;
  #machine = null;
  #opened = 0;    // counts: an answer for a file that is no longer shown is dropped
  #go;
  #path;
  #done = NaN;    // share of the job that is drawn as done

  // `go` moves the machine to a place {x, y, z}.
  constructor(link, element, go) {
    this.#link = link;
    this.#element = element;
    this.#go = go;
    this.views = new Views(element('views'), element('marks'));
    this.views.layers.push(this);
    this.#path = new PathPainter(element('path'));
    this.views.painters.push(this.#path);
    this.views.hover = (cursor) => this.#hover(cursor);
    element('which').addEventListener('change', ({ target }) => {
      this.views.which = target.value;
      this.fit();
    });
    element('view-fit').addEventListener('click', () => this.fit());
    element('view-area').addEventListener('click', () => this.show_area().catch(() => {}));
    let pressed = null;
    element('marks').addEventListener('pointerdown', ({ clientX, clientY }) => { pressed = [clientX, clientY]; });
    element('marks').addEventListener('click', ({ clientX, clientY }) => {
      const moved = Math.hypot(clientX - pressed[0], clientY - pressed[1]);
      if (element('go').checked && !element('go').disabled && moved <= click_px) this.#click();
    });
    element('view-in').addEventListener('click', () => this.views.zoom(1.5));
    element('view-out').addEventListener('click', () => this.views.zoom(1 / 1.5));
  }

  fit() { this.views.fit(this.#bounds); }

  close() {
    ++this.#opened;
    this.#cloud = null;
    this.#near = [];
    this.#done = NaN;
    this.#path.show(null);
    this.painter?.begin([], 1);
    this.#element('view').hidden = true;
    delete this.#element('views').dataset.shown;
  }

  // Shows the points of a job as they come; the path of rows and programs. `file`: parameters of path.open.
  async open(file, is_job) {
    this.close();
    const own = this.#opened;
    const asked = is_job ? this.#link.call('cloud.open', { name: file.name }) : { points: 0 };
    if (is_job) this.#begin_painter();  // while the server reads the job
    const cloud = await asked;
    if (own !== this.#opened) return;
    if (cloud.points > 0) await this.#show_cloud(cloud);
    else await this.#show_path(file, own);
  }

  async #show_path(file, own) {
    const path = await this.#link.call('path.open', file);
    const numbers = this.#link.take_frame(0, 0);
    if (own !== this.#opened || !numbers) return;
    this.#bounds = path.bounds;
    this.#frames = [{ box: path.area, colour: '--line', dash: [] }, { box: path.bounds, colour: '--strong', dash: [4, 4] }];
    this.#path.show(numbers, path.bounds);
    this.#element('cloud-text').textContent = text('view.path', path);
    this.#element('view').hidden = false;
    this.fit();
    requestAnimationFrame(() => { this.#element('views').dataset.shown = path.places; });
  }

  // The work space alone.
  async show_area() {
    this.close();
    this.#bounds = await this.#link.call('machine.area');
    this.#frames = [{ box: this.#bounds, colour: '--line', dash: [] }];
    this.#element('cloud-text').textContent = '';
    this.#element('view').hidden = false;
    this.fit();
  }

  // A click into a plane: its two axes go there, the third one stays.
  #click() {
    if (!this.#cursor || this.#cursor.pane.name === 'camera') return;
    const { pane, at } = this.#cursor;
    const place = this.views.to_place(pane, at).map((mm) => Number(mm.toFixed(3)));
    this.#go(Object.fromEntries([...'xyz'].map((name, i) => [name, place[i]]).filter((_, i) => pane.back[i] === 0)));
  }

  async #show_cloud(cloud) {
    this.#cloud = cloud;
    this.#bounds = cloud.bounds;
    this.#frames = [{ box: cloud.area, colour: '--line', dash: [] }, { box: cloud.bounds, colour: '--strong', dash: [4, 4] }];
    this.#element('cloud-text').textContent = text(cloud.shown < cloud.points ? 'view.sample' : 'job.points', cloud);
    await this.#draw([{ ...cloud, map: no_map }]);
  }

  // Objects that are placed: each has a cloud and a map. place() changes the maps.
  async show_scene({ objects, area, block }, map_of) {
    this.close();
    this.#bounds = block ?? area;
    this.#frames = [{ box: area, colour: '--line', dash: [] }];
    if (block) this.#frames.push({ box: block, colour: '--strong', dash: [] });
    this.#element('cloud-text').textContent = text('view.sketch');
    await this.#draw(objects.map((object) => ({ ...object, map: map_of(object) })));
  }

  place(maps) {
    this.painter.parts.forEach((part, i) => { part.map = maps[i] ?? part.map; });
    this.views.draw_soon();
  }

  // Draws points of clouds as they come.
  async #draw(clouds) {
    const own = ++this.#opened;
    let first = 0;
    const parts = clouds.map(({ shown, bounds, map }) => ({ first: (first += shown) - shown, count: shown, bounds, map }));
    this.#begin_painter();
    const [low, high] = this.#bounds;
    this.painter.begin(parts, Math.max(...low.map((value, i) => high[i] - value)));
    this.#element('view').hidden = false;
    this.fit();
    for (const [i, { cloud, shown }] of clouds.entries()) {
      for (let from = 0; from < shown;) {
        const { count } = await this.#link.call('cloud.points', { cloud, from });
        const numbers = this.#link.take_frame(cloud, from);
        if (own !== this.#opened || !numbers || count === 0) return;
        this.painter.put(parts[i].first + from, numbers);
        from += count;
        this.views.draw_soon();
        requestAnimationFrame(() => { this.#element('views').dataset.shown = this.painter.count; });
      }
    }
  }

  // Creating the WebGL context takes up to 1 s, so the page does it while it is idle, as soon as the
  // server has a job of points.
  prepare() {
    (window.requestIdleCallback ?? setTimeout)(() => this.#begin_painter());
  }

  // Created late, so that the page itself loads faster.
  #begin_painter() {
    if (this.painter) return;
    this.painter = make_painter(this.#element('points'));
    this.views.painters.unshift(this.painter);
    this.#element('webgl-text').hidden = uses_webgl(this.painter);
  }

  // The machine, and how much of the job is done.
  follow({ board = {}, job = {} }, name) {
    const done = job.name === name && job.total ? job.done / job.total : 0;
    const machine = board.machine?.length >= 2 ? [...board.machine, 0].slice(0, 3) : null;
    if (done === this.#done && String(machine) === String(this.#machine)) return;
    this.#machine = machine;
    this.#done = this.#path.done = done;
    if (this.painter) this.painter.done = done;
    if (!this.#element('view').hidden) this.views.draw_soon();
  }

  #hover(cursor) {
    this.#cursor = cursor;
    if (!cursor) this.#near = [];
    this.#show_cursor();
    this.#ask();
  }

  #show_cursor() {
    const picked = this.#picked();
    const parts = [];
    if (this.#cursor && this.#cursor.pane.name !== 'camera') parts.push(this.views.text_of(this.#cursor));
    if (picked) parts.push(text('view.point', {
      number: picked.number, place: picked.place.map((mm, i) => `${'XYZ'[i]} ${mm.toFixed(3)}`).join(' '),
    }));
    this.#element('cursor').textContent = parts.join('; ') || ' ';
  }

  // The nearest exact point, if the cursor is on it.
  #picked() {
    const point = this.#near[0];
    if (!point || !this.#cursor) return null;
    const { x, y } = this.views.to_canvas(this.#cursor.pane, point.place);
    return Math.hypot(x - this.#cursor.at.x, y - this.#cursor.at.y) <= pick_px ? point : null;
  }

  // One question at a time: the last cursor is asked for when the answer has come.
  async #ask() {
    if (this.#asks || !this.#cursor || !this.#cloud) return;
    this.#asks = true;
    try {
      for (let asked = null; this.#cursor && this.#cursor !== asked;) {
        asked = this.#cursor;
        this.#near = await this.#link.call('cloud.near', {
          cloud: this.#cloud.cloud, at: this.views.to_place(asked.pane, asked.at), along: asked.pane.back,
          mm: near_px / this.views.scale,
        });
        this.#show_cursor();
        this.views.draw_marks_soon();
      }
    } catch {
      this.#near = [];
    } finally {
      this.#asks = false;
    }
  }

  // Marks over the points.
  draw(context, pane, colour) {
    for (const { box, colour: name, dash } of this.#frames) {
      context.setLineDash(dash);
      context.strokeStyle = colour(name);
      this.views.frame(context, pane, box);
    }
    context.setLineDash([]);
    context.fillStyle = colour('--near');
    for (const { place } of this.#near) {
      const { x, y } = this.views.to_canvas(pane, place);
      context.fillRect(x - 1.5, y - 1.5, 3, 3);
    }
    this.#cross(context, pane, this.#picked()?.place, colour('--near'), 9);
    this.#cross(context, pane, this.#machine, colour('--stop'), 7);
  }

  #cross(context, pane, place, colour, side) {
    if (!place) return;
    const { x, y } = this.views.to_canvas(pane, place);
    context.strokeStyle = colour;
    context.beginPath();
    context.moveTo(x - side, y);
    context.lineTo(x + side, y);
    context.moveTo(x, y - side);
    context.lineTo(x, y + side);
    context.stroke();
  }
}
