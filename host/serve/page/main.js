// The page of a machine. It shows the status of the server and asks for actions; it keeps no state
// of the machine.

import { Camera } from '/camera.js';
import { CloudView } from '/cloud.js';
import { Jobs } from '/job.js';
import { Jogger } from '/jog.js';
import { Link, keep_token, merge, take_token } from '/link.js';
import { Placer } from '/place.js';
import { Records } from '/records.js';
import { text, word } from '/texts.js';

const element = (id) => document.getElementById(id);
const max_lines = 500;
let status = {};

function show_problem(problem) {
  element('problem').textContent = problem;
  element('problem').hidden = problem === '';
}

// "Hold:0": its name and its part.
function state_text(state) {
  const [name, ...part] = state.split(':');
  return [word('board-state', name), ...part].join(':');
}

function show() {
  const { board = {}, job = {}, control = {} } = status;
  element('state').textContent = board.connected ? state_text(board.state) || text('state.connected') : text('state.no-board');
  if (!board.connected && board.problem) show_problem(board.problem);
  element('position').tBodies[0].replaceChildren(...(board.machine ?? []).map((mm, axis) => {
    const row = document.createElement('tr');
    const work = board.work?.[axis] ?? mm;
    for (const content of ['XYZA'[axis], mm.toFixed(3), work.toFixed(3)])
      row.insertCell().textContent = content;
    return row;
  }));
  const holder = control.own ? text('control.own') : control.held ? text('control.other', control) : text('control.watching');
  element('control-text').textContent = text('control.clients', { holder, clients: control.clients ?? 0 });
  element('control').textContent = text(control.own ? 'control.release' : 'control.take');
  element('pairing').hidden = control.paired !== false;
  for (const each of document.querySelectorAll('.needs-control')) each.disabled = !control.own;
  element('write').disabled = !control.own || changes().length === 0;
  element('start').disabled = !control.own || job.running;
  jobs.show(job);
  cloud.follow(status, jobs.name);
  jogger.follow(board);
  records.follow(job);
}

const link = new Link(take_token(), {
  up(login, whole) {
    status = whole;
    show_problem('');
    element('login').hidden = true;
    element('board').textContent = login.simulated ? text('board.simulated', login) : login.board;
    element('lines').textContent = '';  // the server sends them again
    if (!whole.control.held) link.send('control.take');
    jobs.list();
    records.list_macros();
    camera.begin().catch(() => {});
    show();
  },
  down(problem) {
    jogger.end();
    status = {};
    show();
    show_problem(problem);
  },
  password() {
    element('login').hidden = false;
    element('password').focus();
  },
  failed: show_problem,
  status(patch) {
    status = merge(status, patch);
    show();
  },
  console(lines) {
    const box = element('lines');
    const is_at_end = box.scrollTop + box.clientHeight >= box.scrollHeight - 4;
    const shown = box.textContent.split('\n').filter(Boolean).concat(lines.map((line) => line.text));
    box.textContent = shown.slice(-max_lines).join('\n');
    if (is_at_end) box.scrollTop = box.scrollHeight;
  },
});
const cloud = new CloudView(link, element, (place) => jogger.go(place));
const camera = new Camera(link, element, cloud, () => status.board?.machine);
const jogger = new Jogger(link, element);
const jobs = new Jobs(link, element, cloud, show_problem);
const records = new Records(link, element);

// After a job was made, it is checked; after a description was written, it is listed.
new Placer(link, element, cloud, show_problem, async (name) => {
  await jobs.list(name);
  if (name) await jobs.check();
});

element('stop').addEventListener('click', () => {
  jogger.end();
  link.send('machine.stop');
});
addEventListener('keydown', (event) => event.key === 'Escape' && element('stop').click());
for (const name of ['hold', 'resume', 'home', 'unlock'])
  element(name).addEventListener('click', () => link.send(`machine.${name}`));
for (const button of document.querySelectorAll('[data-zero]'))
  button.addEventListener('click', () => link.send('machine.zero', { axes: button.dataset.zero }));
element('control').addEventListener('click', () => {
  show_problem('');
  link.send(status.control?.own ? 'control.release' : 'control.take');
});
for (const button of document.querySelectorAll('[data-feed]'))
  button.addEventListener('click', () => link.send('machine.feed', { change: button.dataset.feed }));
element('login').addEventListener('submit', async (event) => {
  event.preventDefault();
  const reply = await fetch('/login', {
    method: 'POST', headers: { 'Content-Type': 'application/json' },
    body: JSON.stringify({ password: element('password').value }),
  }).catch((error) => ({ ok: false, text: () => error.message }));
  element('password').value = '';
  const refused = { 401: 'login.wrong', 429: 'login.many', 503: 'login.busy' }[reply.status];
  if (!reply.ok) return show_problem(refused ? text(refused) : await reply.text());
  const { token } = await reply.json();
  keep_token(token);
  link.use(token);
});
element('pairing').addEventListener('submit', async (event) => {
  event.preventDefault();
  await link.call('pair', { code: element('code').value }).catch(() => {});
  element('code').value = '';
});
element('console').addEventListener('submit', (event) => {
  event.preventDefault();
  if (element('line').value.trim() !== '') link.send('console.send', { line: element('line').value });
  element('line').value = '';
});

// Settings: read, changed here, written together.

function changes() {
  return [...element('settings').querySelectorAll('input')].filter((input) => input.value !== input.defaultValue);
}

function show_changes() {
  for (const input of element('settings').querySelectorAll('input'))
    input.closest('tr').classList.toggle('changed', input.value !== input.defaultValue);
  element('changes').textContent =
    changes().map(({ name, defaultValue, value }) => text('settings.change', { name, from: defaultValue, to: value })).join('; ');
  element('write').disabled = !status.control?.own || changes().length === 0;
}

function setting_row(setting) {
  const row = document.createElement('tr');
  const [name, value] = [row.insertCell(), row.insertCell()];
  const label = document.createElement('label'), about = document.createElement('small');
  const input = document.createElement('input');
  input.id = input.name = setting.name;
  input.type = 'number';
  input.step = setting.whole ? 1 : 0.001;
  [input.min, input.max] = [setting.min, setting.max];
  input.defaultValue = setting.value;
  label.htmlFor = setting.name;
  label.textContent = `$${setting.number} ${setting.name}`;
  about.textContent = text('settings.about', { ...setting, about: word('setting', setting.name, setting.about) });
  name.append(label, about);
  value.append(input, ` ${setting.unit}`);
  return row;
}

function search() {
  const wanted = element('search').value.toLowerCase();
  for (const row of element('settings').querySelectorAll('tr'))
    row.hidden = !row.textContent.toLowerCase().includes(wanted);
}

async function read_settings() {
  const table = document.createElement('table');
  table.append(...(await link.call('settings.get')).map(setting_row));
  element('settings').replaceChildren(table);
  search();
  show_changes();
}

element('read').addEventListener('click', () => read_settings().catch(() => {}));
element('search').addEventListener('input', search);
element('settings').addEventListener('input', show_changes);
element('write').addEventListener('click', async () => {
  const wanted = changes();
  const wrong = wanted.find((input) => !input.checkValidity() || input.value === '');
  if (wrong) return show_problem(`${wrong.name}: ${wrong.validationMessage || text('settings.no-value')}`);
  const values = Object.fromEntries(wanted.map((input) => [input.name, input.value]));
  await link.call('settings.set', { changes: values }).then(read_settings).catch(() => {});
});
