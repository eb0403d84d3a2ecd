// The bounds of a robot, EU-FIL-002.

import { JOINT_TYPES } from "../mechanism/joint_types.js";

const MOST_JOINTS = 10_000;
const MOST_VELOCITIES = 4_000;
const MOST_ROWS = 20_000;

export const ROWS = { "3d": 3, "6d": 6, hinge: 5, distance: 1 };

/** Whether a robot is within the bounds. */
export function checkBounds({ joints, closures, couplings, node }, { element }, diagnostics) {
  const before = diagnostics.errors;
  const report = (place, what, most) => {
    diagnostics.report(
      "file-too-large",
      place,
      `${what}, more than ${most}`,
      "check that it is the file that you mean",
    );
  };
  // With the links that a merge fixes: EU-FIL-002.
  if (joints.length > MOST_JOINTS) report(element, `the robot has ${joints.length} joints`, MOST_JOINTS);
  const velocities = joints.reduce((sum, joint) => sum + JOINT_TYPES[joint.type].velocities, 0);
  if (velocities > MOST_VELOCITIES) report(element, `the joints have ${velocities} velocities`, MOST_VELOCITIES);
  const rows = closures.reduce((sum, closure) => sum + ROWS[closure.type], couplings.length);
  const place = node?.get("closures") ?? node?.get("closed_loop") ?? node?.get("couplings");
  if (rows > MOST_ROWS) report(place, `there are ${rows} constraint rows`, MOST_ROWS);
  return diagnostics.errors === before;
}
