// A step of a dragged link toward its target, to first order: within the position limits, with the loops closed.

import { Decomposition, inner, largest, length, solvePositive, times } from "./linear_algebra.js";
import { BEYOND } from "./tolerances.js";

const MOST_CORRECTION = 0.25; // what closes the loops after a step, relative to it
const MOST_CORRECTIONS = 8;
const SOLVED = 1e-12; // bound of each row of the residual, m or rad, ...
const ROUNDING = 1e-13; // ... unless a correction is smaller than this
const DAMPING = 1e-3; // of a step, relative to the squared error, and ...
const LEAST_DAMPING = 1e-8; // ... at least, so that no joint runs away near a singular configuration

/** Each group of loops is decomposed by itself. */
export class DragStep {
  constructor(task, x, e) {
    Object.assign(this, { task, x, e, J: task.jacobian(x) });
    const { groups, n, index } = task;
    this.parts = groups.map((group) => new Part(task, group, x));
    this.closing = new Float64Array(n); // the step that closes the loops
    this.free = []; // steps (n) that keep them closed
    const inLoops = new Set(groups.flatMap(({ columns }) => columns));
    for (const part of this.parts) {
      part.add(part.decomposed.solve(part.open(x)), this.closing);
      for (const vector of part.decomposed.nullSpace()) this.free.push(part.add(vector, new Float64Array(n)));
    }
    for (const [column, i] of index) {
      if (!inLoops.has(column)) this.free.push(Float64Array.from({ length: n }, (_, k) => (k === i ? 1 : 0)));
    }
    this.along = this.J.map((row) => times(this.free, row)); // J on the free steps
    this.left = this.e.map((each, k) => each - inner(this.J[k], this.closing));
    this.solve(Math.max(DAMPING * inner(e, e), LEAST_DAMPING));
  }

  /**
   * Finds the `step` d with the least |J d - e|² + λ |d|² that closes the loops within the limits, and the velocities
   * that are `pressed`: it brings them to their limits.
   */
  solve(λ) {
    const { task, x, free } = this;
    const { coordinate } = task.problem;
    const pressed = new Map(); // to {room, side}: how far the limit is, and whether it is the lower (-1) or upper one
    const ignored = new Set(); // they depend on those that are pressed
    const released = new Set();
    for (;;) {
      this.step = this.stepAlong(λ, pressed);
      let first = null;
      for (const i of task.bounded) {
        if (pressed.has(i) || ignored.has(i)) continue;
        const at = x[coordinate[task.columns[i]]];
        const { over, limit } = task.excess(i, at + task.units[i] * this.step[i], x);
        const part = over > BEYOND ? over / Math.abs(task.units[i] * this.step[i]) : 0;
        if (part > 0 && !(part <= first?.part)) first = { i, part, room: (limit - at) / task.units[i] };
      }
      if (first && this.isFree(first.i, pressed))
        pressed.set(first.i, { room: first.room, side: Math.sign(this.step[first.i]) });
      else if (first) ignored.add(first.i);
      else {
        const leaving = this.leaving(λ, pressed).find((i) => !released.has(i));
        if (leaving === undefined) break;
        released.add(leaving);
        pressed.delete(leaving);
      }
    }
    if (ignored.size) this.step = this.shortened(this.step);
    this.pressed = [...pressed.keys()];
  }

  /** The pressed velocities that would leave their limits if they could: by the signs of their Lagrange multipliers. */
  leaving(λ, pressed) {
    const gradient = this.z.map((each) => λ * each);
    this.along.forEach((row, k) => {
      const error = inner(row, this.z) - this.left[k];
      row.forEach((rate, i) => (gradient[i] += error * rate));
    });
    const rows = this.rowsOf(pressed.keys());
    const multipliers = solvePositive(
      rows.map((one) => Float64Array.from(rows, (other) => inner(one, other))),
      times(rows, gradient),
    );
    return [...pressed.keys()].filter((i, k) => pressed.get(i).side * multipliers[k] > 0);
  }

  /** How velocities depend on the free steps. */
  rowsOf(velocities) {
    return [...velocities].map((i) => Float64Array.from(this.free, (vector) => vector[i]));
  }

  /** Whether a velocity can be given besides those that are pressed. */
  isFree(i, pressed) {
    return new Decomposition(this.rowsOf([...pressed.keys(), i]), this.free.length).rank > pressed.size;
  }

  /** The same, with the pressed velocities given. */
  stepAlong(λ, pressed) {
    const { free, along, left, closing } = this;
    const held = new Decomposition(this.rowsOf(pressed.keys()), free.length);
    const z = held.solve([...pressed].map(([i, { room }]) => room - closing[i]));
    const others = pressed.size ? held.nullSpace() : null; // among the free steps
    const rates = others ? along.map((row) => times(others, row)) : along;
    const missing = left.map((each, k) => each - inner(along[k], z));
    const G = rates.map((one) => Float64Array.from(rates, (other) => inner(one, other)));
    G.forEach((row, k) => (row[k] += λ));
    const y = solvePositive(G, missing);
    const add = (amount, vector, to) => vector.forEach((each, k) => (to[k] += amount * each));
    const w = new Float64Array(rates[0].length);
    rates.forEach((row, k) => add(y[k], row, w));
    if (others) others.forEach((vector, k) => add(w[k], vector, z));
    else z.set(w);
    this.z = z; // the step by the free ones
    const step = Float64Array.from(closing);
    free.forEach((vector, k) => add(z[k], vector, step));
    return step;
  }

  /** A step that leaves all coordinates within their limits. */
  shortened(step) {
    const { task, x } = this;
    let part = 1;
    for (const i of task.bounded) {
      const at = x[task.problem.coordinate[task.columns[i]]];
      const { over } = task.excess(i, at + task.units[i] * step[i], x);
      if (over > 0) part = Math.min(part, 1 - over / Math.abs(task.units[i] * step[i]));
    }
    return step.map((each) => Math.max(part, 0) * each);
  }

  /** The configuration after a step, with the loops closed; null if closing them moves the joints too far. */
  after(step) {
    const { task, x } = this;
    const { coordinate } = task.problem;
    const most = MOST_CORRECTION * length(step) + BEYOND;
    const held = new Set(this.pressed);
    let there = task.moved(x, step);
    for (;;) {
      for (const part of this.parts) {
        there = part.closed(there, held, most);
        if (!there) return null;
      }
      const beyond = task.bounded.filter((i) => task.excess(i, there[coordinate[task.columns[i]]], x).over > BEYOND);
      if (!beyond.length) return there;
      if (beyond.every((i) => held.has(i))) return null;
      for (const i of beyond) {
        held.add(i);
        there[coordinate[task.columns[i]]] = task.excess(i, there[coordinate[task.columns[i]]], x).limit;
      }
    }
  }
}

/** A group of loops near x. */
class Part {
  constructor(task, group, x) {
    Object.assign(this, { task, group, K: group.jacobian(x), rounding: 2 * largest(group.residual(x)) });
    this.places = group.columns.map((column) => task.index.get(column) ?? -1);
    this.decomposed = this.without(new Set());
  }

  /** K decomposed, without the velocities that are held. */
  without(held) {
    const still = this.places.map((place) => place < 0 || held.has(place));
    if (!still.some(Boolean)) return this.decomposed ?? new Decomposition(this.K, this.group.n);
    return new Decomposition(
      this.K.map((row) => row.map((rate, i) => (still[i] ? 0 : rate))),
      this.group.n,
    );
  }

  /** The step that the residual asks for. */
  open(x) {
    return this.group.scaled(this.group.residual(x)).map((row) => -row);
  }

  /** Adds a step of the group to one of the task. */
  add(vector, to) {
    this.places.forEach((place, i) => {
      if (place >= 0) to[place] += vector[i];
    });
    return to;
  }

  /** x with the loops of the group closed; null if that moves the joints by more than `most`. */
  closed(x, held, most) {
    const decomposed = this.without(held);
    const correction = new Float64Array(this.group.n);
    for (let count = 0; count < MOST_CORRECTIONS; count += 1) {
      const r = this.group.residual(x);
      if (r.every((row) => Math.abs(row) <= SOLVED)) return x;
      const more = decomposed.solve(this.group.scaled(r).map((row) => -row));
      // What is left are redundant rows that contradict each other, as at x.
      if (largest(more) <= ROUNDING) return largest(r) <= this.rounding ? x : null;
      more.forEach((each, i) => (correction[i] += each));
      if (!(length(correction) <= most)) return null;
      x = this.group.moved(x, more);
    }
    return null;
  }
}
