// Couplings, EU-CPL-001 to -004.

import { fail } from "./invalid.js";

const COUPLED = ["revolute", "continuous", "prismatic", "helical"];
const EQUAL = 1e-9;

/** `moving`: the joints that move, by name. */
export function linkCouplings({ couplings, closures }, moving) {
  const names = new Set(closures.map((closure) => closure.name));
  const seen = new Map(); // by the names of the joints
  for (const { name, joints } of couplings) {
    if (names.has(name)) fail(`coupling '${name}' has the name of another coupling or closure`);
    names.add(name);
    for (const joint of joints.keys()) {
      const found = moving.get(joint);
      if (!found) fail(`coupling '${name}': there is no joint '${joint}' that moves`);
      if (found.mimic || !COUPLED.includes(found.type)) fail(`coupling '${name}': joint '${joint}' cannot be coupled`);
    }
    checkProportional(name, joints, seen);
  }
  return couplings;
}

function checkProportional(name, joints, seen) {
  const sorted = [...joints.keys()].sort();
  const largest = Math.max(...[...joints.values()].map(Math.abs));
  const shares = sorted.map((joint) => joints.get(joint) / largest);
  const key = JSON.stringify(sorted);
  const others = seen.get(key) ?? [];
  for (const other of others) {
    for (const sign of [1, -1]) {
      if (shares.every((share, i) => Math.abs(share - sign * other[i]) <= EQUAL))
        fail(`coupling '${name}' repeats another one`);
    }
  }
  seen.set(key, [...others, shares]);
}
