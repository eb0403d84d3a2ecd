// The URDF as a tree of links and joints, EU-URD-003 to -041.

import { checkAppearance, checkDialects } from "./advised.js";
import { Colors } from "./colors.js";
import { checkElements, childrenOf, numbersOf } from "./element_check.js";
import { WITH_RANGE, shapesOf } from "./elements.js";
import { checkMimics } from "./mimic.js";
import { checkNames, rootOf } from "./tree.js";
import { valueOf } from "./xml.js";
import { fromOrigin, fromQuaternion } from "../mechanism/spatial.js";

const VERSIONS = ["1.0", "1.1", "1.2"];
const MOMENTS = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];

/**
 * `{name, element, links, joints, root}`, or null after an error: links and joints are Maps by name, each with its
 * `element`; `root` is the name of the root link. `files`: whether a file that the URDF names exists, or undefined.
 */
export function readUrdf(root, diagnostics, { withMimics, isFloating, files }) {
  if (root.name !== "robot") {
    diagnostics.report("urdf-root-element", root, `the root element is <${root.name}>, not <robot>`, "export a URDF");
    return null;
  }
  const version = versionOf(root, diagnostics);
  if (version === null) return null;
  const isRight = checkElements(root, version, withMimics, diagnostics);
  checkDialects(root, diagnostics);
  checkAppearance(root, shapesOf(version), files, diagnostics);
  if (!checkNames(root, isFloating, diagnostics) || !isRight) return null;
  const colors = new Colors(root);
  const links = childrenOf(root, "link").map((element) => linkOf(element, shapesOf(version), colors));
  const joints = childrenOf(root, "joint").map((element) => jointOf(element, version));
  const rootLink = rootOf(links, joints, diagnostics);
  const byName = new Map(joints.map((joint) => [joint.name, joint]));
  const areMimicsRight = !withMimics || checkMimics(byName, diagnostics);
  if (rootLink === null || !areMimicsRight) return null;
  const name = root.attributes.get("name");
  return {
    name,
    element: root,
    links: new Map(links.map((link) => [link.name, link])),
    joints: byName,
    root: rootLink,
  };
}

/** The version of URDF as a number, 0.9 if the robot states none; null if there is no such version. */
function versionOf(root, diagnostics) {
  const stated = root.attributes.get("version");
  if (stated === undefined) return 0.9;
  if (VERSIONS.includes(stated)) return Number(stated);
  const hint = `write one of ${VERSIONS.join(", ")}, or leave it out`;
  diagnostics.report("urdf-version", valueOf(root, "version"), `URDF has no version '${stated}'`, hint);
  return null;
}

function originOf(element) {
  const xyz = numbersOf(element, "origin", "xyz", [0, 0, 0]);
  const quaternion = numbersOf(element, "origin", "quat_xyzw", null);
  if (quaternion) return { R: fromQuaternion(quaternion), p: xyz };
  return fromOrigin(xyz, numbersOf(element, "origin", "rpy", [0, 0, 0]));
}

function linkOf(element, shapes, colors) {
  const name = element.attributes.get("name");
  const [inertial] = childrenOf(element, "inertial");
  const used = element.children.filter(({ name: use }) => use === "visual" || use === "collision");
  const link = { name, element, mass: 0, inertia: null, shapes: used.map((each) => shapeOf(each, shapes, colors)) };
  if (!inertial) return link;
  const [mass] = numbersOf(inertial, "mass", "value");
  const [xx, xy, xz, yy, yz, zz] = MOMENTS.map((key) => numbersOf(inertial, "inertia", key)[0]);
  const matrix = [
    [xx, xy, xz],
    [xy, yy, yz],
    [xz, yz, zz],
  ];
  return { ...link, mass, inertia: { pose: originOf(inertial), matrix } };
}

function shapeOf(element, shapes, colors) {
  const [geometry] = childrenOf(element, "geometry");
  const shape = geometry.children.find(({ name }) => Object.hasOwn(shapes, name));
  const counts = Object.entries(shapes[shape.name].numbers);
  const size = counts.flatMap(([name, count]) => shape.numbers.get(name) ?? Array(count).fill(1));
  const file = shape.attributes.get("filename");
  const mesh = shape.name === "mesh" && { file };
  return { use: element.name, type: shape.name, size, ...mesh, pose: originOf(element), color: colors.of(element) };
}

/** Limits, damping and friction are numbers, or null where there is no limit. */
function jointOf(element, version) {
  const type = element.attributes.get("type");
  const isRanged = WITH_RANGE.includes(type);
  const limit = (name, absent) => numbersOf(element, "limit", name, [absent])[0];
  const range = (name) => (isRanged ? limit(name, version >= 1.2 ? null : 0) : null);
  const [mimic] = childrenOf(element, "mimic");
  return {
    name: element.attributes.get("name"),
    element,
    type,
    axis: numbersOf(element, "axis", "xyz", [1, 0, 0]),
    lower: range("lower"),
    upper: range("upper"),
    effort: limit("effort", null),
    velocity: limit("velocity", null),
    damping: numbersOf(element, "dynamics", "damping", [0])[0],
    friction: numbersOf(element, "dynamics", "friction", [0])[0],
    origin: originOf(element),
    parent: childrenOf(element, "parent")[0].attributes.get("link"),
    child: childrenOf(element, "child")[0].attributes.get("link"),
    mimic: mimic && {
      element: mimic,
      joint: mimic.attributes.get("joint"),
      multiplier: numbersOf(element, "mimic", "multiplier", [1])[0],
      offset: numbersOf(element, "mimic", "offset", [0])[0],
    },
  };
}
