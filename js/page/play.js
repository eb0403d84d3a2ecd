// Playing: one actuator after the other moves through its range, until something stops it, and back.

const SPEED = 0.25; // ranges of a coordinate per second
const LONGEST = 50; // a frame counts at most as long, ms

export class Play extends EventTarget {
  constructor(session) {
    super();
    this.session = session;
    this.state = null;
  }

  get isPlaying() {
    return this.state !== null;
  }

  toggle() {
    if (this.isPlaying) this.stop();
    else this.start();
  }

  start() {
    const { coordinates } = this.session;
    if (!coordinates.length) return;
    this.session.begin();
    this.state = { ...this.along(0), before: null };
    requestAnimationFrame((time) => this.frame(time));
    this.dispatchEvent(new Event("change"));
  }

  stop() {
    if (!this.isPlaying) return;
    this.state = null;
    this.dispatchEvent(new Event("change"));
  }

  /** The begin of the motion of a coordinate. */
  along(index) {
    return { index, direction: 1, turns: 0, from: this.session.value(this.session.coordinates[index]) };
  }

  frame(time) {
    const { state, session } = this;
    if (!state) return;
    const coordinate = session.coordinates[state.index];
    const elapsed = state.before === null ? 0 : Math.min(time - state.before, LONGEST) / 1000;
    state.before = time;
    let goal = session.value(coordinate) + state.direction * SPEED * (coordinate.upper - coordinate.lower) * elapsed;
    const isBack = state.turns === 2 && goal >= state.from;
    if (isBack) goal = state.from;
    const stop = session.move(coordinate, goal);
    if (isBack || (stop && state.turns === 2)) {
      Object.assign(state, this.along((state.index + 1) % session.coordinates.length));
    } else if (stop) {
      state.direction *= -1;
      state.turns += 1;
    }
    requestAnimationFrame((next) => this.frame(next));
  }
}
