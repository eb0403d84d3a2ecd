// The bounds of a robot, EU-FIL-002.

import { fail } from "./invalid.js";
import { JOINT_TYPES } from "../mechanism/joint_types.js";

const MOST_JOINTS = 10_000;
const MOST_VELOCITIES = 4_000;
const MOST_ROWS = 20_000;

export const ROWS = { "3d": 3, "6d": 6, hinge: 5, distance: 1 };

export function checkBounds(robot) {
  const joints = robot.joints.length; // with the links that a merge fixes: EU-FIL-002
  if (joints > MOST_JOINTS) fail(`the robot has ${joints} joints, more than ${MOST_JOINTS}`);
  const velocities = robot.joints.reduce((sum, joint) => sum + JOINT_TYPES[joint.type].velocities, 0);
  if (velocities > MOST_VELOCITIES) fail(`the joints have ${velocities} velocities, more than ${MOST_VELOCITIES}`);
  const rows = robot.closures.reduce((sum, closure) => sum + ROWS[closure.type], robot.couplings.length);
  if (rows > MOST_ROWS) fail(`there are ${rows} constraint rows, more than ${MOST_ROWS}`);
}
