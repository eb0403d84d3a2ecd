// Some constraints, and the velocities that may meet them.

import { IDENTITY, SIZE } from "../mechanism/poses.js";

export class Loops {
  /** `base`: the body that the poses are relative to; by default the lowest one that all loops have in common. */
  constructor(problem, constraints, columns, base = problem.tree.common(constraints.flatMap(({ bodies }) => bodies))) {
    Object.assign(this, { problem, constraints, columns, base });
    const { length, tree } = problem;
    this.n = columns.length;
    this.units = Float64Array.from(columns, (column) => problem.units[column]);
    this.scale = Float64Array.from(
      constraints.flatMap(({ units, size = 1 }) => units.map((unit) => (unit === "m" ? 1 / length : 1) / size)),
    );
    this.work = this.scale.length * this.n * Math.min(this.scale.length, this.n); // multiplications of a descent's step
    this.index = new Map(columns.map((column, i) => [column, i]));
    this.joints = tree.jointsBetween(
      base,
      constraints.flatMap(({ bodies }) => bodies),
    );
    this.moving = [...new Set(columns.map((column) => problem.joints[column]))];
  }

  /** The poses and twists at x; they are overwritten by those of other loops of the same robot. */
  place(x) {
    const { placed, tree } = this.problem;
    placed.poses.set(IDENTITY, SIZE * this.base);
    tree.place(x, placed, this.joints);
    return placed;
  }

  /** The residual (m), m and rad. */
  residual(x) {
    const placed = this.place(x);
    const r = new Float64Array(this.scale.length);
    let row = 0;
    for (const constraint of this.constraints) {
      r.set(constraint.residual(x, placed), row);
      row += constraint.rows;
    }
    return r;
  }

  /** The dimensionless residual. */
  scaled(r) {
    return r.map((row, i) => this.scale[i] * row);
  }

  /** The rows (m) of K (n each) at x, dimensionless. */
  jacobian(x) {
    const placed = this.place(x);
    const K = Array.from(this.scale, () => new Float64Array(this.n));
    let first = 0;
    for (const constraint of this.constraints) {
      constraint.differentiate(placed, (column, row, rate) => {
        const i = this.index.get(column);
        if (i !== undefined) K[first + row][i] += this.scale[first + row] * this.units[i] * rate;
      });
      first += constraint.rows;
    }
    return K;
  }

  /** The configuration after a dimensionless step (n). */
  moved(x, step) {
    const v = new Float64Array(this.problem.tree.nv);
    for (let i = 0; i < this.n; i += 1) v[this.columns[i]] = this.units[i] * step[i];
    return this.problem.tree.integrate(x, v, this.moving);
  }

  /** How far each constraint is open. */
  openings(x) {
    const placed = this.place(x);
    return this.constraints.map((each) => ({ name: each.name, ...each.opening(x, placed) }));
  }
}
