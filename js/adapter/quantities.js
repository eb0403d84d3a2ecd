// What the protocol asks of an accepted robot at a configuration.

import { centerOfMass, mass, massMatrix } from "../src/mechanism/dynamics.js";
import { Kinematics } from "../src/mechanism/kinematics.js";
import { jacobian, residuals } from "../src/mechanism/residuals.js";

const QUANTITIES = {
  poses: (kinematics, frames) => posesOf(kinematics, frames),
  residuals,
  jacobian,
  mass_matrix: massMatrix,
  mass,
  center_of_mass: centerOfMass,
};

/** The quantities with the given names; JSON leaves out those that are undefined. */
export function evaluate(robot, configuration, frames, quantities) {
  const kinematics = new Kinematics(robot, configuration);
  return Object.fromEntries(quantities.map((name) => [name, QUANTITIES[name](kinematics, frames)]));
}

function posesOf(kinematics, frames) {
  const found = Object.create(null);
  for (const name of frames) {
    const { R, p } = kinematics.pose(kinematics.robot.frameOf(name));
    found[name] = { rotation: R, translation: p };
  }
  return found;
}
