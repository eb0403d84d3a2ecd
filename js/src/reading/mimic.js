// Mimic joints and their leaders, EU-URD-021 to -023 and EU-JNT-032.

import { meant } from "./near.js";
import { allowedSizes } from "./numbers.js";
import { valueOf } from "./xml.js";

const SINGLE = ["revolute", "continuous", "prismatic"];

/** Checks every `mimic` of a URDF; that of a fixed joint has no effect. Whether there is no error. */
export function checkMimics(joints, diagnostics) {
  const wrong = new Set();
  for (const joint of joints.values()) {
    if (!isMimic(joint)) continue;
    const leader = joints.get(joint.mimic.joint);
    const place = valueOf(joint.mimic.element, "joint");
    const other = leader && [joint, leader].find(({ type }) => !SINGLE.includes(type));
    if (leader && !other) continue;
    wrong.add(joint);
    if (!leader) {
      const message = `joint '${joint.name}' mimics '${joint.mimic.joint}', which is no joint of the robot`;
      diagnostics.report("urdf-mimic-unknown", place, message, meant(joint.mimic.joint, joints.keys()));
    } else {
      const message = `joint '${joint.name}' mimics '${leader.name}', but '${other.name}' is ${other.type}`;
      diagnostics.report("urdf-mimic-kind", place, message, `both must be ${SINGLE.join(", ")}`);
    }
  }
  const passed = new Set(wrong);
  for (const joint of joints.values()) {
    const chain = new Set();
    let each = joint;
    for (; isMimic(each) && !passed.has(each); each = joints.get(each.mimic.joint)) {
      passed.add(each);
      chain.add(each);
    }
    if (!chain.has(each)) continue;
    wrong.add(joint);
    const message = `the leaders of joint '${joint.name}' lead back to joint '${each.name}'`;
    const hint = "remove the mimic of the joint that moves by itself";
    diagnostics.report("urdf-mimic-cycle", valueOf(joint.mimic.element, "joint"), message, hint);
  }
  return !wrong.size;
}

export const isMimic = (joint) => joint.mimic !== undefined && joint.mimic !== null && joint.type !== "fixed";

/** Sets `leader` of each mimic joint: `{joint, multiplier, offset}` of the joint at the end of its chain, EU-FIL-005. */
export function findLeaders(byName, diagnostics) {
  for (const joint of byName.values()) {
    const chain = [];
    for (let each = joint; each.mimic && !each.leader; each = byName.get(each.mimic.joint)) chain.push(each);
    for (const each of chain.reverse()) {
      const { multiplier, offset } = each.mimic;
      const above = byName.get(each.mimic.joint);
      const { leader } = above;
      each.leader = leader
        ? { ...leader, multiplier: multiplier * leader.multiplier, offset: multiplier * leader.offset + offset }
        : { joint: above, multiplier, offset };
      if (leader && !leader.isOut) checkSizes(each, diagnostics);
    }
  }
}

function checkSizes({ name, leader, mimic: { element } }, diagnostics) {
  for (const [key, kind] of [["multiplier", "divisor"], ["offset"]]) {
    const sizes = allowedSizes(leader[key], kind);
    if (!sizes) continue;
    leader.isOut = true; // and so are those of its own mimic joints
    const place = element.attributes.has(key) ? valueOf(element, key) : element;
    const message = `the ${key} of joint '${name}' at the end of its chain of mimic joints is ${leader[key]}, not ${sizes}`;
    diagnostics.report("number-out-of-bounds", place, message);
    return;
  }
}
