// The time that is shown, and its passing.

export class Clock {
  #listeners = new Set();
  #last = 0;

  constructor(span) {
    this.span = span;
    this.time = span ? span.to : 0;
    this.playing = false;
    // The whole walk takes about half a minute.
    this.speed = span ? niceSpeed((span.to - span.from) / 30) : 1;
  }

  /** Another span, of the same run. */
  renew(span, isAtEnd) {
    if (!this.span && span) this.speed = niceSpeed((span.to - span.from) / 30);
    this.span = span;
    if (span) this.time = isAtEnd ? span.to : Math.min(this.time, span.to);
  }

  /** Tells `listener` of each change. Gives what ends that. */
  listen(listener) {
    this.#listeners.add(listener);
    return () => this.#listeners.delete(listener);
  }

  #tell() {
    for (const listener of this.#listeners) listener();
  }

  set(time) {
    this.time = Math.min(Math.max(time, this.span.from), this.span.to);
    this.#tell();
  }

  play() {
    if (!this.span || this.playing) return;
    if (this.time >= this.span.to) this.time = this.span.from;
    this.playing = true;
    this.#last = performance.now();
    requestAnimationFrame(this.#pass);
    this.#tell();
  }

  pause() {
    this.playing = false;
    this.#tell();
  }

  #pass = (now) => {
    if (!this.playing) return;
    const passed = Math.max(0, (now - this.#last) / 1000);
    this.#last = now;
    this.time += passed * this.speed;
    if (this.time >= this.span.to) {
      this.time = this.span.to;
      this.playing = false;
    }
    this.#tell();
    if (this.playing) requestAnimationFrame(this.#pass);
  };
}

/** The nearest of 1, 2, 5, 10, 20, .. */
export function niceSpeed(speed) {
  const power = 10 ** Math.floor(Math.log10(Math.max(speed, 1e-9)));
  return power * [1, 2, 5, 10].reduce((best, f) => (Math.abs(f * power - speed) < Math.abs(best * power - speed) ? f : best), 1);
}
