// Couplings, EU-CPL-001 to -004.

import { meant } from "./near.js";

const COUPLED = ["revolute", "continuous", "prismatic", "helical"];
const EQUAL = 1e-9;

/** The couplings of a description. `joints`: the `JointNames` of the robot. */
export function linkCouplings({ couplings, closures }, joints, diagnostics) {
  const names = new Set(closures.map((closure) => closure.name));
  const seen = new Map(); // by the names of the joints
  for (const coupling of couplings) {
    const { name, node } = coupling;
    const isRepeated = names.has(name);
    names.add(name);
    if (coupling.isFaulty) continue;
    const before = diagnostics.errors;
    if (isRepeated) {
      const message = `another closure or coupling has the name '${name}'`;
      diagnostics.report("duplicate-coupling-name", node.get("name"), message, "write another name");
      continue;
    }
    for (const joint of coupling.joints.keys())
      checkCoupled(joint, name, node.get("joints").key(joint), joints, diagnostics);
    if (diagnostics.errors > before) continue;
    const other = proportional(coupling, seen);
    if (!other) continue;
    const message = `coupling '${name}' is a multiple of coupling '${other}'`;
    diagnostics.report("coupling-duplicate", node, message, "keep one of the two");
  }
  return couplings;
}

function checkCoupled(joint, coupling, place, joints, diagnostics) {
  const found = joints.find(joint);
  const where = `of coupling '${coupling}'`;
  if (joints.isUnclear(joint)) return;
  if (!found) {
    const message = `'${joint}' ${where} is no joint of the robot`;
    diagnostics.report("unknown-coupled-joint", place, message, meant(joint, joints.names()));
    return;
  }
  const { leader } = found;
  const kind = found.isMerged ? "merged into another joint" : leader ? "a mimic joint" : found.type;
  if (!found.isMerged && !leader && COUPLED.includes(found.type)) return;
  const hint = leader ? "couple its leader" : `couple a joint that is ${COUPLED.join(", ")}`;
  diagnostics.report("coupling-joint", place, `the joint '${joint}' ${where} is ${kind}`, hint);
}

/** The name of an earlier coupling that this one is proportional to. */
function proportional({ name, joints }, seen) {
  const sorted = [...joints.keys()].sort();
  const largest = Math.max(...[...joints.values()].map(Math.abs));
  const shares = sorted.map((joint) => joints.get(joint) / largest);
  const key = JSON.stringify(sorted);
  const others = seen.get(key) ?? [];
  seen.set(key, [...others, { name, shares }]);
  const isEqual = (other, sign) => shares.every((share, i) => Math.abs(share - sign * other.shares[i]) <= EQUAL);
  return others.find((other) => isEqual(other, 1) || isEqual(other, -1))?.name;
}
