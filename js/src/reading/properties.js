// Limits, damping, friction, armature and springs of a joint in the model, EU-JNT-009, -010, -020, -021, -027, -029.

import { fail } from "./invalid.js";
import { JOINT_TYPES } from "../mechanism/joint_types.js";

const BY_VELOCITY = ["velocity", "effort", "damping", "friction"];
const UNLIMITED = { velocity: null, effort: null, damping: 0, friction: 0 };

/** Properties that the URDF gives a joint of the model. `sources`: the URDF joint of each velocity. */
export function inherited(type, sources, pitch) {
  const { coordinates, limited } = JOINT_TYPES[type];
  // One number cannot apply to both lengths and angles.
  if (type === "planar" || type === "floating") sources = sources.map(() => UNLIMITED);
  const properties = { armature: sources.map(() => 0) };
  for (const key of BY_VELOCITY) properties[key] = sources.map((joint) => joint[key]);
  const [from] = sources;
  const kind = from?.type === "prismatic" ? "length" : "angle";
  for (const key of ["lower", "upper"]) {
    properties[key] =
      limited || type === "continuous" ? coordinates.map((each) => (each === kind ? from[key] : null)) : [];
  }
  return type === "helical" && from.type === "prismatic"
    ? perRadian(properties, from, pitch / (2 * Math.PI))
    : properties;
}

/** Those of a prismatic joint that becomes helical, with d = k θ; null where there is no limit. */
function perRadian(properties, { lower, upper }, k) {
  const size = Math.abs(k);
  const scaled = (numbers, factor) => numbers.map((number) => (number === null ? null : number * factor));
  const ends = k > 0 ? [lower, upper] : [upper, lower];
  const [first, last] = ends.map((end) => (end === null ? null : end / k));
  return {
    ...properties,
    lower: [first],
    upper: [last],
    velocity: properties.velocity.map((number) => (number === null ? null : number / size)),
    effort: scaled(properties.effort, size),
    damping: scaled(properties.damping, k * k),
    friction: scaled(properties.friction, size),
  };
}

/** Replaces properties by those that the description states. */
export function applyStated(joint, change) {
  const { coordinates, velocities, limited } = JOINT_TYPES[joint.type];
  const stated = { ...change.limits };
  for (const key of ["damping", "friction", "armature", "stiffness", "rest"])
    if (key in change) stated[key] = change[key];
  for (const [key, value] of Object.entries(stated)) {
    const where = `joint '${joint.name}', which is ${joint.type},`;
    if (joint.type === "fixed") fail(`${where} cannot have a property`);
    const perCoordinate = ["lower", "upper", "stiffness", "rest"].includes(key);
    if ((key === "lower" || key === "upper") && !limited) fail(`${where} has no position limits`);
    if (perCoordinate && coordinates.length !== velocities) fail(`${where} has no springs`);
    if ((key === "stiffness" || key === "rest") && joint.type === "planar") fail(`${where} has no springs`);
    const count = perCoordinate ? coordinates.length : velocities;
    const list = Array.isArray(value) ? value : Array(count).fill(value);
    if (list.length !== count) fail(`${where} needs ${count} numbers for ${key}, not ${list.length}`);
    joint[key] = list;
  }
  if (joint.stiffness) joint.rest ??= joint.stiffness.map(() => 0);
  const isReversed = (lower, i) => lower !== null && joint.upper[i] !== null && lower > joint.upper[i];
  if (("lower" in stated || "upper" in stated) && joint.lower.some(isReversed)) {
    fail(`joint '${joint.name}' has a lower limit that is greater than its upper limit`);
  }
}
