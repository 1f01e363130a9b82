// Lists of the server: macros of the console, history of jobs, settings of materials.

import { text, word } from '/texts.js';

const seconds_between = (begin, end) => Math.round((Date.parse(end) - Date.parse(begin)) / 1000);

function row_of(contents) {
  const row = document.createElement('tr');
  for (const content of contents) row.insertCell().append(content ?? '');
  return row;
}

// Of a job of points; the address has a secret name, so that no token is needed.
function report_of(job) {
  if (!job.report) return null;
  const link = document.createElement('a');
  [link.href, link.target, link.rel] = [`/reports/${job.report}`, '_blank', 'noopener'];
  link.textContent = text('history.open');
  link.setAttribute('aria-label', text('history.report-of', job));
  return link;
}

export class Records {
  #link;
  #element;
  #macros = {};
  #has_run = false;
  #history_shown = false;

  constructor(link, element) {
    this.#link = link;
    this.#element = element;
    element('history-read').addEventListener('click', () => this.#show_history());
    element('materials-read').addEventListener('click', () => this.#show_materials());
    element('macro-save').addEventListener('click', () => this.#save());
    element('macro-remove').addEventListener('click', () => this.#change('macro.remove', { name: element('macro-name').value }));
    element('macro-name').addEventListener('input', ({ target }) => {
      if (target.value in this.#macros) element('macro-lines').value = this.#macros[target.value];
    });
  }

  #save() {
    const [name, lines] = ['macro-name', 'macro-lines'].map((id) => this.#element(id).value);
    if (name && lines) return this.#change('macro.set', { name, lines });
  }

  #change(method, parameters) {
    return this.#link.call(method, parameters).then(() => this.list_macros()).catch(() => {});
  }

  // One button for each macro; its lines are sent together.
  async list_macros() {
    this.#macros = await this.#link.call('macro.list').catch(() => ({}));
    this.#element('macros').replaceChildren(...Object.keys(this.#macros).map((name) => {
      const button = document.createElement('button');
      button.type = 'button';
      button.textContent = name;
      button.className = 'needs-control';
      button.disabled = this.#element('macro-save').disabled;
      button.addEventListener('click', () => this.#link.send('macro.run', { name }));
      return button;
    }));
    this.#element('macro-names').replaceChildren(...Object.keys(this.#macros).map((name) => new Option(name)));
  }

  // A job that ends is a new line of the history. The server writes it a moment later.
  follow({ running = false }) {
    if (this.#has_run && !running && this.#history_shown) setTimeout(() => this.#show_history(), 500);
    this.#has_run = running;
  }

  #fill(id, rows, nothing) {
    const table = this.#element(id);
    table.hidden = rows.length === 0;
    table.tBodies[0].replaceChildren(...rows.map(row_of));
    this.#element(`${id}-text`).textContent = rows.length === 0 ? nothing : '';
  }

  async #show_history() {
    const jobs = await this.#link.call('history.list').catch(() => null);
    if (!jobs) return;
    this.#history_shown = true;
    this.#fill('history', jobs.map((job) => [
      new Date(job.begin).toLocaleString(), job.dry ? text('history.dry', job) : job.file, job.board,
      text('time.s', { s: seconds_between(job.begin, job.end) }), [word('job-end', job.result), job.message].filter(Boolean).join(': '),
      text(job.item === 'point' ? 'history.points' : 'history.lines', job), job.wasted_beats, report_of(job)]), text('history.none'));
  }

  async #show_materials() {
    const settings = await this.#link.call('material.list').catch(() => null);
    if (!settings) return;
    this.#fill('materials', settings.map((each) => [
      each.material, each.laser, word('operation', each.operation), each.thickness, each.feed, each.power, each.passes, each.kerf, each.note]),
               text('materials.none'));
  }
}
