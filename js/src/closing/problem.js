// A mechanism as the solvers see it: units, position limits, actuators, springs, and groups of loops.
//
// Steps and scaled residuals are dimensionless: angles in rad, lengths in characteristic lengths of the loops.

import { JOINT_TYPES } from "../mechanism/joint_types.js";
import { largest } from "./linear_algebra.js";
import { Loops } from "./loops.js";
import { characteristicLength } from "./scale.js";

const problems = new WeakMap();

/** The problem of a mechanism, made once. */
export function problemOf(mechanism) {
  if (!problems.has(mechanism)) problems.set(mechanism, new Problem(mechanism));
  return problems.get(mechanism);
}

const TRANSLATES = { prismatic: 1, cylindrical: 1, planar: 2, floating: 3 }; // the first so many velocities

export class Problem {
  constructor(mechanism) {
    const { tree, constraints, robot } = mechanism;
    Object.assign(this, { mechanism, tree, constraints, length: characteristicLength(mechanism) });
    const { nv } = tree;
    this.joints = Array(nv); // of each velocity
    this.units = new Float64Array(nv).fill(1);
    this.coordinate = new Int32Array(nv).fill(-1); // index in x of the coordinate that a velocity drives
    this.lower = new Float64Array(nv).fill(-Infinity);
    this.upper = new Float64Array(nv).fill(Infinity);
    const inLoops = new Set(constraints.flatMap((constraint) => constraint.columns));
    for (const joint of tree.joints) if (joint.isFree) this.describe(joint, inLoops);
    this.actuated = new Set(robot.actuators.flatMap(({ joint }) => this.velocitiesOf(joint)));
    this.springs = tree.joints.flatMap((joint) => springsOf(joint));
    this.placed = tree.memory();
  }

  describe(joint, inLoops) {
    const { column, velocities, type, x, source } = joint;
    const drives = JOINT_TYPES[type].coordinates.length === velocities;
    for (let i = 0; i < velocities; i += 1) {
      this.joints[column + i] = joint;
      if (inLoops.has(column) && i < (TRANSLATES[type] ?? 0)) this.units[column + i] = this.length;
      if (!drives) continue;
      this.coordinate[column + i] = x + i;
      const lower = source.lower?.[i] ?? -Infinity;
      const upper = source.upper?.[i] ?? Infinity;
      if (!JOINT_TYPES[type].limited || (lower === 0 && upper === 0)) continue; // EU-URD-025
      this.lower[column + i] = lower;
      this.upper[column + i] = upper;
    }
  }

  /** The joint with this name, which has coordinates of its own. */
  joint(name) {
    const joint = this.tree.byName.get(name);
    if (!joint?.isFree) throw new RangeError(`'${name}' is not a joint with coordinates of its own`);
    return joint;
  }

  velocitiesOf(name) {
    const { column, velocities } = this.joint(name);
    return Array.from({ length: velocities }, (_, i) => column + i);
  }

  /** Loops that share no joint that moves. */
  get groups() {
    this.independent ??= this.connected().map(({ constraints, columns }) => new Loops(this, constraints, columns));
    return this.independent;
  }

  /** All loops. */
  get together() {
    if (!this.all) {
      const columns = [...new Set(this.constraints.flatMap((constraint) => constraint.columns))];
      const all = new Set(columns.flatMap((column) => this.velocitiesOf(this.joints[column].name)));
      this.all = new Loops(this, this.constraints, [...all].sort(ascending));
    }
    return this.all;
  }

  /** The constraints and velocities of each group of loops that share no joint that moves while some are held. */
  connected(held = new Set()) {
    const owner = new Map(); // of each joint that moves, one that stands for its group
    const find = (joint) => {
      let at = joint;
      while (owner.get(at) !== at) at = owner.get(at);
      for (let each = joint; each !== at;) {
        const next = owner.get(each);
        owner.set(each, at);
        each = next;
      }
      return at;
    };
    const moving = this.constraints.map((constraint) => {
      return [...new Set(constraint.columns.filter((each) => !held.has(each)).map((each) => this.joints[each]))];
    });
    for (const joints of moving) {
      for (const joint of joints) if (!owner.has(joint)) owner.set(joint, joint);
      for (const joint of joints) owner.set(find(joint), find(joints[0]));
    }
    const members = new Map();
    this.constraints.forEach((constraint, index) => {
      const key = moving[index].length ? find(moving[index][0]) : constraint;
      if (!members.has(key)) members.set(key, { constraints: [], columns: [] });
      members.get(key).constraints.push(constraint);
    });
    for (const joint of owner.keys()) members.get(find(joint)).columns.push(...this.velocitiesOf(joint.name));
    for (const { columns } of members.values()) columns.sort(ascending);
    return [...members.values()];
  }

  /** The configuration after a motion of one velocity, m or rad. */
  moved(x, velocity, amount) {
    const v = new Float64Array(this.tree.nv);
    v[velocity] = amount;
    return this.tree.integrate(x, v, [this.joints[velocity]]);
  }

  /** The largest row of all residuals, m or rad. */
  largestResidual(x) {
    return largest(this.together.residual(x));
  }
}

const ascending = (a, b) => a - b;

/** Of each spring {column, x, stiffness, ratio, shift}: its deflection is ratio · coordinate + shift. */
function springsOf({ source, x, column, multiplier, offset, velocities }) {
  if (!source.stiffness) return [];
  return Array.from({ length: velocities }, (_, i) => ({
    column: column + i,
    x: x + i,
    stiffness: source.stiffness[i],
    ratio: multiplier,
    shift: offset - source.rest[i],
  })).filter(({ stiffness }) => stiffness);
}
