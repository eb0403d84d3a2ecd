// Poses and motions of links: the table of transforms and velocities in the chapter on joints.
// A twist {v, w} is that of a body in the world: the velocity of its point at the world's origin, and its rotation.

import { JOINT_TYPES, neutral, quaternionAt } from "./joint_types.js";
import {
  NO_MOTION,
  add,
  apply,
  applyTransposed,
  compose,
  cross,
  fromOrigin,
  fromQuaternion,
  multiply,
  rotation,
  scale,
} from "./spatial.js";

const X = [1, 0, 0];
const Y = [0, 1, 0];
const Z = [0, 0, 1];
const NONE = [0, 0, 0];

/** The mechanism at one configuration: a mapping from joints to coordinates. */
export class Kinematics {
  constructor(robot, configuration) {
    this.robot = robot;
    this.q = configuration;
    this.poses = new Map();
    this.movers = new Map(); // a link → {parent, motions}: [column, twist] of the joint that moves it
    this.columns = []; // [joint, index]
    this.first = new Map(); // a joint → its first column
    this.number(robot);
    this.placeRoot(robot);
    for (const joint of robot.joints) this.place(joint);
  }

  number({ root, joints }) {
    const free = joints.filter((joint) => !joint.mimic && joint.type !== "fixed");
    for (const { name, type } of root === "floating" ? [{ name: "root_joint", type: "floating" }, ...free] : free) {
      this.first.set(name, this.columns.length);
      for (let i = 0; i < JOINT_TYPES[type].velocities; i += 1) this.columns.push([name, i]);
    }
  }

  placeRoot({ root, rootLink }) {
    if (root === "fixed") {
      this.poses.set(rootLink, NO_MOTION);
      return;
    }
    const joint = { name: "root_joint", type: "floating" };
    this.poses.set(rootLink, transform(joint, this.coordinates(joint)));
    this.movers.set(rootLink, { parent: null, motions: this.motions(joint, this.poses.get(rootLink), null) });
  }

  place(joint) {
    const q = this.coordinates(joint);
    const frame = compose(compose(this.poses.get(joint.parent), joint.placement), transform(joint, q));
    this.poses.set(joint.child, compose(frame, joint.after));
    this.movers.set(joint.child, { parent: joint.parent, motions: this.motions(joint, frame, q) });
  }

  /** The coordinates of a joint; those of a mimic joint follow its leader, EU-URD-032. */
  coordinates({ name, type, leader }) {
    if (!leader) return Object.hasOwn(this.q, name) ? this.q[name] : neutral(type);
    return [leader.multiplier * this.coordinates(leader.joint)[0] + leader.offset];
  }

  motions(joint, frame, q) {
    const column = this.first.get(joint.leader?.joint.name ?? joint.name);
    const factor = joint.leader?.multiplier ?? 1;
    return subspace(joint, q).map(({ v, w }, i) => {
      const turning = scale(factor, apply(frame.R, w));
      const moving = scale(factor, apply(frame.R, v));
      return [column + i, { v: add(moving, cross(frame.p, turning)), w: turning }];
    });
  }

  /** The pose of a frame {link, xyz, rpy} in the world. */
  pose({ link, xyz, rpy }) {
    return compose(this.poses.get(link), fromOrigin(xyz, rpy));
  }

  /** The twists of a link along each velocity that moves it, by column. */
  twists(link) {
    const found = new Map();
    for (let at = this.movers.get(link); at; at = this.movers.get(at.parent)) {
      for (const [column, { v, w }] of at.motions) {
        const other = found.get(column) ?? { v: NONE, w: NONE };
        found.set(column, { v: add(other.v, v), w: add(other.w, w) });
      }
    }
    return found;
  }
}

/** The pose of a joint's moved frame in its frame, EU-JNT-025. */
function transform({ type, axes, pitch }, q) {
  const turned = (axis, angle) => ({ R: rotation(axis, angle), p: NONE });
  switch (type) {
    case "fixed":
      return NO_MOTION;
    case "revolute":
    case "continuous":
      return turned(axes[0], q[0]);
    case "prismatic":
      return { R: NO_MOTION.R, p: scale(q[0], axes[0]) };
    case "helical":
      return { R: rotation(axes[0], q[0]), p: scale((pitch / (2 * Math.PI)) * q[0], axes[0]) };
    case "cylindrical":
      return { R: rotation(axes[0], q[1]), p: scale(q[0], axes[0]) };
    case "universal":
      return { R: multiply(rotation(axes[0], q[0]), rotation(axes[1], q[1])), p: NONE };
    case "planar":
      return { R: rotation(Z, q[2]), p: [q[0], q[1], 0] };
    default: // spherical and floating
      return { R: fromQuaternion(q.slice(quaternionAt(type))), p: type === "floating" ? q.slice(0, 3) : NONE };
  }
}

/** The motion of the moved frame along each velocity, expressed in that frame, EU-JNT-026. */
function subspace({ type, axes, pitch }, q) {
  const turns = (w) => ({ v: NONE, w });
  const slides = (v) => ({ v, w: NONE });
  switch (type) {
    case "fixed":
      return [];
    case "revolute":
    case "continuous":
      return [turns(axes[0])];
    case "prismatic":
      return [slides(axes[0])];
    case "helical":
      return [{ v: scale(pitch / (2 * Math.PI), axes[0]), w: axes[0] }];
    case "cylindrical":
      return [slides(axes[0]), turns(axes[0])];
    case "universal":
      return [turns(applyTransposed(rotation(axes[1], q[1]), axes[0])), turns(axes[1])];
    case "planar":
      return [slides(X), slides(Y), turns(Z)];
    case "spherical":
      return [turns(X), turns(Y), turns(Z)];
    default: // floating
      return [slides(X), slides(Y), slides(Z), turns(X), turns(Y), turns(Z)];
  }
}
