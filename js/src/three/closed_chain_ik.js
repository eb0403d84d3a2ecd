// A mechanism for the solver of the npm package closed-chain-ik: links, joints of up to six degrees of freedom, and what closes its loops.

import { Euler, Matrix4, Quaternion, Vector3 } from "three";
import { fromOrigin, subtract } from "../mechanism/spatial.js";
import { matrixOf } from "./shapes.js";

const Z = [0, 0, 1];
const ANGLES = ["EX", "EY", "EZ"]; // about the axes x, y, z, in this order of the package

/**
 * The joints in a row that a joint of each type becomes: the axis that their z is along, their degrees of freedom, and the coordinate
 * of each. Three angles have those of a quaternion, from `quaternion` on.
 */
const ROWS = {
  fixed: () => [{ axis: Z, dof: [], at: [] }],
  revolute: ([axis]) => [{ axis, dof: ["EZ"], at: [0] }],
  continuous: ([axis]) => [{ axis, dof: ["EZ"], at: [0] }],
  prismatic: ([axis]) => [{ axis, dof: ["Z"], at: [0] }],
  helical: ([axis]) => [{ axis, dof: ["Z", "EZ"], at: [null, 0] }],
  cylindrical: ([axis]) => [{ axis, dof: ["Z", "EZ"], at: [0, 1] }],
  universal: (axes) => axes.map((axis, i) => ({ axis, dof: ["EZ"], at: [i] })),
  planar: () => [{ axis: Z, dof: ["X", "Y", "EZ"], at: [0, 1, 2] }],
  spherical: () => [{ axis: Z, dof: ANGLES, at: [], quaternion: 0 }],
  floating: () => [{ axis: Z, dof: ["X", "Y", "Z", ...ANGLES], at: [0, 1, 2], quaternion: 3 }],
};

/**
 * A robot as closed-chain-ik has it, where the robot is. Its solver computes with 24 bits.
 *
 * @param robot {mechanism, q}: what `loadExtendedURDF` gives, or a mechanism and a configuration.
 * @param ik The module: `import * as ik from "closed-chain-ik"`.
 * @returns {root, links, goals, losses, configuration}: the frame to solve from; by name a Link for each link, and what closes each
 *   loop, which is a Goal unless it is a hinge; sentences on what is not held; a function that gives the configuration, as `robot.q`.
 */
export function closedChainIK({ mechanism, q }, ik) {
  const { robot } = mechanism;
  const built = new Tree(mechanism.at(q), ik);
  const losses = [];
  if (robot.root === "floating") built.add({ name: "root_joint", type: "floating", child: robot.rootLink }, q);
  else built.links.set(robot.rootLink, new ik.Link());
  const root = built.links.get(robot.rootLink).parent ?? built.links.get(robot.rootLink);
  for (const joint of robot.joints) {
    built.add(joint, q);
    if (joint.type === "helical") losses.push(`joint '${joint.name}' slides and turns, each by itself: there is no screw`);
    if (joint.mimic) losses.push(`joint '${joint.name}' does not follow '${joint.mimic.joint}': each joint moves by itself`);
  }
  for (const { name } of robot.couplings) losses.push(`coupling '${name}' is not held: each joint moves by itself`);
  const goals = new Map(robot.closures.map((closure) => [closure.name, built.close(closure)]));
  return { root, links: built.links, goals, losses, configuration: () => built.configuration() };
}

class Tree {
  constructor(kinematics, ik) {
    Object.assign(this, { kinematics, ik, links: new Map(), rows: [] });
  }

  add({ name, type, parent, child, placement, after, axes, pitch, leader, lower = [], upper = [] }, q) {
    const coordinates = leader ? [leader.multiplier * q[leader.joint.name][0] + leader.offset] : (q[name] ?? []);
    let above = this.links.get(parent);
    let pose = placement ? matrixOf(placement) : new Matrix4();
    for (const row of ROWS[type](axes)) {
      const turned = turnedTo(row.axis);
      const joint = this.jointIn(above, pose.multiply(turned), row.dof);
      joint.name = name;
      row.at.forEach((coordinate, i) => {
        joint.setMinLimit(joint.dof[i], lower[coordinate] ?? -Infinity);
        joint.setMaxLimit(joint.dof[i], upper[coordinate] ?? Infinity);
        joint.setDoFValue(joint.dof[i], coordinates[coordinate] ?? (pitch / (2 * Math.PI)) * coordinates[0]);
      });
      if (row.quaternion !== undefined) {
        const { x, y, z } = new Euler().setFromQuaternion(new Quaternion(...coordinates.slice(row.quaternion)), "ZYX");
        [x, y, z].forEach((angle, i) => joint.setDoFValue(this.ik.DOF[ANGLES[i]], angle));
      }
      above = new this.ik.Link();
      pose = turned.invert();
      joint.addChild(above);
      if (!leader && row.dof.length) this.rows.push({ ...row, joint, name });
    }
    if (after) pose.multiply(matrixOf(after));
    place(above, pose);
    above.name = child;
    this.links.set(child, above);
  }

  /** A new joint at a pose (Matrix4) in a link. */
  jointIn(link, pose, dof) {
    const joint = place(new this.ik.Joint(), pose);
    joint.setDoF(...dof.map((each) => this.ik.DOF[each]));
    link?.addChild(joint);
    return joint;
  }

  /** A link at a pose (Matrix4) in another one. */
  linkIn(link, pose) {
    const fixed = new this.ik.Link();
    this.jointIn(link, pose, []).addChild(fixed);
    return fixed;
  }

  /** What holds two frames together. */
  close({ type, frames, axes, length }) {
    const { ik } = this;
    const [a, b] = frames.map((frame) => matrixOf(fromOrigin(frame.xyz, frame.rpy)));
    let first = this.links.get(frames[0].link);
    const second = this.links.get(frames[1].link);
    if (type === "hinge") {
      const hinge = this.jointIn(first, a.multiply(turnedTo(axes[0])), ["EZ"]);
      hinge.makeClosure(this.linkIn(second, b.multiply(turnedTo(axes[1]))));
      return hinge;
    }
    if (type === "distance") {
      // A rod of this length, on a ball joint; it begins in the direction of the other end.
      const [from, to] = frames.map((frame) => this.kinematics.pose(frame));
      const across = new Vector3(...subtract(to.p, from.p)).normalize();
      const upright = matrixOf({ ...from, p: [0, 0, 0] }).invert();
      const ball = this.jointIn(first, a.multiply(upright).multiply(turnedTo(across.toArray())), ANGLES);
      first = new ik.Link();
      ball.addChild(first);
      a.makeTranslation(0, 0, length);
    }
    const goal = place(new ik.Goal(), a);
    if (type !== "6d") goal.setFreeDoF(...ANGLES.map((each) => ik.DOF[each]));
    first.addChild(goal);
    goal.makeClosure(this.linkIn(second, b));
    return goal;
  }

  /** The coordinates of the joints, as files have them. */
  configuration() {
    const q = {};
    for (const { name, joint, at, quaternion } of this.rows) {
      q[name] ??= [];
      at.forEach((coordinate, i) => coordinate !== null && (q[name][coordinate] = joint.getDoFValue(joint.dof[i])));
      if (quaternion === undefined) continue;
      const [x, y, z] = ANGLES.map((each) => joint.getDoFValue(this.ik.DOF[each]));
      q[name].push(...new Quaternion().setFromEuler(new Euler(x, y, z, "ZYX")).toArray());
    }
    return q;
  }
}

/** The rotation that brings z to an axis. */
function turnedTo(axis) {
  return new Matrix4().makeRotationFromQuaternion(new Quaternion().setFromUnitVectors(new Vector3(...Z), new Vector3(...axis)));
}

/** Places a frame at a pose (Matrix4) in its parent; its own methods do not move it by less than 1e-5. */
function place(frame, pose) {
  frame.position.set(new Vector3().setFromMatrixPosition(pose).toArray());
  frame.quaternion.set(new Quaternion().setFromRotationMatrix(pose).toArray());
  frame.setMatrixNeedsUpdate();
  return frame;
}
