// A mechanism at one configuration: poses, residuals, K and M.

import { centerOfMass, mass, massMatrix } from "./dynamics.js";
import { SIZE, read } from "./poses.js";
import { compose, fromOrigin } from "./spatial.js";
import { ROOT } from "./tree.js";

export class Kinematics {
  /** `x`: the coordinates, as `mechanism.tree` has them. */
  constructor(mechanism, x) {
    this.mechanism = mechanism;
    this.x = x;
    this.placed = mechanism.tree.memory();
    if (mechanism.tree.byName.get(ROOT)?.isRoot) this.placed.origin = Array.from(x.subarray(0, 3));
    mechanism.tree.place(x, this.placed);
  }

  /** The pose {R, p} in the world of a link, or of a frame: its name, or {link, xyz, rpy}. */
  pose(frame) {
    const { tree, robot } = this.mechanism;
    const bodyPose = (body) => read(this.placed.poses, tree.bodies.get(body) * SIZE);
    if (robot.links.has(frame)) return bodyPose(frame);
    const { link, xyz, rpy } = typeof frame === "string" ? robot.frameOf(frame) : frame;
    return compose(bodyPose(link), fromOrigin(xyz, rpy));
  }

  /** The residual of every closure and coupling, by name. */
  residuals() {
    const found = Object.create(null);
    for (const constraint of this.mechanism.constraints)
      found[constraint.name] = constraint.residual(this.x, this.placed);
    return found;
  }

  /** {columns, rows} of the constraint Jacobian: rows by name. */
  jacobian() {
    const { columns } = this.mechanism;
    const rows = Object.create(null);
    for (const constraint of this.mechanism.constraints) {
      rows[constraint.name] = Array.from({ length: constraint.rows }, () => columns.map(() => 0));
      constraint.differentiate(this.placed, (column, row, rate) => (rows[constraint.name][row][column] += rate));
    }
    return { columns, rows };
  }

  /** {columns, matrix}: the kinetic energy is ½ vᵀ M v. */
  massMatrix() {
    return { columns: this.mechanism.columns, matrix: massMatrix(this) };
  }

  mass() {
    return mass(this.mechanism.robot);
  }

  /** In the world (m), or undefined if the mass is 0. */
  centerOfMass() {
    return centerOfMass(this);
  }
}
