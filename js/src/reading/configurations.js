// Named configurations, EU-CFG-001 to -006.

import { JOINT_TYPES, quaternionAt } from "../mechanism/joint_types.js";
import { meant } from "./near.js";

const UNIT = 1e-6;
const SLACK = 1e-9; // m or rad
const ROOT = { name: "root_joint", type: "floating", lower: [], upper: [] };

/** Configurations by name, with quaternions of unit length. `joints`: the `JointNames` of the robot. */
export function linkConfigurations({ configurations, root }, joints, diagnostics) {
  const find = (name) => (root === "floating" && name === ROOT.name ? ROOT : joints.find(name));
  const withoutZero = joints.moving().filter(excludesNeutral);
  const linked = new Map();
  for (const { name, coordinates, key } of configurations) {
    const before = diagnostics.errors;
    const read = new Map();
    for (const { joint, q, node, key: place, isFaulty } of coordinates) {
      if (isFaulty || joints.isUnclear(joint)) continue;
      const found = find(joint);
      if (!found || found.isMerged || found.type === "fixed" || found.leader) {
        const why = !found
          ? "is no joint of the robot"
          : `has no coordinate: it is ${found.isMerged ? "merged" : found.leader ? "a mimic joint" : "fixed"}`;
        diagnostics.report(
          "configuration-joint",
          place,
          `'${joint}' in configuration '${name}' ${why}`,
          meant(joint, joints.names()),
        );
      } else
        read.set(joint, unitCoordinates(q, found, node, `joint '${joint}' in configuration '${name}'`, diagnostics));
    }
    linked.set(name, read);
    if (diagnostics.errors > before) continue;
    const stated = new Set(coordinates.map(({ joint }) => joint));
    const beyond = withoutZero.filter((joint) => !stated.has(joint.name));
    if (!beyond.length) continue;
    const listed = beyond
      .slice(0, 10)
      .map((joint) => `'${joint.name}'`)
      .join(", ");
    const message = `configuration '${name}' leaves out ${listed}, whose limits exclude 0`;
    diagnostics.report("configuration-limits", key, message, "state a coordinate of each");
  }
  return linked;
}

/** Whether the limits of a joint exclude its neutral. */
function excludesNeutral(joint) {
  if (joint.isFaulty || joint.leader || quaternionAt(joint.type) >= 0) return false;
  return joint.lower.some((_, i) => isBeyond(0, joint, i));
}

/** EU-CFG-004. */
function isBeyond(coordinate, { lower, upper }, i) {
  if (lower[i] === 0 && upper[i] === 0) return false;
  return (lower[i] !== null && coordinate < lower[i] - SLACK) || (upper[i] !== null && coordinate > upper[i] + SLACK);
}

function unitCoordinates(q, joint, node, where, diagnostics) {
  const count = JOINT_TYPES[joint.type].coordinates.length;
  if (q.length !== count) {
    const hint = `a ${joint.type} joint has ${JOINT_TYPES[joint.type].coordinates.join(", ")}`;
    return diagnostics.report("configuration-length", node, `${where} has ${q.length} coordinates, not ${count}`, hint);
  }
  const i = joint.lower.findIndex((_, at) => isBeyond(q[at], joint, at));
  if (i >= 0) {
    const { lower, upper } = joint;
    const range = `from ${lower[i] ?? "-∞"} to ${upper[i] ?? "∞"}`;
    const message = `${where} is at ${q[i]}, beyond its limits, which are ${range}`;
    return diagnostics.report("configuration-limits", node, message, "angles are in rad, lengths in m");
  }
  const at = quaternionAt(joint.type);
  if (at < 0) return q;
  const length = Math.hypot(...q.slice(at));
  if (!(Math.abs(length - 1) <= UNIT)) {
    const message = `the quaternion of ${where} has the length ${length}, not 1`;
    return diagnostics.report("configuration-quaternion", node, message, "the order is x, y, z, w; write more digits");
  }
  return q.map((number, k) => (k < at ? number : number / length));
}
