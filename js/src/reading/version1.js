// A description of version 1, EU-ONE-001 to -009.

import { list, name, oneOf, shown } from "./form.js";
import { isNear } from "./near.js";
import { unknownKeys } from "./own.js";

const LETTERS = "XYZ";
const SPLITS = ["XY", "XZ", "YX", "YZ", "ZX", "ZY"].map((letters) => `UJOINT_${letters}`);
const LISTS = {
  closed_loop: list(list(name, 2, 2)),
  type: list(oneOf("3d", "6d", "3D", "6D")),
  name_mot: list(name),
  joint_name: list(name),
  joint_type: list(oneOf("SPHERICAL", "FIXED", ...SPLITS)),
};
export const VERSION_1_KEYS = Object.keys(LISTS);

/** `later`: the keys of version 2. */
export function readVersion1(top, later, diagnostics) {
  checkNear(top, later, diagnostics);
  const read = {};
  for (const key of VERSION_1_KEYS) if (top.has(key)) read[key] = LISTS[key](top.get(key), key, diagnostics);
  for (const [key, other] of [
    ["joint_name", "joint_type"],
    ["joint_type", "joint_name"],
  ]) {
    if (top.has(other) || !top.has(key)) continue;
    diagnostics.report("missing-key", top.key(key), `${key} requires ${other}, which is missing`, `add ${other}`);
  }
  if (diagnostics.has("schema")) return { version: "1", root: "fixed", node: top };
  const { closed_loop = [], name_mot = [], joint_name = [], joint_type = [] } = read;
  const type = read.type ?? closed_loop.map(() => "6d");
  checkLengths(top, "type", type, "closed_loop", closed_loop, diagnostics);
  checkLengths(top, "joint_type", joint_type, "joint_name", joint_name, diagnostics);
  const nodes = (key) => top.get(key)?.content;
  return {
    version: "1",
    root: "fixed",
    node: top,
    closures: closed_loop.map((pair, i) => ({
      name: `closure_${i + 1}`,
      type: (type[i] ?? "6d").toLowerCase(),
      frames: pair.map((each, k) => ({ name: each, node: nodes("closed_loop")[i].get(k) })),
      node: nodes("closed_loop")[i],
    })),
    couplings: [],
    changes: joint_name
      .slice(0, joint_type.length)
      .map((joint, i) => changeOf(joint, joint_type[i], nodes("joint_name")[i])),
    actuators: name_mot.map((joint, i) => ({ joint, node: nodes("name_mot")[i] })),
    frames: [],
    configurations: [],
    own: unknownKeys(top.plain(), VERSION_1_KEYS),
  };
}

/** EU-ONE-002. */
function checkNear(top, later, diagnostics) {
  for (const [key, { key: place }] of top.content) {
    if (VERSION_1_KEYS.includes(key) || key.startsWith("x-") || key === "metadata") continue;
    const right = [...VERSION_1_KEYS, "extended_urdf"].find((each) => isNear(key, each));
    if (!right && !later.includes(key)) continue;
    const why = right ? `is near '${right}'` : "is one of version 2";
    const hint = right ? `did you mean '${right}'?` : 'version 2 begins with extended_urdf: "2.0"';
    diagnostics.report("near-miss-key", place, `the key ${shown(place)} ${why}, but has no meaning in version 1`, hint);
  }
}

/** EU-ONE-003. */
function checkLengths(top, key, types, other, items, diagnostics) {
  if (types.length === items.length) return;
  const shorter = types.length < items.length ? key : other;
  const place = top.get(shorter) ?? top.get(shorter === key ? other : key);
  const message = `${key} has ${types.length} items, and ${other} ${items.length}`;
  diagnostics.report("length-mismatch", place, message, "write as many items in both");
}

/** A joint becomes `split`: two joints about two axes of its frame, in that order. */
function changeOf(joint, type, node) {
  const change = { joint, node, key: node };
  if (!type.startsWith("UJOINT_")) return { ...change, type: type.toLowerCase() };
  return { ...change, type: "split", letters: [...type.slice(-2)], axes: [...type.slice(-2)].map(letterAxis) };
}

const letterAxis = (letter) => [0, 1, 2].map((i) => (LETTERS[i] === letter ? 1 : 0));
