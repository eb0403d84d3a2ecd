// The description of any version, in one form:
// {version, root, closures, couplings, changes, actuators, frames, configurations, own}.
// A frame is {name}, {link, xyz, rpy} or {joint, xyz, rpy}. A change is the entry of one joint.

import { fail } from "./invalid.js";
import { isNear } from "./near.js";
import { readVersion1, VERSION_1_KEYS } from "./version1.js";
import { readVersion2, VERSION_2_KEYS } from "./version2.js";

const VERSIONS = new Map([
  ["2.0", "2"],
  ["2.1", "2.1"],
]);

/** The description that a top-level mapping states, EU-VER-001 to -003. */
export function readDescription(value) {
  const keys = [...value.keys()];
  if (value.has("extended_urdf")) {
    const version = VERSIONS.get(value.get("extended_urdf"));
    if (!version) fail('extended_urdf is not "2.0" or "2.1"');
    return readVersion2(value, version);
  }
  const isOwn = (key) => key.startsWith("x-"); // of neither version
  const misspelt = (key) => VERSION_2_KEYS.includes(key) || (!isOwn(key) && isNear(key, "extended_urdf"));
  if (!keys.some((key) => VERSION_1_KEYS.includes(key)) && keys.some(misspelt)) {
    fail('the key extended_urdf is missing; add extended_urdf: "2.0"');
  }
  return readVersion1(value);
}
