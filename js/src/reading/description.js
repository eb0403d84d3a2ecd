// The description of any version, in one form:
// {version, root, node, closures, couplings, changes, actuators, frames, configurations, own}.
// A frame is {name}, {link, xyz, rpy} or {joint, xyz, rpy}. A change is the entry of one joint. Items have the `node` that
// states them; `isFaulty`: whether they have an error of phase semantic.

import { isUserKey, name } from "./form.js";
import { isNear } from "./near.js";
import { VERSION_1_KEYS, readVersion1 } from "./version1.js";
import { VERSION_2_KEYS, readVersion2 } from "./version2.js";

const VERSIONS = new Map([
  ["2.0", "2"],
  ["2.1", "2.1"],
  [2, "2"], // without quotes, which is a wrong type, but tells the version
  [2.1, "2.1"],
]);

/** What a URDF without a description has. */
export const BARE = {
  version: "2.1",
  root: "fixed",
  node: null,
  closures: [],
  couplings: [],
  changes: [],
  actuators: [],
  frames: [],
  configurations: [],
  own: new Map(),
};

/** The description that a top-level mapping states, EU-VER-001 to -003; null if its version is unknown. */
export function readDescription(top, diagnostics) {
  if (top.has("extended_urdf")) {
    const stated = top.get("extended_urdf");
    const version = VERSIONS.get(stated.content);
    if (version) return readVersion2(top, version, diagnostics);
    if (typeof stated.content === "string") {
      const message = `this parser reads the versions "2.0" and "2.1", not "${stated.content.slice(0, 60)}"`;
      diagnostics.report("unsupported-version", stated, message, 'write "2.0" or "2.1"');
    } else name(stated, "extended_urdf", diagnostics);
    return null;
  }
  const keys = [...top.content.keys()];
  const misspelt = keys.find((key) => !isUserKey(key) && isNear(key, "extended_urdf"));
  const first = misspelt ?? keys.find((key) => VERSION_2_KEYS.includes(key));
  if (first !== undefined && !keys.some((key) => VERSION_1_KEYS.includes(key))) {
    const hint = misspelt ? `did you mean 'extended_urdf'?` : 'add extended_urdf: "2.0"';
    diagnostics.report("missing-key", top.key(first), "the description has no key extended_urdf", hint);
    return null;
  }
  return readVersion1(top, VERSION_2_KEYS, diagnostics);
}
