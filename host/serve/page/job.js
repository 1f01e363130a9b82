// Files of the server: send, check, start, progress.

import { needs_material } from '/link.js';
import { error_text, text, word } from '/texts.js';

const clock = (seconds) => {
  const s = Math.round(seconds);
  return s < 60 ? text('time.s', { s }) : text('time.min-s', { min: Math.floor(s / 60), s: String(s % 60).padStart(2, '0') });
};

// "feed 110 %"; a kind of speed that the table does not have stays as the server sent it.
const speed_text = (speed) => {
  const [, what, percent] = /^(\w+) (\d+) %$/.exec(speed) ?? [];
  return percent ? word('job-speed', what, speed).replace('{percent}', percent) : speed;
};

const is_job = (name) => /\.llj$/i.test(name);

export class Jobs {
  #link;
  #element;
  #cloud;
  #picture = '';
  #settings = [];  // of the material library
  #checked = {};   // name and revision of the file whose check is shown
  #checks = 0;     // the latest check; answers to earlier ones are dropped

  constructor(link, element, cloud, show_problem) {
    this.#link = link;
    this.#cloud = cloud;
    this.#element = element;
    this.show_problem = show_problem;
    const drop = element('drop');
    element('file').addEventListener('change', ({ target }) => this.#send([...target.files]));
    for (const name of ['dragover', 'dragleave', 'drop'])
      drop.addEventListener(name, (event) => {
        event.preventDefault();
        drop.classList.toggle('over', name === 'dragover');
        if (name === 'drop') this.#send([...event.dataTransfer.files]);
      });
    element('check').addEventListener('click', () => this.check());
    element('start').addEventListener('click', () => this.#start());
    element('delete').addEventListener('click', () => this.#delete());
    element('jobs').addEventListener('change', () => this.#change_file());
    element('material').addEventListener('change', () => {
      element('thickness').value = this.#setting?.thickness ?? '';
      this.check();
    });
    element('thickness').addEventListener('change', () => this.check());
  }

  get name() { return this.#element('jobs').value; }
  get #setting() { return this.#settings[this.#element('material').value]; }
  // Parameters of job.check and job.start: the file and, for a program with process parameters, the
  // chosen material.
  get #file() {
    const { material, laser, operation } = this.#setting ?? {};
    if (this.#element('material-choice').hidden || !material) return { name: this.name };
    const { value } = this.#element('thickness');
    return { name: this.name, material, laser, operation, ...(value !== '' && { thickness: Number(value) }) };
  }

  // Files that a machine can run, and those of which the page makes jobs.
  async list(chosen = this.name) {
    const files = await this.#link.call('job.list');
    const before = this.name;
    const fill = (id, runs, value) => this.#element(id).replaceChildren(...files
      .filter(({ kind }) => runs === ['job', 'program'].includes(kind))
      .map(({ name }) => new Option(name, name, false, name === value)));
    fill('jobs', true, chosen);
    if (this.name !== before) this.#change_file();  // the browser sends no event
    if (files.some(({ kind }) => kind === 'job')) this.#cloud.prepare();
    fill('models', false, files.some(({ name }) => name === chosen) ? chosen : this.#element('models').value);
  }

  async #send(files) {
    for (const file of files) {
      const reply = await fetch(`/files/${encodeURIComponent(file.name)}`, {
        method: 'POST', body: file,
        headers: { 'Authorization': `Bearer ${this.#link.token}`, 'Content-Type': 'application/octet-stream' },
      }).catch((error) => ({ ok: false, text: () => error.message }));
      if (!reply.ok) {
        this.show_problem(reply.status === 422 ? error_text(await reply.json()) : `${file.name}: ${await reply.text()}`);
        continue;
      }
      await this.list(file.name);
      this.#change_file();  // also a new version of the same file
      if (this.name === file.name) await this.check();
    }
    this.#element('file').value = '';
  }

  #show_nothing() {
    this.#checked = {};
    this.#element('checked').textContent = '';
    this.#element('problems').replaceChildren();
    this.#element('picture').hidden = true;
    this.#cloud.close();
  }

  #change_file() {
    ++this.#checks;
    this.#show_nothing();
    this.#element('material-choice').hidden = true;
    this.#element('material').replaceChildren();
  }

  // Fills the list of materials: the program reads process parameters.
  async #offer_materials(check) {
    const box = this.#element('material');
    if (!this.#element('material-choice').hidden && this.#settings.length > 0) return;
    const settings = await this.#link.call('material.list').catch(() => []);
    if (check !== this.#checks) return;
    this.#settings = settings;
    if (settings.length === 0) this.show_problem(text('job.no-materials'));
    const name = (each) =>
      text(each.thickness === null ? 'job.setting' : 'job.setting-of', { ...each, operation: word('operation', each.operation) });
    box.replaceChildren(new Option(text('job.choose-material'), ''), ...this.#settings.map((each, i) => new Option(name(each), i)));
    this.#element('thickness').value = '';
    this.#element('material-choice').hidden = false;
  }

  async check() {
    if (!this.name || !this.#element('thickness').reportValidity()) return;
    const own = ++this.#checks;
    this.#show_nothing();
    this.show_problem('');
    this.#element('checked').textContent = text('job.checking');
    this.#cloud.open(this.#file, is_job(this.name)).catch(() => {});
    const result = await this.#link.call('job.check', this.#file).catch(async ({ code }) => {
      if (code === needs_material && own === this.#checks) await this.#offer_materials(own);
    });
    if (own !== this.#checks) return;
    if (!result) return this.#show_nothing();
    if (result.material !== undefined) await this.#offer_materials(own);
    if (own !== this.#checks) return;
    this.#checked = { name: this.name, revision: result.revision };
    const facts = [result.points ? text('job.points', result) : text('job.lines', result)];
    if (result.seconds !== undefined) facts.push(clock(result.seconds));
    if (result.bounds) {
      const [low, high] = result.bounds;
      const ranges = low.map((mm, i) => text('job.range', { axis: 'XYZA'[i], low: mm.toFixed(1), high: high[i].toFixed(1) }));
      const lengths = result.rotary ? 3 : ranges.length;
      facts.push(text('job.ranges', { ranges: ranges.slice(0, lengths).join(', ') }));
      if (ranges.length > lengths) facts.push(text('job.turns', { range: ranges[lengths] }));
    }
    if (result.material) facts.push(text('job.values', result.material));
    this.#element('checked').textContent = facts.join('; ');
    this.#element('problems').replaceChildren(...result.problems.map((problem) => {
      const item = document.createElement('li');
      item.textContent = text('job.problem', problem);
      return item;
    }));
    if (!result.picture || result.points) return;
    URL.revokeObjectURL(this.#picture);
    this.#picture = URL.createObjectURL(new Blob([result.picture], { type: 'image/svg+xml' }));
    this.#element('picture').src = this.#picture;
    this.#element('picture').hidden = false;
  }

  #start() {
    if (!this.name) return this.show_problem(text('job.no-file'));
    this.#link.send('job.start', {
      ...this.#file, dry: this.#element('dry').checked, resume: this.#element('continue').checked,
      from: Number(this.#element('from').value),
      // What was shown is what runs: the server refuses a file that was replaced since.
      ...(this.#checked.name === this.name ? { revision: this.#checked.revision } : {}),
    });
  }

  async #delete() {
    if (!this.name) return;
    await this.#link.call('job.delete', { name: this.name });
    await this.list('');
  }

  show(job) {
    const bar = this.#element('progress');
    bar.value = job.total ? job.done / job.total : 0;
    const parts = [job.name];
    if (job.running) {
      parts.push(word('job-title', job.title) || text('job.preparing'), text('job.done', job));
      if (job.dry) parts.push(text('job.is-dry'));
      if (job.word) parts.push(word('job-word', job.word));
      if (job.speed) parts.push(speed_text(job.speed));
      if (job.left_s !== undefined) parts.push(text('job.left', { time: clock(job.left_s) }));
    } else if (job.end) {
      parts.push(word('job-end', job.end), job.message);
    }
    this.#element('job-text').textContent = parts.filter(Boolean).join(' · ');
  }
}
