/** One of the two files: its name, for places, and its content. */
export interface File {
  name: string;
  text: string | Uint8Array;
}

/** What is wrong: lines and columns count from 1, in Unicode characters; of a file as a whole they are null. */
export interface Diagnostic {
  code: string;
  severity: "error" | "warning";
  /** The clause of the specification. */
  clause: string;
  file: string;
  line: number | null;
  column: number | null;
  message: string;
  hint: string | null;
}

/** Reads and checks a robot. `robot` is null if there is an error; `description` is null for a URDF alone. */
export function read(files: {
  description: File | null;
  urdf: File;
  /** Whether a mesh or texture that the URDF names exists; without it, this is not checked. */
  files?: (name: string) => boolean;
  /** Whether to check that the loops close, which takes most of the time; by default true. */
  loops?: boolean;
}): { robot: Robot | null; diagnostics: Diagnostic[] };

/** The path of the URDF that a description names, relative to its folder. */
export function urdfOf(description: File): string;

/** A description for a URDF whose loops are in another dialect, and sentences on what it lacks. */
export function closuresOfDialects(urdf: string, urdfName?: string): { description: string; losses: string[] };

export type JointType =
  | "fixed"
  | "revolute"
  | "continuous"
  | "prismatic"
  | "helical"
  | "cylindrical"
  | "universal"
  | "planar"
  | "spherical"
  | "floating";

export type Vector = [number, number, number];

/** A pose: the rows of its rotation, and its translation (m). */
export interface Pose {
  R: [Vector, Vector, Vector];
  p: Vector;
}

/** A frame: its pose in a link, xyz in m, rpy in rad. */
export interface Frame {
  link: string;
  xyz: Vector;
  rpy: Vector;
}

/** Coordinates of joints as files have them: rad, m, quaternions x, y, z, w. A joint that is left out is at its neutral. */
export type Configuration = Record<string, number[]>;

/**
 * A limit is null where there is none. Lists have a number for each coordinate (position limits, springs) or velocity.
 * A joint that only holds a link between merged joints, `isLock`, has no name and no lists.
 */
export interface Joint {
  name: string;
  isLock?: true;
  type: JointType;
  parent: string;
  child: string;
  /** Of the joint's frame in the parent. */
  placement: Pose;
  /** Of the child in the frame that the joint moves. */
  after: Pose;
  /** Unit vectors in the joint's frame. */
  axes: Vector[];
  /** Of a helical joint, m per revolution. */
  pitch?: number;
  lower: (number | null)[];
  upper: (number | null)[];
  velocity: (number | null)[];
  effort: (number | null)[];
  damping: number[];
  friction: number[];
  armature: number[];
  stiffness?: number[];
  rest?: number[];
  mimic: { joint: string; multiplier: number; offset: number } | null;
}

export interface Shape {
  use: "visual" | "collision";
  type: "box" | "cylinder" | "capsule" | "sphere" | "mesh";
  /** As in the URDF, m; of a mesh its scale. */
  size: number[];
  /** Of a mesh. */
  file?: string;
  pose: Pose;
  /** Red, green, blue and alpha, from 0 to 1; null where the URDF states none. */
  color: number[] | null;
}

export interface Link {
  name: string;
  mass: number;
  shapes: Shape[];
}

export interface Closure {
  name: string;
  type: "3d" | "6d" | "hinge" | "distance";
  frames: [Frame, Frame];
  /** Of a hinge: unit vectors in the two frames. */
  axes?: [Vector, Vector];
  /** Of a distance, m. */
  length?: number;
}

/** A robot: the mechanism that the two files state. */
export interface Robot {
  name: string;
  version: "1" | "2" | "2.1";
  root: "fixed" | "floating";
  rootLink: string;
  links: Map<string, Link>;
  joints: Joint[];
  closures: Closure[];
  couplings: { name: string; joints: Map<string, number>; offset: number }[];
  actuators: { joint: string; name?: string; gear_ratio: number; rotor_inertia: number; control?: [number, number] }[];
  configurations: Map<string, Map<string, number[]>>;
  frameNames: string[];
  /** The frame of a link, of the child of a joint, or of a frame of the description. */
  frameOf(name: string): Frame;
}
