// The range of motion of one actuator, with the other actuators held.

import { JOINT_TYPES } from "../mechanism/joint_types.js";
import { assembled } from "./assemble.js";
import { Branch } from "./branch.js";
import { problemOf } from "./problem.js";
import { CLOSED, DEAD } from "./tolerances.js";

const SHORTEST_STEP = 2 ** -12; // of a step

/**
 * The paths of an actuator with one coordinate, from q to its limits.
 *
 * @returns {lower, upper}, each {reached, end, joint, configurations}: the coordinate at the end (rad or m; of a
 *   continuous joint relative to q); "limit", "half turn", "characteristic length", "passive limit" (of `joint`) or
 *   "dead point"; configurations after equal steps, q first.
 */
export function sweep(mechanism, q, joint, { steps = 200 } = {}) {
  const problem = problemOf(mechanism);
  const own = problem.tree.byName.get(joint);
  const velocity = own?.column;
  if (!own?.isFree || own.velocities !== 1 || !problem.actuated.has(velocity)) {
    throw new RangeError(`'${joint}' is not an actuated joint with one velocity`);
  }
  const x = assembled(problem, problem.tree.read(q));
  if (!(problem.largestResidual(x) <= CLOSED)) throw new RangeError("the loops do not close near the configuration");
  const held = new Set(problem.actuated);
  held.delete(velocity);
  const branch = new Branch(problem, velocity, held);
  const start = branch.at(x);
  const { limited, coordinates } = JOINT_TYPES[own.type];
  const at = limited ? x[own.x] : 0;
  const [far, without] =
    coordinates[0] === "length" ? [problem.length, "characteristic length"] : [Math.PI, "half turn"];
  const bound = (limit, side) => (Number.isFinite(limit) ? [limit, "limit"] : [at + side * far, without]);
  const paths = [];
  let largest = start.smallest;
  for (const [reach, end] of [bound(problem.lower[velocity], -1), bound(problem.upper[velocity], 1)]) {
    const path = follow(branch, start, reach - at, steps, largest);
    largest = path.largest;
    paths.push({
      reached: at + path.moved,
      end: path.end ?? end,
      joint: path.joint ?? null,
      configurations: path.found.map((each) => problem.tree.write(each)),
    });
  }
  return { lower: paths[0], upper: paths[1] };
}

/** Moves by `reach`; `largest`: the largest of the smallest singular values of K_p met before. */
function follow(branch, start, reach, steps, largest) {
  let [here, part] = [start, 1];
  const found = [start.x];
  if (!reach) return { found, moved: 0, largest };
  for (let count = 0; count < steps; count += 1) {
    let done = 0;
    part = Math.min(part, 1);
    while (done < 1) {
      const h = Math.min(part, 1 - done);
      const stopped = (end, joint) => ({ found, end, joint, largest, moved: (reach * (count + done)) / steps });
      const there = branch.step(here, (h * reach) / steps);
      if (!there) {
        part = 0.5 * h;
        if (part < SHORTEST_STEP) return stopped("dead point");
        continue;
      }
      const met = branch.passiveLimit(here, there);
      if (met) {
        done += h * met.part;
        return stopped("passive limit", branch.problem.joints[met.velocity].name);
      }
      if (there.rank !== start.rank || there.smallest < DEAD * Math.max(largest, there.smallest))
        return stopped("dead point");
      [here, largest, done, part] = [there, Math.max(largest, there.smallest), done + h, 2 * h];
    }
    found.push(here.x);
  }
  return { found, moved: reach, largest };
}
