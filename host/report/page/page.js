// The page itself: fills in the numbers and handles the user's input.

const $ = (id) => document.getElementById(id);

function add(parent, name, text, className) {
  const element = document.createElement(name);
  if (text !== undefined) element.textContent = text;
  if (className) element.className = className;
  parent.append(element);
  return element;
}

const number_or = (value, text) => (value === null ? 'unknown' : text(value));

function fill_head() {
  const file = report.input.split('/').pop();
  document.title = `${file} - ${data.estimate ? 'estimate' : 'report'} - lamplock`;
  $('kind').textContent = data.estimate ? 'lamplock estimate' : 'lamplock report';
  $('title').textContent = file;
  const where = data.estimate ? 'as the machine will run it' : `on ${report.board === 'virtual' || report.board === 'chip' ? `the simulated board (${report.board})` : report.board}`;
  const rest = report.from > 0 ? `, continued at point ${grouped(report.points_before)} of ${grouped(report.points_before + report.points)}` : '';
  $('subtitle').textContent = `mode ${report.mode}, lamp ${Number(report.lamp_hz)} Hz, ${where}${rest}`;
  $('footer').textContent = `Made by lamplock ${report.version}. This page is one file and needs no network.`;
}

function fill_warnings() {
  for (const warning of data.warnings) add($('warnings'), 'p', warning, 'warning');
  $('warnings').hidden = data.warnings.length === 0;
}

// One key number. `key`: its name in report.json.
function add_tile(key, label, text, note, kind) {
  const tile = add($('tiles'), 'dl', undefined, `tile ${kind ?? ''}`);
  tile.style.margin = '0';
  add(tile, 'dt', label);
  const value = add(tile, 'dd', text);
  value.dataset.key = key;
  value.dataset.value = report[key];
  add(tile, 'small', note);
}

function fill_tiles() {
  const shots = report.shots === report.points ? 'one shot each' : `${grouped(report.shots)} shots`;
  add_tile('points', 'Points', grouped(report.points), report.points_fired === report.points ? shots : report.dry ? 'none of them fired: dry run' : `${grouped(report.points_fired)} of them fired`);
  add_tile('time_s', 'Machine time', time_text(report.time_s), `${fixed(report.points_per_s, 1)} points/s`);
  add_tile('utilisation', 'Utilisation', `${fixed(100 * report.utilisation, 1)} %`, 'of the lamp\u2019s flashes');
  add_tile('beats_per_point', 'Beats per point', fixed(report.beats_per_point, 3), `${grouped(report.beats)} beats`);
  if (report.missed !== null) {
    const late = report.dry ? 0 : data.cloud.not_reached, wrong = report.missed - late + report.doubled;
    add_tile('missed', 'Missed', grouped(report.missed), `${late > 0 ? `${grouped(late)} of them not reached, ` : ''}${grouped(report.doubled)} doubled`, wrong ? 'bad' : 'good');
  }
  if (report.largest_error_steps !== null)
    add_tile('largest_error_steps', 'Largest error', `${fixed(report.largest_error_steps, 2)} step`, report.largest_jitter_error_steps === null ? '' : `${fixed(report.largest_jitter_error_steps, 2)} with lamp jitter`);
}

// Columns for tiles: as few rows as fit, all of them about equally long.
function tile_columns(count, width) {
  const min_tile_px = 150;
  const fit = Math.min(count, Math.max(2, Math.floor(width / min_tile_px)));
  return Math.ceil(count / Math.ceil(count / fit));
}

function arrange_tiles() {
  const tiles = [...$('tiles').children];
  const columns = tile_columns(tiles.length, $('tiles').clientWidth);
  $('tiles').style.setProperty('--columns', columns);
  // A tile that is alone in the last row gets the whole row.
  tiles.forEach((tile, i) => {
    tile.style.gridColumn = i === tiles.length - 1 && i % columns === 0 ? '1 / -1' : '';
  });
}

// How to repeat the job. Points of an earlier part must not be fired twice in one glass.
function description_text() {
  const command = `lamplock engrave ${data.description} --board ${report.board}${report.dry ? ' --dry' : ''}`;
  const place = `${data.description} in the folder of this page; `;
  if (report.from === 0) return `${place}${command} repeats the job from its first point on, on ${report.board}`;
  return `${place}${command} --from ${report.from} repeats this part, on ${report.board}; without --from it fires the whole job, also the points that were fired before`;
}

// How the job was made, as far as it is known.
function fill_making() {
  const body = $('making').tBodies[0];
  const row = (label, text, name) => {
    if (text === null || text === undefined || text === '') return;
    const line = add(body, 'tr');
    add(line, 'td', label);
    const cell = add(line, 'td', name === 'command' ? undefined : text);
    if (name === 'command') add(cell, 'code', text);
    cell.dataset.making = name;
  };
  const size = (report.size_mm ?? data.cloud.size_mm).map((side) => short(side)).join(' \u00d7 ');
  row('Input', report.input, 'input');
  row('Size', `${size} mm`, 'size_mm');
  row('Spacing', report.spacing_mm === null ? null : `${short(report.spacing_mm)} mm`, 'spacing_mm');
  for (const name of ['method', 'order', 'material', 'command'])
    row(name[0].toUpperCase() + name.slice(1), report[name], name);
  row('Description', data.description && description_text(), 'description');
}

function fill_numbers() {
  const body = $('numbers').tBodies[0];
  const row = (label, text, key) => {
    const line = add(body, 'tr');
    add(line, 'td', label);
    const cell = add(line, 'td', text, 'number');
    if (key) cell.dataset.key = key, cell.dataset.value = report[key];
  };
  row('Points', grouped(report.points), 'points');
  if (!data.estimate) row('Points fired', grouped(report.points_fired), 'points_fired');
  row('Shots', grouped(report.shots), 'shots');
  row('Beats', grouped(report.beats), 'beats');
  row(report.dry ? 'Beats before the motion' : 'Beats before the first shot', grouped(report.beats_before), 'beats_before');
  if (data.spacing_mm.values > 0) {
    row('Smallest distance of two points', `${short(data.spacing_mm.least)} mm`);
    row('Median distance', `${short(data.spacing_mm.median)} mm`);
  }
  if (!data.estimate) {
    row('Missed points', number_or(report.missed, grouped), 'missed');
    row('Doubled shots', number_or(report.doubled, grouped), 'doubled');
    row('Photosensors: made / not made / repeats', ['made', 'not_made', 'repeats'].map((k) => grouped(report.photosensors[k])).join(' / '));
    row('Link: resent / bad / reconnects', ['resent', 'bad', 'reconnects'].map((k) => grouped(report.link[k])).join(' / '));
  }
}

const reason_names = {
  fired: 'a shot', moving: 'moving', no_point_due: 'no point due', outside_tolerance: 'outside tolerance',
  no_edge: 'no flash', returning: 'moving back', not_locked: 'not locked', hold: 'held', pause: 'pause', door: 'door open',
  alarm: 'alarm', starved: 'waited for points', warm_up: 'warming up', protection: 'protection', dry: 'dry',
};

function fill_reasons() {
  const reasons = Object.entries(report.beats_by_reason).filter(([, beats]) => beats > 0);
  const all = reasons.reduce((sum, [, beats]) => sum + beats, 0);
  for (const [name, beats] of reasons.sort((a, b) => b[1] - a[1])) {
    const line = add($('reasons'), 'div', undefined, `reason ${name}`);
    add(line, 'span', reason_names[name] ?? name);
    add(line, 'i').style.width = `${(100 * beats) / all}%`;
    const value = add(line, 'span', `${grouped(beats)} \u00b7 ${fixed((100 * beats) / all, 1)} %`);
    value.dataset.reason = name;
    value.dataset.value = beats;
  }
  $('reasons-card').hidden = reasons.length === 0;
}

function fill_settings() {
  const body = $('settings').tBodies[0];
  for (const [number, name, unit, what] of data.settings_table) {
    const line = add(body, 'tr');
    add(line, 'td', `$${number}`);
    add(line, 'td', name);
    add(line, 'td', String(report.settings[name]), 'number').dataset.setting = name;
    add(line, 'td', unit);
    add(line, 'td', what);
  }
  $('settings-filter').addEventListener('input', (event) => {
    const wanted = event.target.value.toLowerCase();
    for (const line of body.rows) line.hidden = !line.textContent.toLowerCase().includes(wanted);
  });
}

// A card without a chart is left out, and its neighbour gets its place.
function show_cards() {
  const has = (histogram) => Boolean(histogram.counts) && histogram.values > 0;
  const pair = {'beats-card': has(data.beats), 'spacing-card': has(data.spacing_mm)};
  for (const [name, shown] of Object.entries(pair)) {
    $(name).hidden = !shown;
    $(name).classList.toggle('wide', Object.values(pair).includes(false));
  }
  $('use-card').hidden = data.utilisation.share.length === 0;
  $('unrecorded').hidden = data.cloud.beats_known;
  if (report.dry) $('unrecorded').textContent = 'A dry run fires no shots, so there are no charts of them.';
}

function draw_charts() {
  draw_utilisation($('use-chart'), data.utilisation, report.utilisation);
  draw_histogram($('beats-chart'), data.beats, {
    from: data.beats.counts && data.beats.counts[0] > 0 ? 0 : 1, trim: 6, each: true, open: (low) => `${low}+`, unit: 'beats', label: `Beats per point, median ${data.beats.median}`,
    bin_text: (low, bin, last) => `${low}${last ? ' or more' : ''} beats`,
  });
  draw_histogram($('spacing-chart'), data.spacing_mm, {
    open: (low) => `\u2265${short(low)}`, unit: 'mm', label: `Distance to the nearest neighbour, median ${short(data.spacing_mm.median)} mm`,
    bin_text: (low, bin, last) => (last ? `${short(low)} mm and more` : `${short(low)} to ${short(low + bin)} mm`),
  });
  if (data.spacing_mm.values > 0 && data.spacing_mm.values < report.points)
    $('spacing-note').textContent = `Distance to the nearest neighbour, of ${grouped(data.spacing_mm.values)} of the points.`;
}

// Colour modes and the meaning of their colours.
const modes = [
  {name: 'order', label: 'Order', on: () => true},
  {name: 'beats', label: 'Beats', on: () => data.cloud.beats_known},
  {name: 'missed', label: 'Missed', on: () => data.cloud.fates_known},
];

function legend_dot(colour, text) {
  const item = add($('legend'), 'span');
  add(item, 'i').style.background = colour;
  item.append(text);
}

function fill_legend(mode, theme, counts) {
  $('legend').replaceChildren();
  if (mode === 'order') {
    const ramp = add($('legend'), 'span', undefined, 'ramp');
    add(ramp, 'span', report.dry ? 'first' : 'fired first');
    add(ramp, 'b').style.background = `linear-gradient(90deg, ${order_ramps[theme].join(',')})`;
    add(ramp, 'span', 'last');
  } else if (mode === 'beats') {
    beat_names.forEach((name, i) => legend_dot(beat_colours[theme][i], `${name}: ${grouped(counts.beats[i])}`));
  } else {
    legend_dot(fate_colours[theme][0], `fired: ${grouped(report.points_fired)}`);
    legend_dot(fate_colours[theme][1], `missed: ${grouped(report.dry ? 0 : report.missed - data.cloud.not_reached)}`);
  }
  if (data.cloud.not_reached > 0) legend_dot(not_reached_colours[theme], `${report.dry ? 'dry run, not fired' : 'not reached'}: ${grouped(data.cloud.not_reached)}`);
  if (report.points_before > 0) legend_dot(before_colours[theme], `fired before this run: ${grouped(report.points_before)}`);
  if (data.cloud.stride > 1) add($('legend'), 'span', `shown: one point in ${data.cloud.stride}`);
}

// Number of points of each colour, from the histogram of all points.
function count_steps() {
  const beats = beat_limits.map(() => 0);
  (data.beats.counts ?? []).forEach((count, n) => {
    beats[beat_limits.findIndex((limit) => n <= limit)] += count;
  });
  if (report.points_fired > 0) ++beats[0];  // the first one
  return {beats};
}

class Theme {
  constructor(change) {
    this.system = matchMedia('(prefers-color-scheme: dark)');
    this.change = change;
    this.chosen = null;
    this.system.addEventListener('change', () => this.apply());
    $('theme').addEventListener('click', () => {
      this.chosen = this.name === 'dark' ? 'light' : 'dark';
      this.apply();
    });
    this.apply();
  }
  get name() {
    return this.chosen ?? (this.system.matches ? 'dark' : 'light');
  }
  apply() {
    document.documentElement.dataset.theme = this.name;
    this.change(this.name);
  }
}

// Pointer, wheel and keys on the canvas.
class Hands {
  constructor(view, on_user) {
    this.view = view;
    this.on_user = on_user;
    this.pointers = new Map();
    const canvas = view.canvas;
    const listen = (name, call) => canvas.addEventListener(name, (event) => call.call(this, event), {passive: false});
    listen('pointerdown', this.down);
    listen('pointermove', this.move);
    listen('pointerup', this.up);
    listen('pointercancel', this.up);
    listen('pointerleave', () => this.hide_tip());
    listen('wheel', this.wheel);
    listen('dblclick', () => this.reset());
    listen('keydown', this.key);
    $('reset').addEventListener('click', () => this.reset());
  }
  reset() {
    this.view.camera.reset();
    this.view.draw_soon();
  }
  down(event) {
    this.view.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, {x: event.offsetX, y: event.offsetY});
    this.still = true;
    this.on_user();
    this.hide_tip();
  }
  up(event) {
    if (this.still && event.type === 'pointerup' && event.pointerType === 'touch') this.show_tip(event.offsetX, event.offsetY);
    this.pointers.delete(event.pointerId);
  }
  move(event) {
    const last = this.pointers.get(event.pointerId);
    const now = {x: event.offsetX, y: event.offsetY};
    if (!last) return this.hover(now);
    const dx = now.x - last.x, dy = now.y - last.y;
    if (Math.abs(dx) + Math.abs(dy) > 2) this.still = false;
    if (this.pointers.size > 1)
      this.pinch(event.pointerId, last, now);
    else if (event.shiftKey || event.buttons === 4 || event.buttons === 2)
      this.pan(dx, dy);
    else
      this.view.camera.turn(0.008 * dx, 0.008 * dy);
    this.pointers.set(event.pointerId, now);
    this.view.draw_soon(true);
  }
  pan(dx, dy) {
    const {camera, canvas} = this.view;
    const mm = camera.mm_per_px(canvas.clientHeight, canvas.clientWidth);
    camera.pan_x += dx * mm;
    camera.pan_y -= dy * mm;
  }
  pinch(id, last, now) {
    const [, other] = [...this.pointers].find(([key]) => key !== id);
    const length = (p) => Math.hypot(p.x - other.x, p.y - other.y);
    if (length(last) > 0) this.view.camera.zoom_by(length(now) / length(last));
    this.pan((now.x - last.x) / 2, (now.y - last.y) / 2);
  }
  wheel(event) {
    event.preventDefault();
    this.on_user();
    this.view.camera.zoom_by(Math.exp(-0.0015 * event.deltaY));
    this.view.draw_soon(true);
  }
  key(event) {
    const step = 0.12, camera = this.view.camera;
    const does = {
      ArrowLeft: () => camera.turn(-step, 0), ArrowRight: () => camera.turn(step, 0),
      ArrowUp: () => camera.turn(0, -step), ArrowDown: () => camera.turn(0, step),
      '+': () => camera.zoom_by(1.2), '-': () => camera.zoom_by(1 / 1.2), 0: () => camera.reset(),
    }[event.key];
    if (!does) return;
    event.preventDefault();
    this.on_user();
    does();
    this.view.draw_soon(true);
  }
  hover(place) {
    this.place = place;
    if (this.looking) return;
    this.looking = true;
    requestAnimationFrame(() => {
      this.looking = false;
      if (this.place && !this.view.moving) this.show_tip(this.place.x, this.place.y);
    });
  }
  hide_tip() {
    this.place = null;
    $('tip').hidden = true;
  }
  show_tip(x, y) {
    const view = this.view, tip = $('tip');
    const i = view.pick(x, y);
    tip.hidden = i < 0;
    if (i < 0) return;
    tip.textContent = point_text(view, i);
    const stage = $('stage');
    tip.style.left = `${Math.max(4, Math.min(x + 16, stage.clientWidth - tip.offsetWidth - 4))}px`;
    tip.style.top = `${Math.max(4, Math.min(y + 16, stage.clientHeight - tip.offsetHeight - 4))}px`;
  }
}

// The number of a point of this run for --from: pauses are counted with the points.
function number_for_from(point) {
  let low = 0, high = data.pauses.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (data.pauses[middle] <= point) low = middle + 1;
    else high = middle;
  }
  return data.first + point + low;
}

// Text about a point.
function point_text(view, i) {
  const places = new Uint16Array(view.bytes.buffer, view.bytes.byteOffset + bytes_per_point * i, 3);
  const at = [...places].map((share, axis) => fixed(data.cloud.low_mm[axis] + (share / 65535) * data.cloud.size_mm[axis], 3));
  if (i < view.before) return ['fired before this run', `${at.join('  ')} mm`].join('\n');
  const stride = data.cloud.stride, point = (i - view.before) * stride, about = stride > 1 ? 'about ' : '';
  const lines = [`point ${about}${grouped(report.points_before + point)}`, `${at.join('  ')} mm`];
  if (report.points_before + point !== number_for_from(point)) lines.push(`${about}--from ${number_for_from(point)}`);
  const beats = view.bytes[bytes_per_point * i + 6], fate = view.bytes[bytes_per_point * i + 7];
  if (data.cloud.beats_known && beats > 0) lines.push(`${beats}${beats === 254 ? ' or more' : ''} ${beats === 1 ? 'beat' : 'beats'} from the point before`);
  if (fate) lines.push(fate === 1 ? 'missed' : report.dry ? 'not fired: dry run' : 'not reached before the job ended');
  return lines.join('\n');
}

// Sizes of the box, written at its edges.
class Dimensions {
  constructor(view) {
    this.view = view;
    this.labels = [0, 1, 2].map(() => add($('dimensions'), 'span'));
  }
  update() {
    const taken = [];
    this.labels.forEach((label, axis) => {
      label.textContent = `${'xyz'[axis]} ${short(this.view.size[axis])} mm`;
      let best = null;
      for (let k = 0; k < 4; ++k) {
        const at = [0, 0, 0];
        at[(axis + 1) % 3] = k & 1 ? 0.5 : -0.5;
        at[(axis + 2) % 3] = k & 2 ? 0.5 : -0.5;
        const place = this.view.project(...at);
        const rank = axis === 2 ? -place.x : place.y;
        if (!best || rank > best.rank) best = {...place, rank};
      }
      const {clientWidth: width, clientHeight: height} = this.view.canvas;
      // An object without extent has no edge for the label: it would be on a point.
      if ((label.hidden = this.view.size[axis] === 0)) return;
      label.hidden = best.x < 0 || best.y < 0 || best.x > width || best.y > height;
      if (label.hidden) return;
      const half = {x: label.offsetWidth / 2 + 2, y: label.offsetHeight / 2 + 1};
      // Away from the middle of the box, so that the label is beside its points.
      const middle = this.view.project(0, 0, 0), far = Math.hypot(best.x - middle.x, best.y - middle.y) || 1;
      const out = {x: (best.x - middle.x) / far, y: (best.y - middle.y) / far};
      const gap = 8 + Math.abs(out.x) * half.x + Math.abs(out.y) * half.y;
      best = {x: best.x + gap * out.x, y: best.y + gap * out.y};
      const x = Math.min(Math.max(best.x, half.x + 2), width - half.x - 2);
      const free = (y) => y > half.y && y < height - half.y && !taken.some((t) => Math.abs(t.x - x) < t.half.x + half.x && Math.abs(t.y - y) < t.half.y + half.y);
      const at = Math.min(best.y, height - 14);
      const y = [0, 1, -1, 2, -2, 3, -3].map((rows) => at + 2 * half.y * rows).find(free);
      // Three labels need at most three rows.
      label.hidden ||= y === undefined;
      if (label.hidden) return;
      taken.push({x, y, half});
      label.style.left = `${x}px`;
      label.style.top = `${y}px`;
    });
  }
}

// Automatic rotation, and the replay of the job.
class Motion {
  constructor(view) {
    this.view = view;
    this.turning = this.playing = false;
    $('turn').addEventListener('click', () => this.set_turning(!this.turning));
    $('play').addEventListener('click', () => this.set_playing(!this.playing));
    $('progress').addEventListener('input', () => {
      this.set_playing(false);
      this.show($('progress').value / 1000, true);
    });
    this.show(1);
    if (!matchMedia('(prefers-reduced-motion: reduce)').matches) this.set_turning(true);
  }
  set_turning(on) {
    this.turning = on;
    $('turn').setAttribute('aria-pressed', on);
    this.run();
  }
  set_playing(on) {
    if (on && this.share >= 1) this.share = 0;
    this.playing = on;
    $('play').setAttribute('aria-pressed', on);
    $('play').textContent = on ? 'Pause' : 'Play';
    this.run();
  }
  show(share, moving = false) {
    this.share = share;
    const view = this.view;
    view.shown = view.before + Math.round(share * (view.count - view.before));
    $('progress').value = 1000 * share;
    const beat = beat_at(share);
    const time = beat === null ? '' : `, ${time_text(beat * seconds_per_beat)}`;
    $('progress-text').textContent = `${grouped(Math.round(share * report.points))} of ${grouped(report.points)} points${time}`;
    view.draw_soon(moving);
  }
  // Requests frames while the picture changes.
  run() {
    if (this.running || !(this.turning || this.playing)) return;
    this.running = true;
    let last = null;
    const frame = (time) => {
      const passed = last === null ? 0 : Math.min((time - last) / 1000, 0.1);
      last = time;
      if (this.turning) this.view.camera.turn(0.25 * passed, 0);
      if (this.playing) this.show(Math.min(this.share + passed / 12, 1), true);
      if (this.playing && this.share >= 1) this.set_playing(false);
      this.running = this.turning || this.playing;
      this.view.draw_soon(this.running);
      if (this.running) requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }
}

// The cloud with its controls; both are hidden without WebGL 2.
function start_cloud() {
  const counts = count_steps();
  let mode = 'order', view = null;
  try {
    view = new CloudView($('canvas'), cloud_bytes(), data.cloud, data.spacing_mm.median);
  } catch {
    $('no-webgl').hidden = false;
    for (const part of ['canvas', 'controls', 'legend', 'modes']) $(part).hidden = true;
    return {view, paint: () => {}};
  }
  const paint = (theme) => {
    view.set_colours(mode, theme);
    fill_legend(mode, theme, counts);
  };
  for (const {name, label, on} of modes) {
    const holder = add($('modes'), 'label', label);
    const button = document.createElement('input');
    Object.assign(button, {type: 'radio', name: 'mode', value: name, checked: name === mode, disabled: !on()});
    if (!on()) holder.title = 'Unknown for this job';
    button.addEventListener('change', () => {
      mode = name;
      paint(document.documentElement.dataset.theme);
    });
    holder.prepend(button);
  }
  const motion = new Motion(view);
  new Hands(view, () => motion.set_turning(false));
  const dimensions = new Dimensions(view);
  view.after_draw = () => dimensions.update();
  return {view, motion, paint};
}

fill_head();
fill_warnings();
fill_tiles();
fill_making();
fill_numbers();
fill_reasons();
fill_settings();
arrange_tiles();
show_cards();
const cloud = start_cloud();
const theme = new Theme((name) => cloud.paint(name));
draw_charts();
let drawn_width = innerWidth;
addEventListener('resize', () => {
  if (innerWidth === drawn_width) return;
  drawn_width = innerWidth;
  arrange_tiles();
  draw_charts();
});
// For tests and for use in the browser's console.
window.lamplock = {data, cloud, theme};
