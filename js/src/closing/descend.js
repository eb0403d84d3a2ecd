// Levenberg-Marquardt steps towards the closed configurations.
//
// A step d solves (AᵀA + λ 1) d = -Aᵀb, with b the residual and A its derivative, both dimensionless. As λ is
// proportional to |b|², steps are small far from a solution, and convergence near it is quadratic, even with redundant
// rows.

import { inner, largest, solvePositive, times } from "./linear_algebra.js";

export const MOST_STEPS = 60;
const MOST_IDLE_STEPS = 6; // consecutive steps that each reduce |b|² by less than the next fraction
const IDLE = 0.02;
const LEAST_GAIN = 1e-12; // expected reduction of |b|² by a step, relative to it
const FIRST_DAMPING = 1e-3;
const LEAST_DAMPING = 1e-8;
const MORE_DAMPING = 8; // after a step that is not accepted
const LEAST_SHARE = 0.01; // of the expected reduction, for a step to be accepted
const LEAST_OF_TRACE = 1e-13; // damping that makes A Aᵀ invertible even with redundant rows

/** Where the descent of some loops from x ends. `tolerance`: of the norm of the residual, m and rad. */
export function descend(loops, x, tolerance, limits) {
  let r = loops.residual(x);
  let b = loops.scaled(r);
  let squared = inner(b, b);
  let [before, expected] = [squared, squared];
  let [damping, more, idle] = [FIRST_DAMPING, MORE_DAMPING, 0];
  let A = null;
  for (let count = 0; count < MOST_STEPS && inner(r, r) > tolerance ** 2; count += 1) {
    if (count) {
      idle = squared < (1 - IDLE) * before ? 0 : idle + 1;
      if (idle > MOST_IDLE_STEPS || !(expected > LEAST_GAIN * squared)) break;
    }
    A ??= loops.jacobian(x);
    const step = stepWithin(loops, x, A, b, damping * squared, limits);
    const there = loops.moved(x, step);
    [expected, before] = [squared - predicted(A, b, step), squared];
    const rThere = loops.residual(there);
    const bThere = loops.scaled(rThere);
    const reached = inner(bThere, bThere);
    const progress = squared - reached;
    if (expected > 0 && progress > LEAST_SHARE * expected) {
      const gain = progress / expected;
      [x, r, b, squared, A] = [there, rThere, bThere, reached, null];
      damping = Math.max(damping * (gain > 0.75 ? 0.1 : gain > 0.25 ? 1 : 4), LEAST_DAMPING);
      more = MORE_DAMPING;
    } else {
      damping *= more;
      more *= 2;
    }
  }
  return x;
}

/** |A d + b|². */
function predicted(A, b, step) {
  const rows = times(A, step).map((row, i) => row + b[i]);
  return inner(rows, rows);
}

/** The next step, of at most 1; joints at a limit stay there if they would exceed it, and the others compensate. */
function stepWithin(loops, x, A, b, damping, limits) {
  let step = damped(A, loops.n, b, damping);
  if (!limits) return shortened(step);
  const rooms = loops.columns.map((column, i) => roomOf(loops.problem, x, column, loops.units[i]));
  const held = new Set();
  for (;;) {
    const before = held.size;
    step.forEach((each, i) => {
      if ((each < 0 && rooms[i][0] === 0) || (each > 0 && rooms[i][1] === 0)) held.add(i);
    });
    if (held.size === before) break;
    step = damped(
      A.map((row) => row.map((rate, i) => (held.has(i) ? 0 : rate))),
      loops.n,
      b,
      damping,
    );
  }
  return shortened(step).map((each, i) => Math.min(Math.max(each, rooms[i][0]), rooms[i][1]));
}

function shortened(step) {
  const longest = Math.max(1, largest(step));
  return step.map((each) => each / longest);
}

/** How far a velocity may move down and up, dimensionless. */
export function roomOf({ coordinate, lower, upper }, x, column, unit) {
  const i = coordinate[column];
  if (i < 0) return [-Infinity, Infinity];
  return [Math.min(lower[column] - x[i], 0) / unit, Math.max(upper[column] - x[i], 0) / unit];
}

/** The d (n) that minimises |A d + b|² + λ |d|², from the smaller of A Aᵀ and Aᵀ A. */
function damped(A, n, b, damping) {
  const isWide = A.length < n;
  const G = Array.from({ length: isWide ? A.length : n }, () => new Float64Array(isWide ? A.length : n));
  if (isWide) for (let i = 0; i < A.length; i += 1) for (let j = 0; j <= i; j += 1) G[i][j] = inner(A[i], A[j]);
  else {
    for (const row of A) {
      for (let i = 0; i < n; i += 1) if (row[i]) for (let j = 0; j <= i; j += 1) G[i][j] += row[i] * row[j];
    }
  }
  const trace = G.reduce((sum, row, i) => sum + row[i], 0);
  const added = Math.max(damping, LEAST_OF_TRACE * trace + 1e-300);
  G.forEach((row, i) => (row[i] += added));
  if (isWide)
    return combined(
      A,
      n,
      solvePositive(
        G,
        b.map((each) => -each),
      ),
    );
  return solvePositive(
    G,
    combined(
      A,
      n,
      b.map((each) => -each),
    ),
  );
}

/** Aᵀ y. */
function combined(A, n, y) {
  const x = new Float64Array(n);
  A.forEach((row, i) => row.forEach((rate, k) => (x[k] += rate * y[i])));
  return x;
}
