// What the protocol asks of an accepted robot at a configuration.

const QUANTITIES = {
  poses: (kinematics, frames) => posesOf(kinematics, frames),
  residuals: (kinematics) => kinematics.residuals(),
  jacobian: (kinematics) => kinematics.jacobian(),
  mass_matrix: (kinematics) => kinematics.massMatrix(),
  mass: (kinematics) => kinematics.mass(),
  center_of_mass: (kinematics) => kinematics.centerOfMass(),
};

/** The quantities with the given names; JSON leaves out those that are undefined. */
export function evaluate(mechanism, configuration, frames, quantities) {
  const kinematics = mechanism.at(configuration);
  return Object.fromEntries(quantities.map((name) => [name, QUANTITIES[name](kinematics, frames)]));
}

function posesOf(kinematics, frames) {
  const found = Object.create(null);
  for (const name of frames) {
    const { R, p } = kinematics.pose(name);
    found[name] = { rotation: R, translation: p };
  }
  return found;
}
