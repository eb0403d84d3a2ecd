// The coordinates that a person moves, and how far.

import { JOINT_TYPES } from "../mechanism/joint_types.js";
import { analysisOf } from "./analyze.js";
import { POSES, coordinatesOf, hasPose, longest } from "./poses_of_joints.js";
import { problemOf } from "./problem.js";

/**
 * The sliders of a robot at q: of its actuators, or of all joints if there are none.
 *
 * @returns A list of {joint, index, label, unit ("rad" or "m"), lower, upper, actuated, follow, dependent}: `index` as
 *   `Drive.move` has it; `lower` and `upper` are the position limits, without them half a turn or a characteristic
 *   length from q; `follow` names the dependent actuators that follow, as the loops do not let this one move alone.
 */
export function sliders(mechanism, q) {
  const problem = problemOf(mechanism);
  const { tree } = problem;
  const x = tree.read(q);
  const { dependentActuators } = analysisOf(problem, x);
  const actuated = [...new Set([...problem.actuated].map((velocity) => problem.joints[velocity]))];
  const joints = actuated.length ? actuated : tree.joints.filter(({ isFree, isRoot }) => isFree && !isRoot);
  return joints.flatMap((joint) => {
    const { name, type } = joint;
    // The velocities of a joint that is not actuated are not held, so its pose is not either.
    if (hasPose(joint) && problem.constraints.length && !actuated.length) return [];
    const sets = dependentActuators.filter((names) => names.includes(name));
    const follow = sets.flat().filter((other) => other !== name);
    return labels(type).map((word, index) => {
      const { lower, upper, unit } = rangeOf(problem, x, joint, index);
      const label = word ? `${name} ${word}` : name;
      return {
        joint: name,
        index,
        label,
        unit,
        lower,
        upper,
        actuated: !!actuated.length,
        follow,
        dependent: !!sets.length,
      };
    });
  });
}

function labels(type) {
  if (type === "planar") return ["position x", "position y", "angle"];
  const rotations = ["rotation x", "rotation y", "rotation z"];
  if (type === "spherical") return rotations;
  if (type === "floating") return ["position x", "position y", "position z", ...rotations];
  const { coordinates } = JOINT_TYPES[type];
  return coordinates.length === 1 ? [""] : coordinates.map((kind, i) => `${i + 1} (${kind})`);
}

/** How far a coordinate moves: `lower` and `upper` for a slider, and what stops it: `least` and `most`. */
export function rangeOf(problem, x, joint, index) {
  const { type, column } = joint;
  const pose = coordinatesOf(joint, x);
  const at = pose[index];
  const kind = (POSES[type] ?? JOINT_TYPES[type].coordinates)[index];
  const unit = kind === "length" ? "m" : "rad";
  const around = unit === "m" ? problem.length : Math.PI;
  if (hasPose(joint)) {
    const from = unit === "m" ? at : 0;
    const range = {
      unit,
      lower: from - around,
      upper: from + around,
      least: -Infinity,
      most: Infinity,
      isLimit: false,
    };
    if (unit === "m" || type === "planar") return range;
    const others = pose.slice(-3).filter((_, i) => i !== index - pose.length + 3);
    const most = Math.sqrt(Math.max(0, longest ** 2 - others.reduce((sum, each) => sum + each ** 2, 0)));
    return { ...range, least: -most, most };
  }
  if (type === "continuous") return { unit, lower: -Math.PI, upper: Math.PI, least: -Infinity, most: Infinity };
  const [least, most] = [problem.lower[column + index], problem.upper[column + index]];
  return {
    unit,
    lower: Number.isFinite(least) ? Math.min(least, at) : at - around,
    upper: Number.isFinite(most) ? Math.max(most, at) : at + around,
    least: Math.min(least, at),
    most: Math.max(most, at),
    isLimit: true,
  };
}
