// Mass, centre of mass and mass matrix, EU-INR-005 and -006, EU-JNT-032.

import { add, apply, compose, cross, dot, multiply, scale, transpose } from "./spatial.js";

function* massiveLinks({ robot, poses }) {
  for (const { name, mass, inertia } of robot.links.values()) {
    if (!inertia) continue;
    const { R, p } = compose(poses.get(name), inertia.pose);
    yield { name, mass, center: p, inertia: multiply(multiply(R, inertia.matrix), transpose(R)) };
  }
}

export function mass({ robot }) {
  return [...robot.links.values()].reduce((sum, link) => sum + link.mass, 0);
}

/** In the world (m), or undefined if the mass is 0. */
export function centerOfMass(kinematics) {
  const total = mass(kinematics);
  if (total === 0) return undefined;
  const moments = [...massiveLinks(kinematics)].map((link) => scale(link.mass, link.center));
  return scale(1 / total, moments.reduce(add, [0, 0, 0]));
}

/** {columns, matrix}: the kinetic energy is ½ vᵀ M v. */
export function massMatrix(kinematics) {
  const { columns, first, robot } = kinematics;
  const matrix = columns.map(() => columns.map(() => 0));
  for (const link of massiveLinks(kinematics)) {
    const motions = [...kinematics.twists(link.name)].map(([column, { v, w }]) => {
      const velocity = add(v, cross(w, link.center));
      return { column, w, velocity, momentum: scale(link.mass, velocity), spin: apply(link.inertia, w) };
    });
    for (const one of motions) {
      for (const other of motions) {
        matrix[one.column][other.column] += dot(one.velocity, other.momentum) + dot(one.w, other.spin);
      }
    }
  }
  for (const joint of robot.joints) {
    if (joint.type === "fixed") continue;
    const column = first.get(joint.leader?.joint.name ?? joint.name);
    const factor = (joint.leader?.multiplier ?? 1) ** 2;
    joint.armature.forEach((armature, i) => {
      matrix[column + i][column + i] += factor * armature;
    });
  }
  return { columns, matrix };
}
