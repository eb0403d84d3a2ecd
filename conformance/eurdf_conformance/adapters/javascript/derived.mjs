// Quantities that finite numbers may give beyond the range of a double, EU-INR-007. Those of an actuator and of a helical
// joint are checked where they are computed.

import { fail } from "./invalid.mjs";
import { Kinematics } from "./kinematics.mjs";
import { compose, dot, multiply, norm, subtract, transpose } from "./spatial.mjs";

export function checkDerived(robot) {
  const zero = new Kinematics(atZero(robot), {});
  const frames = [...robot.allFrames, ...robot.closures.flatMap((closure) => closure.frames)];
  for (const link of robot.links.keys()) checkPose(zero.poses.get(link), `link '${link}'`);
  for (const frame of frames) checkPose(zero.pose(frame), `a frame on '${frame.link}'`);
  checkInertias(robot, zero);
  checkLeaders(robot.joints);
  for (const { name, joints, offset } of robot.couplings) {
    const sizes = [...joints.values()].map(Math.abs);
    finite(
      sizes.reduce((sum, size) => sum + size, 0),
      `the sum of the coefficients of coupling '${name}'`,
    );
    finite(offset / Math.max(...sizes), `the offset of coupling '${name}' for its largest coefficient`);
  }
}

function finite(number, what) {
  if (!Number.isFinite(number)) fail(`${what} is ${number}: not finite`);
}

/** "At zero" each joint is at its neutral, also a mimic joint. */
function atZero(robot) {
  const joints = robot.joints.map((joint) => ({ ...joint, leader: undefined, mimic: null }));
  return { ...robot, root: "fixed", joints };
}

function checkPose({ R, p }, what) {
  R.flat().forEach((number) => finite(number, `the rotation of ${what}`));
  p.forEach((number) => finite(number, `the position of ${what}`));
  finite(norm(p), `the distance of ${what}`);
}

/** The mass and inertia of each set of links that fixed joints connect, about the origin of the joint that moves it. */
function checkInertias(robot, zero) {
  const sets = new Map([[robot.rootLink, { origin: [0, 0, 0], mass: 0, inertia: Array(9).fill(0) }]]);
  for (const joint of robot.joints) {
    const origin = compose(zero.poses.get(joint.parent), joint.placement).p;
    const fresh = { origin, mass: 0, inertia: Array(9).fill(0) };
    sets.set(joint.child, joint.type === "fixed" ? sets.get(joint.parent) : fresh);
  }
  for (const { name, mass, inertia } of robot.links.values()) {
    if (!inertia) continue;
    const set = sets.get(name);
    const { R, p } = compose(zero.poses.get(name), inertia.pose);
    const arm = subtract(p, set.origin);
    const turned = multiply(multiply(R, inertia.matrix), transpose(R));
    set.mass += mass;
    set.inertia = set.inertia.map((sum, k) => {
      const [i, j] = [Math.floor(k / 3), k % 3];
      return sum + turned[i][j] + mass * ((i === j ? dot(arm, arm) : 0) - arm[i] * arm[j]);
    });
    finite(set.mass, `the mass of the body of '${name}'`);
    set.inertia.forEach((number) => finite(number, `the inertia of the body of '${name}'`));
  }
}

function checkLeaders(joints) {
  const sums = new Map();
  for (const joint of joints) {
    if (!joint.leader) continue;
    const { multiplier: m, offset, joint: leader } = joint.leader;
    const what = `of mimic joint '${joint.name}' at its leader`;
    finite(m, `the multiplier ${what}`);
    finite(offset, `the offset ${what}`);
    const [stiffness] = joint.stiffness ?? [0];
    const added = [
      m * m * joint.armature[0],
      m * m * joint.damping[0],
      Math.abs(m) * joint.friction[0],
      m * m * stiffness,
    ];
    const own = sums.get(leader) ?? [
      leader.armature[0],
      leader.damping[0],
      leader.friction[0],
      leader.stiffness?.[0] ?? 0,
    ];
    sums.set(
      leader,
      own.map((number, i) => number + added[i]),
    );
    [...added, ...sums.get(leader)].forEach((number) => finite(number, `a property ${what}`));
  }
}
