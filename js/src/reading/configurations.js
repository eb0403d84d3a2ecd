// Named configurations, EU-CFG-001 to -006.

import { fail } from "./invalid.js";
import { JOINT_TYPES, quaternionAt } from "../mechanism/joint_types.js";

const UNIT = 1e-6;
const SLACK = 1e-9; // m or rad

/** Configurations with quaternions of unit length; `moving`: the joints that move, by name. */
export function linkConfigurations({ configurations, root }, moving) {
  const free = new Map(moving);
  if (root === "floating") free.set("root_joint", { type: "floating", lower: [], upper: [] });
  const linked = new Map();
  for (const [name, configuration] of configurations) {
    const read = ([joint, q]) => [
      joint,
      coordinates(q, free.get(joint), `joint '${joint}' in configuration '${name}'`),
    ];
    linked.set(name, new Map([...configuration].map(read)));
    for (const [left, joint] of free) {
      if (configuration.has(left) || joint.mimic || quaternionAt(joint.type) >= 0) continue;
      const neutral = joint.lower.map(() => 0);
      withinLimits(neutral, joint, `joint '${left}', which configuration '${name}' leaves out,`);
    }
  }
  return linked;
}

function coordinates(q, joint, where) {
  if (!joint || joint.mimic) fail(`${where}: there is no such joint with a coordinate of its own`);
  const count = JOINT_TYPES[joint.type].coordinates.length;
  if (q.length !== count) fail(`${where} has ${q.length} coordinates, not ${count}`);
  withinLimits(q, joint, where);
  const at = quaternionAt(joint.type);
  if (at < 0) return q;
  const length = Math.hypot(...q.slice(at));
  if (!(Math.abs(length - 1) <= UNIT)) fail(`${where} has a quaternion of length ${length}`);
  return q.map((number, i) => (i < at ? number : number / length));
}

/** EU-CFG-004. */
function withinLimits(q, joint, where) {
  joint.lower.forEach((lower, i) => {
    const upper = joint.upper[i];
    if (lower === 0 && upper === 0) return;
    if ((lower !== null && q[i] < lower - SLACK) || (upper !== null && q[i] > upper + SLACK)) {
      fail(`${where} is at ${q[i]}, beyond its limits ${lower} and ${upper}`);
    }
  });
}
