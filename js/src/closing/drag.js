// Inverse kinematics of a point of a link: it follows a target, with the loops closed and the position limits kept.

import { log3 } from "../mechanism/log6.js";
import { IDENTITY, SIZE, read } from "../mechanism/poses.js";
import { add, apply, cross, multiply, subtract, transpose } from "../mechanism/spatial.js";
import { ROOT } from "../mechanism/tree.js";
import { DragStep } from "./drag_step.js";
import { largest, length } from "./linear_algebra.js";
import { problemOf } from "./problem.js";

const MOST_STEPS = 12;
const LONGEST = 0.3; // bound of the motion of a joint in one step
const SHORTEST = 1e-5; // bound of the same, below which no step reduces the error
const REACHED = 1e-9; // an error, or a step, that counts as none
const LEAST_GAIN = 1e-4; // a step that reduces the error by a smaller part is the last one

/**
 * Brings a point of a link as near to a target as the loops and the position limits allow, near q.
 *
 * @param q A configuration with closed loops.
 * @param goal {link; point, in the link's frame (m); target, in the world (m); rotation: of the link in the world, a
 *   list of rows, or left out; held: names of joints that do not move (a fixed root may be named), or left out}.
 * @returns {q, error, atLimits, residual}: the distance that is left (m), the joints at their limits that would go on,
 *   and the largest row of the residual (m or rad).
 */
export function drag(mechanism, q, goal) {
  const problem = problemOf(mechanism);
  const task = new Task(problem, goal);
  let x = problem.tree.read(q);
  let [e, reach] = [task.error(x), LONGEST];
  let near = new DragStep(task, x, e);
  for (let steps = 0; steps < MOST_STEPS && length(e) > REACHED && reach > SHORTEST;) {
    const size = largest(near.step);
    if (!(size > REACHED)) break;
    const part = Math.min(1, reach / size);
    const there = near.after(near.step.map((each) => part * each));
    const error = there && task.error(there);
    reach = Math.min(reach, size);
    if (!there || length(error) >= length(e)) {
      reach /= 3;
      continue;
    }
    const gain = 1 - length(error) / length(e);
    [x, e, reach, steps] = [there, error, Math.min(3 * reach, LONGEST), steps + 1];
    near = new DragStep(task, x, e);
    if (gain < LEAST_GAIN) break;
  }
  const pressed = length(e) > REACHED ? near.pressed : [];
  return {
    q: problem.tree.write(x),
    error: problem.length * Math.hypot(e[0], e[1], e[2]),
    atLimits: [...new Set(pressed.map((i) => problem.joints[task.columns[i]].name))],
    residual: problem.largestResidual(x),
  };
}

/** What is to be reached, and the velocities that may move: of the joints that carry the link, and of their loops. */
class Task {
  constructor(problem, { link, point, target, rotation, held = [] }) {
    const { tree } = problem;
    const body = tree.bodies.get(link);
    if (body === undefined) throw new RangeError(`there is no link '${link}'`);
    Object.assign(this, { problem, point, target, rotation, body, rows: rotation ? 6 : 3 });
    this.joints = tree.jointsBetween(-1, [this.body]);
    const isFixed = (name) => name === ROOT && !tree.byName.has(ROOT);
    const still = new Set(held.flatMap((name) => (isFixed(name) ? [] : problem.velocitiesOf(name))));
    const carrying = new Set(this.motions().map(({ column }) => column));
    this.groups = problem.groups.filter(({ columns }) => columns.some((column) => carrying.has(column)));
    const all = new Set([...carrying, ...this.groups.flatMap(({ columns }) => columns)]);
    this.columns = [...all].filter((column) => !still.has(column));
    this.index = new Map(this.columns.map((column, i) => [column, i]));
    this.n = this.columns.length;
    this.units = this.columns.map((column) => problem.units[column]);
    this.moving = [...new Set(this.columns.map((column) => problem.joints[column]))];
  }

  motions() {
    return this.joints.flatMap(({ motion, column, velocities }) => {
      return Array.from({ length: velocities }, (_, i) => ({ motion: motion + i, column: column + i }));
    });
  }

  /** The pose of the link in the world, and where the point is. */
  place(x) {
    const { tree, placed } = this.problem;
    placed.poses.set(IDENTITY, SIZE * tree.root);
    tree.place(x, placed, this.joints);
    const { R, p } = read(placed.poses, SIZE * this.body);
    return { R, at: add(apply(R, this.point), p) };
  }

  /** Dimensionless: the way to the target, and the rotation to it. */
  error(x) {
    const { R, at } = this.place(x);
    const way = subtract(this.target, at).map((each) => each / this.problem.length);
    return this.rotation ? [...way, ...log3(multiply(this.rotation, transpose(R)))] : way;
  }

  /** The rows (3 or 6) of the derivative of the link's pose. */
  jacobian(x) {
    const { at } = this.place(x);
    const { twists, origin } = this.problem.placed;
    const J = Array.from({ length: this.rows }, () => new Float64Array(this.n));
    for (const { motion, column } of this.motions()) {
      const i = this.index.get(column);
      if (i === undefined) continue;
      const [v, w] = [twists.subarray(6 * motion, 6 * motion + 3), twists.subarray(6 * motion + 3, 6 * motion + 6)];
      const moved = add(v, cross(w, subtract(at, origin))).map((each) => each / this.problem.length);
      J.forEach((row, k) => (row[i] += this.units[i] * (k < 3 ? moved[k] : w[k - 3])));
    }
    return J;
  }

  moved(x, step) {
    const v = new Float64Array(this.problem.tree.nv);
    this.columns.forEach((column, i) => (v[column] = this.units[i] * step[i]));
    return this.problem.tree.integrate(x, v, this.moving);
  }

  /** How far a coordinate is beyond its limits, and the limit; one that is beyond at `from` may stay there. */
  excess(i, value, from) {
    const { coordinate, lower, upper } = this.problem;
    const column = this.columns[i];
    const least = Math.min(lower[column], from[coordinate[column]]);
    const most = Math.max(upper[column], from[coordinate[column]]);
    return value > most ? { over: value - most, limit: most } : { over: least - value, limit: least };
  }

  /** The indices of the velocities that drive one coordinate each. */
  get bounded() {
    this.limited ??= this.columns.flatMap((column, i) => (this.problem.coordinate[column] >= 0 ? [i] : []));
    return this.limited;
  }
}
