// Jogs by buttons and keys. A held button or key renews a lease of the server; every other event
// ends it: release, cancelled touch, lost focus, hidden tab. If this page fails, the lease ends.

const renew_ms = 70;
const keys = {
  ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowDown: [0, -1, 0], ArrowUp: [0, 1, 0],
  PageUp: [0, 0, 1], PageDown: [0, 0, -1],
};

export class Jogger {
  #link;
  #timer = 0;
  #button = null;
  #key = '';

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
    if (event.repeat || this.#key) return;
    this.begin(direction, null);
    if (this.#timer) this.#key = event.code;
  }

  begin(direction, button) {
    this.end();
    if (Number(this.step.value) > 0) return this.#step(direction, Number(this.step.value));
    this.#button = button;
    button?.classList.add('moves');
    const renew = () => this.#link.is_up
      ? this.#link.tell('jog.run', { direction, feed: Number(this.feed.value), seen: this.#link.time }) : this.end();
    this.#timer = setInterval(renew, renew_ms);
    renew();
  }

  #step(direction, mm) {
    const axis = direction.findIndex((sign) => sign !== 0);
    const length = Number(this.step.value) || mm;
    this.#link.tell('jog.step', { axis, mm: direction[axis] * length, feed: Number(this.feed.value) });
  }

  end() {
    if (!this.#timer) return;
    clearInterval(this.#timer);
    this.#timer = 0;
    this.#key = '';
    this.#button?.classList.remove('moves');
    this.#button = null;
    if (this.#link.is_up) this.#link.tell('jog.stop');
  }
}
