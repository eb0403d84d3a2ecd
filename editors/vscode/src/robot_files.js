// The files of the robot that a document belongs to, and what a preview shows of them. Paths are absolute, with "/".
// `files` reads them: text(path), bytes(path), promises that reject if there is no such file; list(folder), a promise of
// the names in it.

import { posix } from "node:path";

import { read, urdfOf } from "../../../js/src/index.js";
import { findResource, folderOf, nameOf, packageNameOf } from "../../../js/page/drop/paths.js";
import { IS_DESCRIPTION } from "../../../js/page/drop/robots.js";

const MOST_MESH_BYTES = 200_000_000; // of all meshes of a preview
const IS_YAML = /\.ya?ml$/i;
const IS_XML = /\.(urdf|xacro)$/i;
const HAS_OWN_NAME = /^(robot|.*\.eurdf)\.ya?ml$/i;

/** Whether a document is a file of a robot: a description, or a URDF or xacro beside one. */
export async function isOfRobot({ path, text }, files) {
  if (IS_YAML.test(path)) return IS_DESCRIPTION.test(text);
  return IS_XML.test(path) && (await descriptionsBeside(path, files)).length > 0;
}

async function descriptionsBeside(path, files) {
  const folder = folderOf(path);
  const names = (await files.list(folder)).filter((name) => HAS_OWN_NAME.test(name));
  return names.sort((a, b) => b.startsWith("robot.") - a.startsWith("robot.")).map((name) => folder + name);
}

/**
 * The files of the robot that a document belongs to: {description, urdf}, paths. Of a URDF that several descriptions
 * name, robot.yaml is taken first; `description` is null if none does.
 */
export async function robotOf(path, files) {
  if (IS_YAML.test(path)) return { description: path, urdf: await urdfBeside(path, files) };
  for (const description of await descriptionsBeside(path, files)) {
    if ((await urdfBeside(description, files)) === path) return { description, urdf: path };
  }
  return { description: null, urdf: path };
}

const urdfBeside = async (description, files) =>
  absolute(folderOf(description), urdfOf({ name: description, text: await files.text(description) }));

/** A path from a folder. */
const absolute = (folder, path) => (path.startsWith("/") ? path : posix.join(folder, path));

/**
 * What the page of robots shows: {urdf: {name, text}, description: {name, text} or null, meshes: {name: base64}}.
 * A mesh that is not found, or is too much, is left out: the page says so. Throws `Error` if there is no URDF.
 *
 * @param root The folder, with "/" at its end, that meshes may be in.
 * @param known Names of meshes that the page has already; those that are returned are added.
 */
export async function contentOf({ description, urdf }, root, files, known = new Set()) {
  if (/\.xacro$/i.test(urdf)) throw new Error(`the preview does not expand ${nameOf(urdf)}; use "view" above the closures, or xacro ${nameOf(urdf)} > robot.urdf`);
  const texts = { urdf: await file(urdf, files), description: description && (await file(description, files)) };
  const { robot } = read({ ...texts, loops: false });
  const names = new Set([...(robot?.links.values() ?? [])].flatMap(({ shapes }) => shapes.map((each) => each.file).filter(Boolean)));
  return { ...texts, meshes: await meshesOf(names, urdf, root, files, known) };
}

async function file(path, files) {
  const text = await files.text(path).catch(() => null);
  if (text === null) throw new Error(`there is no file ${path}`);
  return { name: nameOf(path), text };
}

async function meshesOf(names, urdf, root, files, known) {
  const meshes = {};
  const packages = await packagesAbove(urdf, root, files);
  let bytes = 0;
  for (const name of names) { // a file of glTF adds those that it names
    if (known.has(name)) continue;
    const content = await found(name, urdf, root, packages, files);
    if (content === null || (bytes += content.length) > MOST_MESH_BYTES) continue;
    known.add(name);
    meshes[name] = Buffer.from(content).toString("base64");
    if (/\.gltf$/i.test(name)) for (const each of namedByGltf(content)) names.add(folderOf(name) + each);
  }
  return meshes;
}

/** The content of the file that a URI in a URDF means; null if there is none in the folder. */
async function found(uri, urdf, root, packages, files) {
  const tried = [];
  findResource(uri, urdf.slice(root.length), (path) => tried.push(path) < 0, packages); // all places, in order
  for (const path of tried) {
    const content = await files.bytes(root + path).catch(() => null);
    if (content !== null) return content;
  }
  return null;
}

/** The names of the packages that a URDF is in, by folder relative to `root`. */
async function packagesAbove(urdf, root, files) {
  const packages = new Map();
  for (let folder = folderOf(urdf); folder.startsWith(root); folder = folderOf(folder.slice(0, -1))) {
    const name = packageNameOf(await files.text(`${folder}package.xml`).catch(() => ""));
    if (name) packages.set(folder.slice(root.length), name);
  }
  return packages;
}

function namedByGltf(content) {
  try {
    const { buffers = [], images = [] } = JSON.parse(Buffer.from(content).toString());
    return [...buffers, ...images].map(({ uri }) => uri).filter((uri) => uri && !uri.startsWith("data:")).map(decodeURIComponent);
  } catch {
    return []; // the page says what is wrong
  }
}
