// A description of version 1, EU-ONE-001 to -009.

import { list, name, oneOf } from "./form.js";
import { fail } from "./invalid.js";
import { unknownKeys } from "./own.js";

const LETTERS = "XYZ";
const SPLITS = ["XY", "XZ", "YX", "YZ", "ZX", "ZY"].map((letters) => `UJOINT_${letters}`);
const LISTS = {
  closed_loop: list(list(name, 2, 2)),
  type: list(oneOf("3d", "3D", "6d", "6D")),
  name_mot: list(name),
  joint_name: list(name),
  joint_type: list(oneOf("SPHERICAL", "FIXED", ...SPLITS)),
};
export const VERSION_1_KEYS = Object.keys(LISTS);

export function readVersion1(value) {
  const read = {};
  for (const key of VERSION_1_KEYS) if (value.has(key)) read[key] = LISTS[key](value.get(key), key);
  if ("joint_name" in read !== "joint_type" in read) fail("joint_name and joint_type require each other");
  const { closed_loop = [], name_mot = [], joint_name = [], joint_type = [] } = read;
  const type = read.type ?? closed_loop.map(() => "6d");
  if (type.length !== closed_loop.length) fail(`type has ${type.length} items, closed_loop ${closed_loop.length}`);
  if (joint_type.length !== joint_name.length) fail("joint_type and joint_name differ in length");
  return {
    version: "1",
    root: "fixed",
    closures: closed_loop.map((pair, i) => ({
      name: `closure_${i + 1}`,
      type: type[i].toLowerCase(),
      frames: pair.map((each) => ({ name: each })),
    })),
    couplings: [],
    changes: joint_name.map((joint, i) => changeOf(joint, joint_type[i])),
    actuators: name_mot.map((joint) => ({ joint })),
    frames: [],
    configurations: new Map(),
    own: unknownKeys(value, VERSION_1_KEYS),
  };
}

/** A joint becomes `split`: two joints about two axes of its frame, in that order. */
function changeOf(joint, type) {
  if (!type.startsWith("UJOINT_")) return { joint, type: type.toLowerCase() };
  return { joint, type: "split", letters: [...type.slice(-2)], axes: [...type.slice(-2)].map(letterAxis) };
}

const letterAxis = (letter) => [0, 1, 2].map((i) => (LETTERS[i] === letter ? 1 : 0));
