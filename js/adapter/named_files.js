// Which of the files that a URDF names exist on this machine, EU-URD-028 and -033.

import { existsSync, statSync } from "node:fs";
import { basename, delimiter, dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

/** Whether a name in the URDF at `urdf` is that of a file: a path from its folder, `file://` or `package://`. */
export function namedFiles(urdf) {
  const folder = dirname(resolve(urdf));
  const own = packageAround(folder);
  return (name) => candidates(name, folder, own).some(isFile);
}

function candidates(name, folder, own) {
  const [, scheme, rest] = name.match(/^([a-z]+):\/\/(.*)$/is) ?? [];
  if (!scheme) return [resolve(folder, name)];
  if (scheme === "file") return [fileAt(name)].filter(Boolean);
  if (scheme !== "package") return [];
  const wanted = rest.split("/")[0];
  const paths = (process.env.ROS_PACKAGE_PATH ?? "").split(delimiter).filter(Boolean);
  const packages = [own, ...paths].filter((path) => basename(path) === wanted).map(dirname);
  return [...packages, ...paths].map((path) => join(path, rest));
}

/** The path of an address `file://`, or null if it is that of no file here. */
function fileAt(address) {
  try {
    return fileURLToPath(address);
  } catch {
    return null;
  }
}

/** The nearest folder, upwards, with a `package.xml`, or else the folder itself. */
function packageAround(folder) {
  for (let path = folder; ; path = dirname(path)) {
    if (existsSync(join(path, "package.xml"))) return path;
    if (path === dirname(path)) return folder;
  }
}

function isFile(path) {
  try {
    return statSync(path).isFile();
  } catch {
    return false; // also if a name is too long, or has a character that none has
  }
}
