import type { Configuration } from "./index.js";
import type { Mechanism } from "./mechanism.js";

/** Closes the loops near q, by default the configuration `assembled`, or the neutral. Units: m, rad. */
export function assemble(
  mechanism: Mechanism,
  q?: Configuration,
  options?: { limits?: boolean },
): {
  q: Configuration;
  /** The largest row. */
  residual: number;
  closes: boolean;
  open: Opening[];
};

export interface Opening {
  name: string;
  residual: number;
  position: number;
  angle: number;
}

/** What is open at q, as `assemble` returns it. */
export function openLoops(mechanism: Mechanism, q: Configuration): Opening[];

/** The dimensions at a generic closed configuration around q. */
export function analyze(
  mechanism: Mechanism,
  q: Configuration,
): { nv: number; nc: number; rank: number; mobility: number; uncontrolled: number; dependentActuators: string[][] };

/** Why a motion ended before its goal: what stopped it, of which joint, and where (rad or m). */
export interface Stop {
  reason: "limit" | "half turn" | "passive limit" | "dead point" | "blocked";
  joint: string;
  value: number;
}

/** A robot that moves one coordinate at a time, with the loops closed and the other actuators held. */
export class Drive {
  constructor(mechanism: Mechanism, q: Configuration);
  q: Configuration;
  /** rad or m */
  value(joint: string, index?: number): number;
  /** `index`: of the coordinate; for planar, spherical and floating joints, of positions and the rotation vector. */
  move(joint: string, index: number, value: number): { q: Configuration; stop: Stop | null };
}

/** Brings a point of a link (in its frame) to a target (in the world), m, as near as loops and limits allow. */
export function drag(
  mechanism: Mechanism,
  q: Configuration,
  goal: { link: string; point: number[]; target: number[]; rotation?: number[][] },
): { q: Configuration; error: number; atLimits: string[]; residual: number };

export interface Path {
  reached: number;
  end: "limit" | "half turn" | "characteristic length" | "passive limit" | "dead point";
  joint: string | null;
  configurations: Configuration[];
}

/** The range of motion of an actuator, from q. */
export function sweep(
  mechanism: Mechanism,
  q: Configuration,
  joint: string,
  options?: { steps?: number },
): { lower: Path; upper: Path };

/** How far coordinates are from their position limits; without a limit, `lower`, `upper` and `distance` are infinite. */
export function limits(
  mechanism: Mechanism,
  q: Configuration,
): { joint: string; index: number; value: number; lower: number; upper: number; distance: number; passive: boolean }[];

/** What a person moves: the coordinates of the actuators, or of all joints if there are none. */
export function sliders(
  mechanism: Mechanism,
  q: Configuration,
): {
  joint: string;
  index: number;
  label: string;
  unit: "rad" | "m";
  lower: number;
  upper: number;
  actuated: boolean;
  follow: string[];
  dependent: boolean;
}[];
