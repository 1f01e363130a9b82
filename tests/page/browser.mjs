// A headless Chromium, controlled by its own protocol through two pipes, without other packages.
//
// In:  the program, a folder for its profile. Out: pages that can be inspected and clicked.
// Who: the tests of the page of a job. The protocol: https://chromedevtools.github.io/devtools-protocol

import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const answer_ms = 120_000;

const flags = [
  '--headless', '--no-sandbox', '--no-first-run', '--disable-quic', '--disable-background-networking',
  '--disable-component-update', '--disable-sync', '--disable-default-apps', '--disable-extensions',
  '--hide-scrollbars', '--remote-debugging-pipe', '--disable-dev-shm-usage',
];
// WebGL by the processor, or none at all.
const software_webgl = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'];
const no_webgl = ['--disable-gpu', '--disable-3d-apis'];

export class Browser {
  #child;
  #profile = mkdtempSync(join(tmpdir(), 'lamplock-page-'));
  #next = 1;
  #waiting = new Map();
  #listeners = [];
  #text = '';

  constructor(program, { webgl = true } = {}) {
    this.#child = spawn(program, [...flags, ...(webgl ? software_webgl : no_webgl), `--user-data-dir=${this.#profile}`],
                        { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'], detached: true });
    this.#child.stdio[4].setEncoding('utf8');
    this.#child.stdio[4].on('data', (text) => this.#receive(text));
    this.#child.stdio[3].on('error', () => {});
    this.#child.on('exit', (code) => {
      for (const { reject } of this.#waiting.values()) reject(new Error(`the browser has ended (${code})`));
    });
  }

  // Messages end with a zero byte.
  #receive(text) {
    const parts = (this.#text + text).split('\0');
    this.#text = parts.pop();
    for (const part of parts) {
      const message = JSON.parse(part);
      const waiting = this.#waiting.get(message.id);
      if (waiting === undefined) {
        for (const listener of this.#listeners) listener(message);
        continue;
      }
      this.#waiting.delete(message.id);
      clearTimeout(waiting.timer);
      if (message.error) waiting.reject(new Error(message.error.message));
      else waiting.resolve(message.result);
    }
  }

  send(method, params = {}, sessionId = undefined) {
    const id = this.#next++;
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => reject(new Error(`${method}: no answer`)), answer_ms);
      this.#waiting.set(id, { resolve, reject, timer });
      this.#child.stdio[3].write(JSON.stringify({ id, method, params, sessionId }) + '\0');
    });
  }

  listen(listener) {
    this.#listeners.push(listener);
  }

  async open(url, options = {}) {
    const { targetId } = await this.send('Target.createTarget', { url: 'about:blank' });
    const { sessionId } = await this.send('Target.attachToTarget', { targetId, flatten: true });
    const page = new Page(this, sessionId);
    await page.start(url, options);
    return page;
  }

  // A signal to the processes of the browser, which are a group of their own.
  signal(name) {
    process.kill(-this.#child.pid, name);
  }

  async kill() {
    const ended = new Promise((resolve) => this.#child.on('exit', resolve));
    if (this.#child.signalCode === null) {
      this.signal('SIGKILL');
      await ended;
    }
    rmSync(this.#profile, { recursive: true, force: true, maxRetries: 5, retryDelay: 100 });
  }

  async close() {
    const ended = new Promise((resolve) => this.#child.on('exit', resolve));
    this.send('Browser.close').catch(() => {});
    const timer = setTimeout(() => this.#child.kill('SIGKILL'), 5000);
    await ended;
    clearTimeout(timer);
    rmSync(this.#profile, { recursive: true, force: true, maxRetries: 5, retryDelay: 100 });
  }
}

// One page: `complaints` has its console messages, `requests` its requests.
export class Page {
  complaints = [];
  requests = [];
  #browser;
  #session;

  constructor(browser, session) {
    this.#browser = browser;
    this.#session = session;
    browser.listen((message) => message.sessionId === session && this.#hear(message));
  }

  #hear({ method, params }) {
    if (method === 'Network.requestWillBeSent') this.requests.push(params.request.url);
    if (method === 'Runtime.exceptionThrown')
      this.complaints.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
    if (method === 'Runtime.consoleAPICalled' && ['error', 'warning', 'assert'].includes(params.type))
      this.complaints.push(params.args.map((arg) => arg.value ?? arg.description).join(' '));
    // Chromium warns that WebGL runs on the processor, and how fast.
    if (method === 'Log.entryAdded' && ['error', 'warning'].includes(params.entry.level) &&
        !/swiftshader|GPU stall|GL Driver Message/i.test(params.entry.text))
      this.complaints.push(params.entry.text);
    if (method === 'Page.loadEventFired') this.loaded?.();
  }

  send(method, params) {
    return this.#browser.send(method, params, this.#session);
  }

  async start(url, { width = 1280, height = 900, scale = 1, dark = false, touch = false, still = true, before = '' }) {
    for (const domain of ['Page', 'Runtime', 'Network', 'Log']) await this.send(`${domain}.enable`);
    await this.send('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: scale, mobile: touch });
    if (touch) await this.send('Emulation.setTouchEmulationEnabled', { enabled: true });
    await this.send('Emulation.setEmulatedMedia', {
      features: [
        { name: 'prefers-color-scheme', value: dark ? 'dark' : 'light' },
        { name: 'prefers-reduced-motion', value: still ? 'reduce' : 'no-preference' },
      ],
    });
    if (before !== '') await this.send('Page.addScriptToEvaluateOnNewDocument', { source: before });
    const loaded = new Promise((resolve) => { this.loaded = resolve; });
    await this.send('Page.navigate', { url });
    await loaded;
    await this.frames(3);
  }

  // The value of an expression, also of a promise.
  async ask(expression) {
    const { result, exceptionDetails } = await this.send('Runtime.evaluate', { expression, returnByValue: true, awaitPromise: true });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  }

  // Waits until this many frames have been drawn.
  frames(count) {
    return this.ask(`new Promise((done) => {
      let left = ${count};
      const frame = () => (--left < 0 ? done(true) : requestAnimationFrame(frame));
      frame();
    })`);
  }

  // Middle of an element in the window.
  place(selector) {
    return this.ask(`(() => {
      const element = document.querySelector(${JSON.stringify(selector)});
      element.scrollIntoView({block: 'center', behavior: 'instant'});
      const box = element.getBoundingClientRect();
      return {x: box.x + box.width / 2, y: box.y + box.height / 2};
    })()`);
  }

  mouse(type, x, y, more = {}) {
    return this.send('Input.dispatchMouseEvent', { type, x, y, ...more });
  }

  // A page whose lists grow moves its buttons: the place must be the same after two frames.
  async click(selector) {
    let { x, y } = await this.place(selector);
    for (let before; before?.x !== x || before?.y !== y;) {
      before = { x, y };
      await this.ask('new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))');
      ({ x, y } = await this.place(selector));
    }
    await this.mouse('mousePressed', x, y, { button: 'left', clickCount: 1 });
    await this.mouse('mouseReleased', x, y, { button: 'left', clickCount: 1 });
  }

  async drag(from, to) {
    await this.mouse('mousePressed', from.x, from.y, { button: 'left', buttons: 1, clickCount: 1 });
    for (let i = 1; i <= 5; ++i)
      await this.mouse('mouseMoved', from.x + ((to.x - from.x) * i) / 5, from.y + ((to.y - from.y) * i) / 5, { button: 'left', buttons: 1 });
    await this.mouse('mouseReleased', to.x, to.y, { button: 'left', clickCount: 1 });
  }

  // PNG of the window, or of the whole page.
  async picture(whole = false) {
    const { data } = await this.send('Page.captureScreenshot', { format: 'png', captureBeyondViewport: whole });
    return Buffer.from(data, 'base64');
  }
}
