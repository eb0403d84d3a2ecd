// Which robots are among files: each description with its URDF, and each URDF that no description names.

import { urdfOf } from "../../src/index.js";
import { MOST_BYTES } from "../../src/reading/source.js";
import { folderOf, nameOf, resolve } from "./paths.js";

const KEYS = ["extended_urdf", "closed_loop", "name_mot", "joint_name"]; // one of which a description has
/** What the text of a description contains. */
export const IS_DESCRIPTION = new RegExp(`^[ \\t{]*["']?(${KEYS.join("|")})["']?[ \\t]*:`, "m");

/**
 * @param files Map from path to File.
 * @returns [{description, urdf, note}], paths, robots of version 2 first; `description` is null for a bare URDF; `note`
 *   says what was guessed.
 */
export async function robotsIn(files) {
  const paths = [...files.keys()].sort();
  const urdfs = paths.filter((path) => /\.urdf$/i.test(path));
  const yamls = paths.filter((path) => /\.ya?ml$/i.test(path));
  const robots = [];
  for (const path of yamls) {
    const bytes = new Uint8Array(await files.get(path).slice(0, MOST_BYTES).arrayBuffer());
    const [, key] = IS_DESCRIPTION.exec(new TextDecoder().decode(bytes)) ?? [];
    const isNamedAlike = urdfs.includes(path.replace(/\.\w+$/, ".urdf")) || (yamls.length === 1 && urdfs.length <= 1);
    if (!key && !isNamedAlike) continue;
    const names = urdfOf({ name: path, text: bytes });
    robots.push({ description: path, ...found(path, names, urdfs), order: key === KEYS[0] ? 0 : 1 });
  }
  const used = new Set(robots.map(({ urdf }) => urdf));
  for (const urdf of urdfs) if (!used.has(urdf)) robots.push({ description: null, urdf, note: "", order: 2 });
  return robots.sort((a, b) => a.order - b.order);
}

/** The path of the URDF that a description names. Where folders are missing, a file is found by its name. */
function found(description, names, urdfs) {
  const exact = resolve(folderOf(description), names);
  const alike = urdfs.filter((path) => nameOf(path) === nameOf(names));
  const [other] = alike.length === 1 ? alike : urdfs.length === 1 ? urdfs : [];
  if (urdfs.includes(exact) || other === undefined) return { urdf: exact ?? names, note: "" };
  const short = names.length > 200 ? `${names.slice(0, 200)}…` : names;
  return {
    urdf: other,
    note: `${description} names the URDF “${short}”, which is not among the files: it is read with “${other}”.`,
  };
}
