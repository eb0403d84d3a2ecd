// Limits, damping, friction, armature and springs of a joint in the model, EU-JNT-009, -010, -020, -021, -027, -029.

import { JOINT_TYPES } from "../mechanism/joint_types.js";

const BY_VELOCITY = ["velocity", "effort", "damping", "friction"];
const OWN = ["damping", "friction", "armature", "stiffness", "rest"]; // the others are in `limits`
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

/** Replaces properties by those that the description states, unless these have an error. */
export function applyStated(joint, change, diagnostics) {
  if (change.isFaulty) return;
  const stated = {};
  for (const [key, value] of Object.entries(change)) {
    if (key === "limits") Object.assign(stated, value);
    else if (OWN.includes(key)) stated[key] = value;
  }
  delete stated.node;
  const placeOf = (key) => (OWN.includes(key) ? change.node : change.node.get("limits")).get(key);
  for (const [key, value] of Object.entries(stated)) {
    const why = whyUnfit(joint.type, key, value);
    if (why) {
      joint.isFaulty = true;
      const message = `${key} of joint '${joint.name}' does not fit: ${why}`;
      diagnostics.report("joint-property", placeOf(key), message, "remove it, or write what its type has");
      return;
    }
    joint[key] = Array.isArray(value) ? value : Array(countOf(joint.type, key)).fill(value);
  }
  if (joint.stiffness) joint.rest ??= joint.stiffness.map(() => 0);
  const isReversed = (lower, i) => lower !== null && joint.upper[i] !== null && lower > joint.upper[i];
  const i = joint.lower.findIndex(isReversed);
  if (i < 0 || !("lower" in stated || "upper" in stated)) return;
  joint.isFaulty = true;
  const message = `the lower limit of joint '${joint.name}' is ${joint.lower[i]}, above its upper limit, ${joint.upper[i]}`;
  const hint = "state both limits, in rad or m; one that is not stated is that of the URDF";
  diagnostics.report("joint-limits-reversed", placeOf("lower" in stated ? "lower" : "upper"), message, hint);
}

const isPerCoordinate = (key) => ["lower", "upper", "stiffness", "rest"].includes(key);

const countOf = (type, key) =>
  isPerCoordinate(key) ? JOINT_TYPES[type].coordinates.length : JOINT_TYPES[type].velocities;

/** EU-JNT-009: why a joint of a type cannot have a property, or null. */
function whyUnfit(type, key, value) {
  const { coordinates, velocities, limited } = JOINT_TYPES[type];
  if (type === "fixed") return "a fixed joint has no properties";
  if ((key === "lower" || key === "upper") && !limited) return `a ${type} joint has no position limits`;
  if (isPerCoordinate(key) && (coordinates.length !== velocities || type === "planar"))
    return `a ${type} joint has no springs`;
  const count = countOf(type, key);
  if (!Array.isArray(value) || value.length === count) return null;
  return `it has ${value.length} numbers, and a ${type} joint needs ${count}`;
}
