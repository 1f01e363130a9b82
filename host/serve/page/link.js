// The connection to the server: requests with answers, notifications, and a new connection after a
// loss. Nothing that was asked for before a loss is asked for again.

import { error_text, text } from '/texts.js';

const answer_ms = 15_000, retry_ms = 1000;
const needs_password = -32001;  // docs/api.md
export const needs_material = -32002;

function random_text() {
  return [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, '0')).join('');
}

// The token comes in the address, which is not sent to any server, and is kept for this tab alone.
export function take_token() {
  const given = new URLSearchParams(location.hash.slice(1)).get('token');
  if (given) {
    sessionStorage.setItem('token', given);
    history.replaceState(null, '', location.pathname);
  }
  return sessionStorage.getItem('token') ?? '';
}

export function keep_token(token) {
  sessionStorage.setItem('token', token);
}

// Of this page until it is closed: a reloaded or duplicated page is another client.
const client = random_text();

export class Link {
  time = 0;  // of the server, from its last notification
  #token;
  #socket = null;
  #waiting = new Map();
  #next = 1;
  #frame = null;
  #session = random_text().slice(0, 8);
  #on;

  // `on` has the functions status(patch), console(lines), up(result), down(text), password().
  constructor(token, on) {
    this.#token = token;
    this.#on = on;
    this.#connect();
  }

  // Another token, after a login.
  use(token) {
    this.#token = token;
    this.#connect();
  }

  get token() { return this.#token; }
  get is_up() { return this.#socket?.readyState === WebSocket.OPEN; }

  #connect() {
    const socket = new WebSocket(`${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/ws`);
    socket.binaryType = 'arraybuffer';
    let is_up = false, refusal = '';
    socket.onopen = async () => {
      this.#socket = socket;
      try {
        const is_phone = /Mobi/.test(navigator.userAgent);
        const name = text(is_phone ? 'client.phone' : 'client.page');
        const login = await this.#ask('login', { token: this.#token || 'none', client, name });
        const status = await this.#ask('subscribe');
        is_up = true;
        this.#on.up(login, status);
      } catch (error) {
        refusal = error.message;
        if (error.code === needs_password) this.#on.password();
        socket.close();
      }
    };
    socket.onmessage = ({ data }) => data instanceof ArrayBuffer ? this.#keep(data) : this.#take(JSON.parse(data));
    socket.onclose = () => {
      this.#socket = null;
      for (const { reject } of this.#waiting.values()) reject(new Error(text('link.none')));
      this.#waiting.clear();
      this.#on.down(refusal || text('link.again'));
      if (is_up || !refusal) setTimeout(() => this.#connect(), retry_ms);
    };
  }

  #take(message) {
    if (message.method === 'status') {
      this.time = message.params.time;
      return this.#on.status(message.params.patch);
    }
    if (message.method === 'console') return this.#on.console(message.params.lines);
    const waiting = this.#waiting.get(message.id);
    if (!waiting) return;
    this.#waiting.delete(message.id);
    clearTimeout(waiting.timer);
    if (message.error) waiting.reject(Object.assign(new Error(error_text(message.error)), { code: message.error.code }));
    else waiting.resolve(message.result);
  }

  // A message of cloud.points comes before the result.
  #keep(data) {
    const [cloud, from] = new Uint32Array(data, 0, 2);
    this.#frame = { cloud, from, numbers: new Uint16Array(data, 8) };
  }

  // The points of cloud.points, whose result has come.
  take_frame(cloud, from) {
    const frame = this.#frame;
    this.#frame = null;
    return frame?.cloud === cloud && frame.from === from ? frame.numbers : null;
  }

  #ask(method, params = {}) {
    const id = `${this.#session}-${this.#next++}`;
    return new Promise((resolve, reject) => {
      if (!this.is_up) return reject(new Error(text('link.none')));
      const timer = setTimeout(() => {
        this.#waiting.delete(id);
        reject(new Error(text('link.no-answer', { method })));
      }, answer_ms);
      this.#waiting.set(id, { resolve, reject, timer });
      this.#socket.send(JSON.stringify({ jsonrpc: '2.0', id, method, params }));
    });
  }

  // The result of a method; an error goes to on.failed too.
  async call(method, params) {
    try {
      return await this.#ask(method, params);
    } catch (error) {
      this.#on.failed(error.message);
      throw error;
    }
  }

  // A request whose answer does not matter.
  send(method, params) {
    this.#ask(method, params).catch((error) => this.#on.failed(error.message));
  }
}

// RFC 7396.
export function merge(target, patch) {
  for (const [name, value] of Object.entries(patch)) {
    if (value === null) delete target[name];
    else if (typeof value === 'object' && !Array.isArray(value)) target[name] = merge({ ...target[name] }, value);
    else target[name] = value;
  }
  return target;
}
