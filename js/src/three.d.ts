import type { Group, Material, Object3D } from "three";
import type { Stop } from "./closing.js";
import type { Closure, Configuration, Diagnostic, Link, Robot } from "./index.js";
import type { Mechanism } from "./mechanism.js";

/** What is used of a URDFLoader of the package urdf-loader. */
export interface Loader<Loaded extends Object3D> {
  parse(urdf: string): Loaded;
  workingPath: string;
  fetchOptions: RequestInit;
}

/** What a robot of urdf-loader has in addition; its `setJointValue` keeps loops closed. */
export interface ClosedLoops {
  readonly mechanism: Mechanism;
  /** Setting it moves the robot. */
  q: Configuration;
  /** Why the last motion ended before its goal. */
  stop: Stop | null;
  /** The two frames are objects in links; a residual is in m and rad. */
  readonly closures: { name: string; type: Closure["type"]; frames: [Group, Group]; residual(): number[] }[];
}

/** Loads a robot by its description (.yaml), which names its URDF, or by its URDF. Rejects with `InvalidRobot`. */
export function loadExtendedURDF<Loaded extends Object3D>(
  url: string,
  options: { loader: Loader<Loaded>; description?: string },
): Promise<Loaded & ClosedLoops & { readonly diagnostics: Diagnostic[] }>;

export class InvalidRobot extends Error {
  readonly diagnostics: Diagnostic[];
}

/** Lets a robot that urdf-loader has made of the same URDF keep its loops closed. */
export function withClosedLoops<Loaded extends Object3D>(object: Loaded, robot: Robot): Loaded & ClosedLoops;

/** The shapes of a link. `mesh` gives the content of a mesh file; `loaded` gives those that failed. */
export function shapesOf(
  link: Link,
  options?: { use?: "visual" | "collision"; mesh?: (file: string) => Promise<ArrayBuffer>; material?: Material },
): { object: Group; loaded: Promise<{ file: string; message: string }[]> };

/** The mesh in the content of a file: STL, OBJ, COLLADA or glTF, by the ending of its name. */
export function loadMesh(file: string, content: ArrayBuffer): Promise<Object3D>;

/** What is used of the module closed-chain-ik. */
export interface ClosedChainIK<IKLink, IKJoint, IKGoal> {
  Link: new () => IKLink;
  Joint: new () => IKJoint;
  Goal: new () => IKGoal;
}

/** A robot for the solver of the package closed-chain-ik. */
export function closedChainIK<IKLink, IKJoint, IKGoal>(
  robot: { mechanism: Mechanism; q: Configuration },
  ik: ClosedChainIK<IKLink, IKJoint, IKGoal>,
): {
  /** The frame to solve from. */
  root: IKLink | IKJoint;
  links: Map<string, IKLink>;
  /** What closes each loop: a joint for a hinge, a goal for all others. */
  goals: Map<string, IKGoal | IKJoint>;
  /** Sentences on what is not held. */
  losses: string[];
  /** Where the solver has brought the robot. */
  configuration(): Configuration;
};
