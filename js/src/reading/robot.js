// A robot from the texts of its two files, and what is wrong with it.

import { checkRanges } from "./advised.js";
import { checkBounds } from "./bounds.js";
import { BARE, readDescription } from "./description.js";
import { Diagnostics } from "./diagnostics.js";
import { checkInertia, checkLeaves } from "./inertia.js";
import { link } from "./linking.js";
import { checkLoops } from "./loops.js";
import { readSource } from "./source.js";
import { readUrdf } from "./urdf.js";
import { parseXml } from "./xml.js";
import { parseYaml } from "./yaml.js";

/** Phases whose errors leave a robot that can only be guessed, EU-CNF-001. */
const REJECTING = ["yaml", "schema", "urdf", "link", "semantic"];

/**
 * Reads a robot: {robot, diagnostics}. `robot` is null if an error rejects it; an error of its inertia or closures does
 * not.
 *
 * `description`, `urdf`: {name, text}, where `text` is a string or the bytes of the file. It is null if there is no
 * such file; a `problem` says why a file cannot be read. A URDF without a description has the description null.
 * `files`: whether a file that the URDF names exists, by its address; left out if that is unknown.
 * `loops`: whether to check that the loops close, which takes most of the time.
 */
export function read({ description, urdf, files, loops = true }) {
  const diagnostics = new Diagnostics();
  const stated = description ? readStated(description, diagnostics) : BARE;
  const isComplete = stated && !diagnostics.has("yaml", "schema");
  const tree = readTree(urdf, stated, isComplete, files, diagnostics);
  const wrong = tree && checkInertia(tree, diagnostics);
  const robot = isComplete && tree ? link(stated, tree, diagnostics) : null;
  const isRejected = !robot || !checkBounds(robot, tree, diagnostics) || diagnostics.has(...REJECTING);
  if (!isRejected) {
    checkRanges(tree, robot, diagnostics);
    checkLeaves(robot, wrong, diagnostics);
    if (loops) checkLoops(robot, stated, diagnostics);
  }
  return { robot: isRejected ? null : robot, diagnostics: diagnostics.list() };
}

/** What the description states, or null if its version is unknown. */
function readStated(description, diagnostics) {
  const source = readSource(description, diagnostics);
  const top = source && parseYaml(source, diagnostics);
  return top && readDescription(top, diagnostics);
}

/** The tree of the URDF, or null if it has an error. */
function readTree(urdf, stated, isComplete, files, diagnostics) {
  if (stated !== BARE && urdf.text === null && !urdf.problem) {
    const named = stated?.node.get("urdf") ?? stated?.node;
    const message = `there is no URDF ${urdf.name}`;
    if (isComplete) diagnostics.report("urdf-not-found", named, message, "its path is relative to the description");
    return null;
  }
  const source = readSource(urdf, diagnostics);
  const root = source && parseXml(source, diagnostics);
  const withMimics = Boolean(stated) && stated.version !== "1";
  return root && readUrdf(root, diagnostics, { withMimics, isFloating: stated?.root === "floating", files });
}

/** The path of the URDF that a description names, relative to its folder; `text` as in `read`. */
export function urdfOf({ name, text }) {
  const diagnostics = new Diagnostics();
  const source = readSource({ name, text }, diagnostics);
  const named = source && parseYaml(source, diagnostics)?.get("urdf")?.content;
  return typeof named === "string" && named ? named : "robot.urdf";
}
