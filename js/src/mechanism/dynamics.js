// Mass, centre of mass and mass matrix, EU-INR-005 and -006, EU-JNT-032.

import { SIZE, read } from "./poses.js";
import { add, compose, multiply, scale, subtract, transpose } from "./spatial.js";

function* massiveLinks({ mechanism, placed }) {
  for (const { name, mass, inertia } of mechanism.robot.links.values()) {
    if (!inertia) continue;
    const link = mechanism.tree.bodies.get(name);
    const { R, p } = compose(read(placed.poses, SIZE * link), inertia.pose);
    yield { link, mass, center: p, inertia: multiply(multiply(R, inertia.matrix), transpose(R)) };
  }
}

export function mass(robot) {
  return [...robot.links.values()].reduce((sum, link) => sum + link.mass, 0);
}

/** In the world (m), or undefined if the mass is 0. */
export function centerOfMass(kinematics) {
  const total = mass(kinematics.mechanism.robot);
  if (total === 0) return undefined;
  const moments = [...massiveLinks(kinematics)].map((link) => scale(link.mass, link.center));
  return scale(1 / total, moments.reduce(add, [0, 0, 0]));
}

/**
 * M, a list of rows: the momentum of all that a motion carries, along each motion of the joints above it
 * (composite rigid bodies; Walker, Orin, 1982).
 */
export function massMatrix(kinematics) {
  const { tree, columns } = kinematics.mechanism;
  const { twists } = kinematics.placed;
  const matrix = columns.map(() => columns.map(() => 0));
  const carried = compositeInertias(kinematics);
  tree.joints.forEach((joint) => {
    for (let i = 0; i < joint.velocities; i += 1) {
      const own = joint.motion + i;
      const momentum = momentumOf(carried[joint.child], twists, 6 * own);
      const along = (motion, factor) => {
        let energy = 0;
        for (let k = 0; k < 6; k += 1) energy += twists[6 * motion + k] * momentum[k];
        matrix[tree.columnOf[own]][tree.columnOf[motion]] += factor * energy;
        matrix[tree.columnOf[motion]][tree.columnOf[own]] += factor * energy;
      };
      along(own, 0.5);
      for (let k = 0; k < i; k += 1) along(joint.motion + k, 1);
      for (let j = tree.jointAbove(joint); j; j = tree.jointAbove(j)) {
        for (let k = 0; k < j.velocities; k += 1) along(j.motion + k, 1);
      }
    }
  });
  for (const { type, column, multiplier, source } of tree.joints) {
    if (type === "fixed") continue;
    (source.armature ?? []).forEach((armature, i) => {
      matrix[column + i][column + i] += multiplier ** 2 * armature;
    });
  }
  return matrix;
}

/** Of each link, with all that it carries: the mass, its first moment, and its inertia about `origin`, row by row. */
function compositeInertias(kinematics) {
  const { tree } = kinematics.mechanism;
  const carried = Array.from(tree.bodies, () => ({ mass: 0, moment: [0, 0, 0], inertia: new Float64Array(9) }));
  for (const { link, mass, center, inertia } of massiveLinks(kinematics)) {
    const c = subtract(center, kinematics.placed.origin);
    const square = c[0] * c[0] + c[1] * c[1] + c[2] * c[2];
    const about = carried[link];
    about.mass += mass;
    about.moment = add(about.moment, scale(mass, c));
    for (let i = 0; i < 3; i += 1) {
      for (let j = 0; j < 3; j += 1)
        about.inertia[3 * i + j] += inertia[i][j] + mass * ((i === j ? square : 0) - c[i] * c[j]);
    }
  }
  for (const { parent, child } of tree.joints.toReversed()) {
    if (parent < 0) continue;
    carried[parent].mass += carried[child].mass;
    carried[parent].moment = add(carried[parent].moment, carried[child].moment);
    carried[child].inertia.forEach((each, i) => (carried[parent].inertia[i] += each));
  }
  return carried;
}

/** The momentum, and the angular momentum about `origin`, of an inertia that moves along the twist at t[i]. */
function momentumOf({ mass, moment: [x, y, z], inertia }, t, i) {
  const [v0, v1, v2, w0, w1, w2] = t.subarray(i, i + 6);
  return [
    mass * v0 + w1 * z - w2 * y,
    mass * v1 + w2 * x - w0 * z,
    mass * v2 + w0 * y - w1 * x,
    inertia[0] * w0 + inertia[1] * w1 + inertia[2] * w2 + y * v2 - z * v1,
    inertia[3] * w0 + inertia[4] * w1 + inertia[5] * w2 + z * v0 - x * v2,
    inertia[6] * w0 + inertia[7] * w1 + inertia[8] * w2 + x * v1 - y * v0,
  ];
}
