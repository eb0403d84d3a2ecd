// Closing loops from an open configuration: damped Gauss-Newton steps, and restarts around the start.

import { MOST_STEPS, descend } from "./descend.js";
import { problemOf } from "./problem.js";
import { CLOSED, SMALL, SOLVED } from "./tolerances.js";

const RESTARTS = 20;
const SPREADS = [0.1, 0.3, 1, 2, 3]; // distance of the restarts from the start; the last one is repeated
const MOST_AT_ONCE = 60; // velocities
const MOST_WORK = 1e10; // multiplications of all descents of a group: some seconds

/**
 * A configuration near q with all loops closed; if none is found, the least open one.
 *
 * @param limits Whether to respect the position limits of joints.
 * @returns {q, residual, closes, open}: the largest row of the residual (m or rad), and what is open:
 *   {name, residual, position (m), angle (rad)}.
 */
export function assemble(mechanism, q = startOf(mechanism), { limits = false } = {}) {
  const problem = problemOf(mechanism);
  return result(problem, assembled(problem, problem.tree.read(q), limits));
}

/** Where to start: `assembled`, or the neutral configuration. */
export const startOf = (mechanism) => mechanism.named("assembled") ?? {};

function result(problem, x) {
  const open = openAt(problem, x);
  return { q: problem.tree.write(x), residual: problem.largestResidual(x), closes: !open.length, open };
}

/** What is open at q, as `assemble` returns it. */
export function openLoops(mechanism, q) {
  const problem = problemOf(mechanism);
  return openAt(problem, problem.tree.read(q));
}

export function openAt(problem, x) {
  const bound = CLOSED * Math.min(1, problem.length / SMALL);
  const openings = problem.together.openings(x);
  return openings
    .filter(({ position, angle }) => !(position <= bound && angle <= CLOSED))
    .map((each) => ({ ...each, residual: Math.max(each.position, each.angle) }));
}

/** As `assemble`, from an array and to one. */
export function assembled(problem, start, limits = false) {
  const tolerance = toleranceOf(problem);
  let x = normalized(problem, start);
  if (limits) x = clipped(problem, x, problem.together.columns);
  const groups = problem.groups;
  const isClosed = (group, at) => errorOf(group, at) <= CLOSED;
  if (problem.tree.nv <= MOST_AT_ONCE && groups.length > 1) {
    const found = descend(problem.together, x, tolerance, limits);
    if (groups.every((group) => isClosed(group, found))) return found;
    // Each group that is still open starts again from the start.
    return groups.reduce((at, group) => {
      const from = copied(group, found, at);
      return isClosed(group, from) ? from : search(group, x, from, tolerance, limits);
    }, x);
  }
  return groups.reduce((at, group) => search(group, x, at, tolerance, limits), x);
}

/** As `assembled`, without restarts. */
export function close(problem, start) {
  const groups = problem.groups;
  return groups.reduce((at, group) => descend(group, at, toleranceOf(problem)), start);
}

const toleranceOf = ({ length }) => SOLVED * Math.min(1, length / SMALL);

/** Descends one group, again and again; `at` has the other groups where they are to stay. */
function search(group, start, at, tolerance, limits) {
  const random = generator();
  const attempts = Math.min(1 + RESTARTS, MOST_WORK / (MOST_STEPS * group.work));
  let best = at;
  let least = Infinity;
  for (let attempt = 0; attempt < attempts && !(least <= CLOSED); attempt += 1) {
    let from = copied(group, start, at);
    if (attempt) {
      const spread = SPREADS[Math.min(attempt, SPREADS.length) - 1];
      from = group.moved(
        from,
        group.columns.map(() => spread * (2 * random() - 1)),
      );
      if (limits) from = clipped(group.problem, from, group.columns);
    }
    const found = descend(group, from, tolerance, limits);
    const error = errorOf(group, found);
    if (error < least) [best, least] = [found, error];
  }
  return best;
}

/** The norm of the residual, m and rad; lengths of small robots count more, in proportion. */
function errorOf(group, x) {
  return Math.hypot(...group.residual(x).map((row, i) => row * Math.max(SMALL * group.scale[i], 1)));
}

/** `into`, with the joints of a group as they are in `from`. */
function copied(group, from, into) {
  const x = Float64Array.from(into);
  for (const column of group.columns) {
    const { x: first, end } = group.problem.joints[column];
    for (let i = first; i < end; i += 1) x[i] = from[i];
  }
  return x;
}

function clipped(problem, x, columns) {
  const within = Float64Array.from(x);
  for (const column of columns) {
    const i = problem.coordinate[column];
    if (i >= 0) within[i] = Math.min(Math.max(x[i], problem.lower[column]), problem.upper[column]);
  }
  return within;
}

/** With quaternions of unit length. */
function normalized(problem, x) {
  const found = Float64Array.from(x);
  for (const { isFree, end, quaternion } of problem.tree.joints) {
    if (!isFree || quaternion < 0) continue;
    const length = Math.hypot(...x.subarray(quaternion, end));
    for (let i = quaternion; i < end; i += 1) found[i] = x[i] / length;
  }
  return found;
}

/** Numbers from 0 to 1, the same each time (a linear congruential generator modulo 2^32). */
function generator() {
  let state = 1;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}
