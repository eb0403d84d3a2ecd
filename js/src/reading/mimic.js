// Mimic joints and their leaders, EU-URD-021 to -023 and EU-JNT-032.

import { fail } from "./invalid.js";
import { bounded, divisor } from "./numbers.js";

const SINGLE = ["revolute", "continuous", "prismatic"];

/** Checks every `mimic` of a URDF; that of a fixed joint has no effect. */
export function checkMimics(joints) {
  for (const joint of joints.values()) {
    if (!isMimic(joint)) continue;
    const leader = joints.get(joint.mimic.joint);
    if (!leader) fail(`joint '${joint.name}' mimics '${joint.mimic.joint}', which does not exist`);
    for (const each of [joint, leader]) {
      if (!SINGLE.includes(each.type))
        fail(`joint '${each.name}' is ${each.type}: it can neither mimic nor be mimicked`);
    }
  }
  const ending = new Set(); // joints whose chain of leaders ends
  for (const joint of joints.values()) {
    const chain = new Set();
    for (let each = joint; isMimic(each) && !ending.has(each); each = joints.get(each.mimic.joint)) {
      if (chain.has(each)) fail(`joint '${each.name}' mimics itself`);
      chain.add(each);
    }
    chain.forEach((each) => ending.add(each));
  }
}

export const isMimic = (joint) => joint.mimic !== undefined && joint.mimic !== null && joint.type !== "fixed";

/** Sets `leader` of each mimic joint: `{joint, multiplier, offset}` of the joint at the end of its chain, EU-FIL-005. */
export function findLeaders(byName) {
  for (const joint of byName.values()) {
    const chain = [];
    for (let each = joint; each.mimic && !each.leader; each = byName.get(each.mimic.joint)) chain.push(each);
    for (const each of chain.reverse()) {
      const { multiplier, offset } = each.mimic;
      const above = byName.get(each.mimic.joint);
      each.leader = above.leader
        ? {
            joint: above.leader.joint,
            multiplier: multiplier * above.leader.multiplier,
            offset: multiplier * above.leader.offset + offset,
          }
        : { joint: above, multiplier, offset };
      divisor(each.leader.multiplier, `the multiplier of joint '${each.name}' at the end of its chain`);
      bounded(each.leader.offset, `the offset of joint '${each.name}' at the end of its chain`);
    }
  }
}
