// Steps of one velocity along the branch of closed configurations, while others are held: the passive joints follow.

import { Decomposition, largest, length } from "./linear_algebra.js";
import { Loops } from "./loops.js";
import { BEYOND, CLOSED as OPEN } from "./tolerances.js";

// A step is short enough if the correction that closes the loops after it is at most this fraction of it, ...
const MOST_CORRECTION = 0.1;
// ... and if K_p changes by less than the sum of its smallest singular values before and after the step: it would have
// to change by as much to lose rank and to regain it (Eckart, Young, 1936), so there is no dead point within the step.
const MOST_CORRECTIONS = 12;
const CLOSED = 1e-13; // bound of each row of the residual after the corrections, m or rad, ...
const ROUNDING = 1e-14; // ... unless a correction is smaller than this
const KEPT = 1e-9; // bound of each row of the residual after a step, m or rad, unless it was as large before

export class Branch {
  /** `velocity` moves; those of `held` do not. */
  constructor(problem, velocity, held) {
    this.problem = problem;
    const found = problem.connected(held).find(({ columns }) => columns.includes(velocity));
    const columns = (found?.columns ?? [velocity]).filter((each) => each === velocity || !held.has(each));
    this.loops = new Loops(problem, found?.constraints ?? [], columns);
    this.driven = columns.indexOf(velocity);
    this.passive = columns.filter((each) => each !== velocity);
  }

  /** The point at a closed configuration: K_p there, which has zeros for the velocity, and the velocity's column. */
  at(x, correction = 0) {
    const K = this.loops.jacobian(x);
    const column = Float64Array.from(K, (row) => row[this.driven]);
    for (const row of K) row[this.driven] = 0;
    const passive = new Decomposition(K, this.loops.n, { singularValues: true });
    const { rank, values } = passive;
    const residual = largest(this.loops.residual(x));
    return { x, K, column, passive, rank, residual, correction, smallest: rank ? values[rank - 1] : Infinity };
  }

  /** The point after the velocity has moved by h, rad or m; null if the step is too long. */
  step(here, h) {
    const { loops, driven } = this;
    const amount = h / loops.units[driven];
    const step = here.passive.solve(here.column.map((rate) => -rate * amount));
    step[driven] = amount;
    let x = loops.moved(here.x, step);
    const correction = new Float64Array(loops.n);
    for (let count = 0; ; count += 1) {
      if (count === MOST_CORRECTIONS) return null;
      const r = loops.residual(x);
      if (r.every((row) => Math.abs(row) <= CLOSED)) break;
      const more = here.passive.solve(loops.scaled(r).map((row) => -row));
      x = loops.moved(x, more);
      more.forEach((each, i) => (correction[i] += each));
      if (more.every((each) => Math.abs(each) <= ROUNDING)) break;
    }
    const part = length(correction) / length(step);
    if (!(part <= MOST_CORRECTION)) return null;
    const there = this.at(x, part);
    // Loops that cannot follow are open by more, in spite of the corrections.
    if (!(there.residual <= Math.max(KEPT, here.residual, Math.min(2 * here.residual, OPEN)))) return null;
    let change = 0;
    there.K.forEach((row, i) => row.forEach((rate, k) => (change += (rate - here.K[i][k]) ** 2)));
    return Math.sqrt(change) <= here.smallest + there.smallest ? there : null;
  }

  /** The passive velocity whose coordinate first exceeds its limit on a step, and after what part of it. */
  passiveLimit(here, there) {
    const { coordinate, lower, upper } = this.problem;
    let first = null;
    for (const velocity of this.passive) {
      const i = coordinate[velocity];
      if (i < 0) continue;
      const [before, after] = [here.x[i], there.x[i]];
      // A coordinate that is already beyond its limit can move back, but not farther out.
      const highest = before > upper[velocity] + BEYOND ? before : upper[velocity];
      const lowest = before < lower[velocity] - BEYOND ? before : lower[velocity];
      const over = Math.max(after - highest, lowest - after);
      if (!(over > BEYOND)) continue;
      // Half the tolerance is left, so that a search for the limit ends within it.
      const part = (over - 0.5 * BEYOND) / Math.abs(after - before);
      if (!first || part > first.over) first = { velocity, over: part, part: Math.max(0, 1 - part) };
    }
    return first;
  }
}
