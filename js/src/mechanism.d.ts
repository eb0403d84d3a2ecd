import type { Configuration, Frame, Joint, Pose, Robot } from "./index.js";

/** [joint, index of its velocity] of each column. */
export type Columns = [string, number][];

/** The joints, velocities and constraints of a robot. */
export class Mechanism {
  constructor(robot: Robot);
  readonly robot: Robot;
  readonly joints: Joint[];
  readonly nv: number;
  readonly columns: Columns;
  neutral(): Configuration;
  /** A configuration of the description. */
  named(name: string): Configuration | undefined;
  at(q: Configuration): Kinematics;
  /** The configuration after the velocities v (nv) for 1 s. */
  integrate(q: Configuration, v: ArrayLike<number>): Configuration;
}

/** A mechanism at one configuration; rows of residuals are in m and rad. */
export class Kinematics {
  private constructor();
  /** In the world, of a link, of the child of a joint, or of a frame. */
  pose(frame: string | Frame): Pose;
  /** Of each closure and coupling, by name. */
  residuals(): Record<string, number[]>;
  /** The constraint Jacobian: its rows by the names of closures and couplings. */
  jacobian(): { columns: Columns; rows: Record<string, number[][]> };
  /** The kinetic energy is ½ vᵀ M v. */
  massMatrix(): { columns: Columns; matrix: number[][] };
  /** kg */
  mass(): number;
  /** In the world, m; undefined if the mass is 0. */
  centerOfMass(): number[] | undefined;
}
