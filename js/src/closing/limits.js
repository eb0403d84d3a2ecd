// How far each coordinate is from its position limits.

import { problemOf } from "./problem.js";

/**
 * @returns A list of {joint, index, value, lower, upper, distance, passive}, rad or m, of the joints whose velocities
 *   drive one coordinate each; `distance` to the nearest limit is negative beyond it, and Infinity without one.
 */
export function limits(mechanism, q) {
  const problem = problemOf(mechanism);
  const x = problem.tree.read(q);
  return problem.tree.columns.flatMap(([joint, index], velocity) => {
    const i = problem.coordinate[velocity];
    if (i < 0) return [];
    const [value, lower, upper] = [x[i], problem.lower[velocity], problem.upper[velocity]];
    const distance = Math.min(value - lower, upper - value);
    return [{ joint, index, value, lower, upper, distance, passive: !problem.actuated.has(velocity) }];
  });
}
