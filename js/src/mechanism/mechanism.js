// The joints, velocities and constraints of a robot. A configuration maps joints to their coordinates, as in files.

import { constraintsOf } from "./constraints.js";
import { Kinematics } from "./kinematics.js";
import { Tree } from "./tree.js";

export class Mechanism {
  constructor(robot) {
    this.robot = robot;
    this.tree = new Tree(robot);
    this.joints = robot.joints;
    this.columns = this.tree.columns; // [joint, index] of each velocity
    this.constraints = constraintsOf(robot, this.tree);
  }

  /** The number of velocities. */
  get nv() {
    return this.columns.length;
  }

  /** Every joint at its neutral. */
  neutral() {
    return this.tree.write(this.tree.read({}));
  }

  /** A configuration of the description, or undefined. */
  named(name) {
    const found = this.robot.configurations.get(name);
    return found && this.tree.write(this.tree.read(Object.fromEntries(found)));
  }

  /** Poses, residuals, K and M at a configuration; what it leaves out is neutral. */
  at(q) {
    return new Kinematics(this, this.tree.read(q));
  }

  /** The configuration after the velocities v (nv) for 1 s. */
  integrate(q, v) {
    return this.tree.write(this.tree.integrate(this.tree.read(q), v));
  }
}
