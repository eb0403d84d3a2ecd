// The spanning tree in index arrays: the table of transforms and velocities in the chapter on joints.
//
// A configuration is an array x with the coordinates of each joint, in the order of the columns. A motion is one
// velocity of one joint; those of a mimic joint belong to the columns of its leader. Its twist is that of the body in
// the world: the velocity of the body's point at `origin`, a point near the robot, and its rotation.

import { JOINT_TYPES, neutral, quaternionAt } from "./joint_types.js";
import { IDENTITY, SIZE, compose, write, writeQuaternion, writeRotation } from "./poses.js";
import { multiplied, displacement, normalized, quaternionOf } from "./motion.js";
import { NO_MOTION, add, apply, fromQuaternion, rotation } from "./spatial.js";

export const ROOT = "root_joint";
const X = [1, 0, 0];
const Y = [0, 1, 0];
const Z = [0, 0, 1];
const AXES = [X, Y, Z];

export class Tree {
  constructor(robot) {
    this.bodies = new Map(); // numbers of the bodies, by name: links, and what is between the two joints of a split one
    for (const name of [...robot.links.keys(), ...robot.joints.map(({ child }) => child)]) {
      if (!this.bodies.has(name)) this.bodies.set(name, this.bodies.size);
    }
    this.root = this.bodies.get(robot.rootLink);
    this.columns = []; // [joint, index]
    this.coordinates = 0;
    this.motions = 0;
    this.byName = new Map();
    this.joints = [];
    if (robot.root === "floating") {
      const child = robot.rootLink;
      this.add({ name: ROOT, type: "floating", child, placement: NO_MOTION, after: NO_MOTION, axes: [] });
    }
    for (const joint of robot.joints) this.add(joint);
    for (const joint of this.joints) this.follow(joint);
    this.above = new Int32Array(this.bodies.size).fill(-1); // of each body the joint that moves it
    this.depth = new Int32Array(this.bodies.size);
    this.joints.forEach(({ parent, child }, index) => {
      this.above[child] = index;
      this.depth[child] = parent < 0 ? 0 : this.depth[parent] + 1;
    });
    this.columnOf = new Int32Array(this.motions); // of each motion
    this.jointOf = new Int32Array(this.motions);
    this.joints.forEach(({ motion, column, velocities }, index) => {
      for (let i = 0; i < velocities; i += 1) {
        this.columnOf[motion + i] = column + i;
        this.jointOf[motion + i] = index;
      }
    });
    [this.at, this.moved, this.own] = [0, 1, 2].map(() => new Float64Array(SIZE)); // working memory
  }

  get nv() {
    return this.columns.length;
  }

  add(source) {
    const { name, type, parent, child, axes, pitch } = source;
    const { velocities, coordinates } = JOINT_TYPES[type];
    const joint = { name, type, axes, velocities, source, multiplier: 1, offset: 0, motion: this.motions };
    joint.parent = parent === undefined ? -1 : this.bodies.get(parent);
    joint.child = this.bodies.get(child);
    joint.k = pitch === undefined ? 0 : pitch / (2 * Math.PI); // m/rad
    joint.placement = new Float64Array(SIZE);
    joint.after = new Float64Array(SIZE);
    write(joint.placement, 0, source.placement);
    write(joint.after, 0, source.after);
    this.motions += velocities;
    this.joints.push(joint);
    if (source.isLock) return;
    this.byName.set(name, joint);
    joint.isRoot = joint.parent < 0;
    if (source.leader || type === "fixed") return;
    joint.isFree = true; // it has coordinates of its own
    joint.column = this.columns.length;
    joint.x = this.coordinates;
    joint.quaternion = quaternionAt(type) < 0 ? -1 : joint.x + quaternionAt(type);
    this.coordinates += coordinates.length;
    joint.end = this.coordinates;
    for (let i = 0; i < velocities; i += 1) this.columns.push([name, i]);
  }

  /** A mimic joint has the coordinate of its leader, EU-URD-032. */
  follow(joint) {
    const { leader } = joint.source;
    if (!leader) return;
    const { column, x } = this.byName.get(leader.joint.name);
    Object.assign(joint, { column, x, multiplier: leader.multiplier, offset: leader.offset });
  }

  /** The joint that moves the parent of a joint, or undefined. */
  jointAbove({ parent }) {
    return parent < 0 ? undefined : this.joints[this.above[parent]];
  }

  /**
   * The array of a mapping from joints to coordinates; what is missing is neutral.
   *
   * Throws a RangeError if it names what is no joint with coordinates of its own, or if coordinates are missing or not
   * finite.
   */
  read(configuration) {
    const x = new Float64Array(this.coordinates);
    for (const joint of this.joints) if (joint.isFree) x.set(neutral(joint.type), joint.x);
    for (const [name, given] of Object.entries(configuration)) {
      const joint = this.byName.get(name);
      if (!joint?.isFree) throw new RangeError(`'${name}' is not a joint with coordinates of its own`);
      const count = joint.end - joint.x;
      if (given?.length !== count || !given.every(Number.isFinite)) {
        throw new RangeError(`joint '${name}' is at [${given}]: give ${count} finite number${count > 1 ? "s" : ""}`);
      }
      if (joint.quaternion >= 0 && !given.slice(-4).some(Boolean)) {
        throw new RangeError(`joint '${name}' has the quaternion 0: give one of unit length`);
      }
      x.set(given, joint.x);
    }
    return x;
  }

  /** The mapping of an array. */
  write(x) {
    const configuration = Object.create(null);
    for (const { isFree, name, type, x: first } of this.joints) {
      if (isFree) configuration[name] = Array.from(x.subarray(first, first + JOINT_TYPES[type].coordinates.length));
    }
    return configuration;
  }

  /** The lowest body that carries all of some bodies, or is one of them; the root's of none. */
  common(bodies) {
    return bodies.length ? bodies.reduce((a, b) => this.commonOf(a, b)) : this.root;
  }

  commonOf(a, b) {
    let [one, other] = [a, b];
    while (one !== other) {
      if (this.depth[one] < this.depth[other]) [one, other] = [other, one];
      one = this.joints[this.above[one]].parent;
    }
    return one;
  }

  /** The joints from a body, which carries the others, to these, outwards; from the world if the body is -1. */
  jointsBetween(base, bodies) {
    const found = new Set();
    for (const body of bodies) {
      for (let at = body; at !== base; at = this.joints[this.above[at]].parent) {
        if (this.above[at] < 0 || found.has(this.above[at])) break;
        found.add(this.above[at]);
      }
    }
    return [...found].sort((a, b) => a - b).map((index) => this.joints[index]);
  }

  /** The array after the velocities v (nv), of some joints, for 1 s. */
  integrate(x, v, joints = this.joints) {
    const after = Float64Array.from(x);
    for (const { isFree, type, x: i, column, velocities } of joints) {
      if (!isFree) continue;
      if (type in INTEGRATED) {
        const own = Array.from(v.slice(column, column + velocities));
        if (own.some(Boolean)) after.set(INTEGRATED[type](Array.from(x.subarray(i, i + 7)), own), i);
      } else for (let k = 0; k < velocities; k += 1) after[i + k] += v[column + k];
    }
    return after;
  }

  /** Memory for poses of links, and for twists of motions (v and w): the root link is at the origin of the world. */
  memory() {
    const placed = {
      poses: new Float64Array(SIZE * this.bodies.size),
      twists: new Float64Array(6 * this.motions),
      origin: [0, 0, 0],
    };
    placed.poses.set(IDENTITY, SIZE * this.root);
    return placed;
  }

  /** Writes the poses and twists of some joints, each of which comes after that of its parent. */
  place(x, placed, joints = this.joints) {
    const { poses } = placed;
    for (const joint of joints) {
      const [at, moved] = [this.at, this.moved];
      if (joint.parent < 0) at.set(joint.placement);
      else compose(at, 0, poses, joint.parent * SIZE, joint.placement, 0);
      transform(joint, x, this.own);
      compose(moved, 0, at, 0, this.own, 0);
      compose(poses, joint.child * SIZE, moved, 0, joint.after, 0);
      this.move(joint, at, moved, placed);
    }
  }

  /** The motion of the moved frame along each velocity, EU-JNT-026. */
  move({ type, axes, k, motion, multiplier }, at, moved, { twists, origin }) {
    const turns = (i, R, axis, slide = 0) => twist(twists, motion + i, R, axis, multiplier, slide, origin);
    const slides = (i, axis) => twist(twists, motion + i, moved, axis, 0, multiplier, origin);
    switch (type) {
      case "fixed":
        break;
      case "revolute":
      case "continuous":
        turns(0, moved, axes[0]);
        break;
      case "prismatic":
        slides(0, axes[0]);
        break;
      case "helical":
        turns(0, moved, axes[0], k * multiplier);
        break;
      case "cylindrical":
        slides(0, axes[0]);
        turns(1, moved, axes[0]);
        break;
      case "universal":
        turns(0, at, axes[0]);
        turns(1, moved, axes[1]);
        break;
      case "planar":
        slides(0, X);
        slides(1, Y);
        turns(2, moved, Z);
        break;
      default: {
        // spherical and floating
        if (type === "floating") AXES.forEach((axis, i) => slides(i, axis));
        AXES.forEach((axis, i) => turns((type === "floating" ? 3 : 0) + i, moved, axis));
      }
    }
  }
}

// For each type whose coordinates are not simply increased: what they are after a motion.
const INTEGRATED = {
  planar: ([x, y, angle], [vx, vy, w]) => {
    const moved = apply(rotation(Z, angle), displacement([vx, vy, 0], [0, 0, w]));
    return [x + moved[0], y + moved[1], angle + w];
  },
  spherical: (q, w) => normalized(multiplied(q, quaternionOf(w))),
  floating: ([x, y, z, ...q], v) => {
    const [linear, angular] = [v.slice(0, 3), v.slice(3)];
    const p = add([x, y, z], apply(fromQuaternion(q.slice(0, 4)), displacement(linear, angular)));
    return [...p, ...normalized(multiplied(q, quaternionOf(angular)))];
  },
};

/** Writes the pose of a joint's moved frame in its frame, EU-JNT-025. */
function transform({ type, axes, k, x: i, multiplier, offset }, x, own) {
  own.set(IDENTITY);
  const slide = ([a, b, c], d) => own.set([d * a, d * b, d * c], 9);
  switch (type) {
    case "fixed":
      break;
    case "revolute":
    case "continuous":
      writeRotation(own, 0, axes[0], multiplier * x[i] + offset);
      break;
    case "prismatic":
      slide(axes[0], multiplier * x[i] + offset);
      break;
    case "helical":
      writeRotation(own, 0, axes[0], x[i]);
      slide(axes[0], k * x[i]);
      break;
    case "cylindrical":
      writeRotation(own, 0, axes[0], x[i + 1]);
      slide(axes[0], x[i]);
      break;
    case "universal": {
      const [first, second] = [Float64Array.from(IDENTITY), Float64Array.from(IDENTITY)];
      writeRotation(first, 0, axes[0], x[i]);
      writeRotation(second, 0, axes[1], x[i + 1]);
      compose(own, 0, first, 0, second, 0);
      break;
    }
    case "planar":
      writeRotation(own, 0, Z, x[i + 2]);
      own.set([x[i], x[i + 1], 0], 9);
      break;
    default: // spherical and floating
      writeQuaternion(own, 0, x, i + quaternionAt(type));
      if (type === "floating") own.set(x.subarray(i, i + 3), 9);
  }
}

/** Writes a twist: a turn about an axis of the frame `at` through its origin, and a slide along the axis. */
function twist(twists, index, at, [a, b, c], turn, slide, origin) {
  const x = at[0] * a + at[1] * b + at[2] * c;
  const y = at[3] * a + at[4] * b + at[5] * c;
  const z = at[6] * a + at[7] * b + at[8] * c;
  const px = at[9] - origin[0];
  const py = at[10] - origin[1];
  const pz = at[11] - origin[2];
  const i = 6 * index;
  twists[i] = slide * x + turn * (py * z - pz * y);
  twists[i + 1] = slide * y + turn * (pz * x - px * z);
  twists[i + 2] = slide * z + turn * (px * y - py * x);
  twists[i + 3] = turn * x;
  twists[i + 4] = turn * y;
  twists[i + 5] = turn * z;
}
