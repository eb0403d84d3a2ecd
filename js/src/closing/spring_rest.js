// Where springs bring a robot while its actuators are held, within the position limits of its passive joints.

import { Decomposition, largest, times } from "./linear_algebra.js";
import { BEYOND } from "./tolerances.js";

const MOST_STEPS = 60;
const LONGEST = 0.3; // bound of the motion of a joint in one step
const LAST = 1e-10; // a shorter step is the last one
const CLOSED = 1e-12; // bound of each row of the residual at the end, m or rad

/**
 * The closed configuration near x at which the springs store the least energy: each step minimizes ½ Σ k (c + ċ)² under
 * K v = -r, with the coordinates that would leave their limits at them.
 *
 * @param loops Constraints, with the velocities that are not held.
 * @returns {x, pressed}: the configuration, null if none was found; the velocities whose coordinates are at limits.
 */
export function atRest(loops, x) {
  const acting = loops.problem.springs.filter(({ column }) => loops.index.has(column));
  const limits = limitsFrom(loops, x);
  let pressed = new Map();
  for (let count = 0; count < MOST_STEPS; count += 1) {
    let step;
    [step, pressed] = stepWithin(loops, acting, x, limits);
    const size = largest(step);
    x = loops.moved(x, size > LONGEST ? step.map((each) => (each * LONGEST) / size) : step);
    if (size <= LAST) break;
  }
  const { coordinate } = loops.problem;
  const reached = [...pressed].every(([velocity, goal]) => Math.abs(x[coordinate[velocity]] - goal) <= BEYOND);
  const closed = loops.residual(x).every((row) => Math.abs(row) <= CLOSED);
  return { x: reached && closed ? x : null, pressed: [...pressed.keys()] };
}

/** The limits of the coordinates; one that starts beyond its limit may stay there. */
function limitsFrom({ problem, columns }, x) {
  const { coordinate, lower, upper } = problem;
  const bounded = columns.filter((velocity) => coordinate[velocity] >= 0);
  return bounded.map((velocity) => {
    const at = x[coordinate[velocity]];
    return { velocity, lower: Math.min(lower[velocity], at), upper: Math.max(upper[velocity], at) };
  });
}

/** A step, and the coordinates that it brings to their limits: a map from their velocities to the limits. */
function stepWithin(loops, springs, x, limits) {
  const { columns, units, index, problem } = loops;
  const at = (velocity) => x[problem.coordinate[velocity]];
  const [K, b] = [loops.jacobian(x), loops.scaled(loops.residual(x))];
  const [pressed, released] = [new Map(), new Set()];
  const ahead = (velocity, step) => at(velocity) + units[index.get(velocity)] * step[index.get(velocity)];
  for (;;) {
    const goals = [...pressed];
    const rows = [...K, ...goals.map(([velocity]) => unit(index.get(velocity), loops.n))];
    const wanted = [
      ...b.map((row) => -row),
      ...goals.map(([velocity, goal]) => (goal - at(velocity)) / units[index.get(velocity)]),
    ];
    const loopsAndLimits = new Decomposition(rows, loops.n);
    const step = loopsAndLimits.solve(wanted);
    if (pressed.size > 1 && times(rows, step).some((row, k) => Math.abs(row - wanted[k]) > BEYOND)) {
      // They cannot all be at their limits: the first one has left its limit.
      const [first] = pressed.keys();
      pressed.delete(first);
      released.add(first);
      continue;
    }
    const free = loopsAndLimits.nullSpace();
    const pull = springs.map((s) => {
      const factor = Math.sqrt(s.stiffness) * s.ratio * units[index.get(s.column)];
      return Float64Array.from(free, (each) => factor * each[index.get(s.column)]);
    });
    const left = springs.map((s) => -Math.sqrt(s.stiffness) * (s.ratio * ahead(s.column, step) + s.shift));
    const z = new Decomposition(pull, free.length, { singularValues: true }).solve(left);
    free.forEach((each, k) => each.forEach((value, i) => (step[i] += z[k] * value)));
    let first = null;
    for (const { velocity, lower, upper } of limits) {
      if (pressed.has(velocity) || released.has(velocity)) continue;
      const [before, after] = [at(velocity), ahead(velocity, step)];
      const [limit, over] = after > upper ? [upper, after - upper] : [lower, lower - after];
      const part = over > BEYOND ? over / Math.abs(after - before) : 0;
      if (part > 0 && (!first || part > first.part)) first = { velocity, limit, part };
    }
    if (!first) return [step, pressed];
    pressed.set(first.velocity, first.limit);
  }
}

const unit = (index, n) => Float64Array.from({ length: n }, (_, i) => (i === index ? 1 : 0));
