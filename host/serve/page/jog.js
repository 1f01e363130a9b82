// Jogs by buttons and keys, and to a place. A held button or key renews a lease of the server, and
// so does this page on the way to a place; every other event ends it: release, cancelled touch, lost
// focus, hidden tab. If this page fails, the lease ends.

const renew_ms = 70;
// A held key repeats. One that does not has been released, and its release was lost.
const first_repeat_ms = 1100, repeat_ms = 600;
// Until the server reports the motion to a place.
const begin_ms = 1000;
const keys = {
  ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowDown: [0, -1, 0], ArrowUp: [0, 1, 0],
  PageUp: [0, 0, 1], PageDown: [0, 0, -1],
};

export class Jogger {
  #link;
  #timer = 0;
  #button = null;
  #key = '';
  #key_until = 0;  // ms: the key is held that long without a repeat
  #goes_until = 0;  // ms: a motion to a place that has not begun; Infinity: it has begun

  constructor(link, element) {
    this.#link = link;
    for (const button of element('pad').querySelectorAll('button')) this.#watch(button);
    this.feed = element('feed');
    this.step = element('step');
    this.with_keys = element('keys');
    addEventListener('keydown', (event) => this.#press(event));
    addEventListener('keyup', (event) => event.code === this.#key && this.end());
    for (const name of ['blur', 'pagehide']) addEventListener(name, () => this.end());
    document.addEventListener('visibilitychange', () => document.hidden && this.end());
  }

  #watch(button) {
    const direction = button.dataset.jog.split(',').map(Number);
    button.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      event.preventDefault();
      button.setPointerCapture(event.pointerId);
      this.begin(direction, button);
    });
    for (const name of ['pointerup', 'pointercancel', 'lostpointercapture'])
      button.addEventListener(name, () => this.#button === button && this.end());
    button.addEventListener('contextmenu', (event) => event.preventDefault());
    // By keyboard a button moves one step; while held only with arrow keys.
    button.addEventListener('click', (event) => event.detail === 0 && this.#step(direction, 1));
  }

  #press(event) {
    const direction = keys[event.code];
    const types = /^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName) && event.target.type !== 'checkbox';
    if (!direction || !this.with_keys.checked || types) return;
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    if (event.repeat) {
      if (event.code === this.#key) this.#key_until = performance.now() + repeat_ms;
      return;
    }
    if (this.#key) return;
    this.begin(direction, null);
    if (!this.#timer) return;
    this.#key = event.code;
    this.#key_until = performance.now() + first_repeat_ms;
  }

  begin(direction, button) {
    this.end();
    if (Number(this.step.value) > 0) return this.#step(direction, Number(this.step.value));
    this.#button = button;
    button?.classList.add('moves');
    this.#renew(() => {
      if (this.#key && performance.now() > this.#key_until) return this.end();
      this.#link.send('jog.run', { direction, feed: Number(this.feed.value), seen: this.#link.time });
    });
  }

  #renew(ask) {
    const renew = () => this.#link.is_up ? ask() : this.end();
    this.#timer = setInterval(renew, renew_ms);
    renew();
  }

  // To a place {x, y, z}; an axis without a number stays.
  async go(place) {
    this.end();
    const feed = Number(this.feed.value);
    if (!await this.#link.call('jog.go', { ...place, feed, seen: this.#link.time }).then(() => true, () => false)) return;
    this.end();  // of what has begun meanwhile
    this.#goes_until = performance.now() + begin_ms;
    this.#renew(() => {
      if (performance.now() > this.#goes_until) return this.end();
      this.#link.send('jog.renew', { seen: this.#link.time });
    });
  }

  // With each status: ends the renewals at the place.
  follow({ jogs }) {
    if (!this.#goes_until) return;
    if (jogs) this.#goes_until = Infinity;
    else if (this.#goes_until === Infinity) this.end();
  }

  #step(direction, mm) {
    const axis = direction.findIndex((sign) => sign !== 0);
    const length = Number(this.step.value) || mm;
    this.#link.send('jog.step', { axis, mm: direction[axis] * length, feed: Number(this.feed.value) });
  }

  end() {
    if (!this.#timer) return;
    clearInterval(this.#timer);
    this.#timer = 0;
    this.#key = '';
    this.#goes_until = 0;
    this.#button?.classList.remove('moves');
    this.#button = null;
    if (this.#link.is_up) this.#link.send('jog.stop');
  }
}
