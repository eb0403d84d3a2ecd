// The URDF as a tree of links and joints, EU-URD-003 to -024, and -037 to -041. Mimic joints depend on the version of the
// description: see mimic.mjs.

import { fail } from "./invalid.js";
import { bounded, divisor, lowerLimit, upperLimit } from "./numbers.js";
import { fromOrigin, fromQuaternion } from "../mechanism/spatial.js";

const VERSIONS = ["1.0", "1.1", "1.2"];
const RATES = ["acceleration", "deceleration", "jerk"];

const POSE = { origin: { numbers: { xyz: 3, rpy: 3, quat_xyzw: 4 }, check: checkOrientation } };
const MATERIAL = { elements: { color: { needs: ["rgba"], numbers: { rgba: 4 } }, texture: {} } };
const SHAPES = {
  box: { needs: ["size"], numbers: { size: 3 } },
  cylinder: { needs: ["radius", "length"], numbers: { radius: 1, length: 1 } },
  capsule: { needs: ["radius", "length"], numbers: { radius: 1, length: 1 } },
  sphere: { needs: ["radius"], numbers: { radius: 1 } },
  mesh: { needs: ["filename"], names: ["filename"], numbers: { scale: 3 } },
};
const GEOMETRY = { inside: ["geometry"], elements: { ...POSE, geometry: { check: checkGeometry } } };
const LINKED = { needs: ["link"], names: ["link"] };

// The table of the chapter: required attributes, those that are names, numeric ones with their count, required
// elements, elements, and those that are repeatable.
const ROBOT = {
  needs: ["name"],
  names: ["name"],
  repeatable: {
    link: {
      needs: ["name"],
      names: ["name"],
      elements: {
        inertial: {
          inside: ["mass", "inertia"],
          elements: {
            ...POSE,
            mass: { needs: ["value"], numbers: { value: 1 } },
            inertia: {
              needs: ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"],
              numbers: { ixx: 1, ixy: 1, ixz: 1, iyy: 1, iyz: 1, izz: 1 },
            },
          },
        },
      },
      repeatable: {
        visual: { ...GEOMETRY, elements: { ...GEOMETRY.elements, material: MATERIAL } },
        collision: GEOMETRY,
      },
    },
    joint: {
      needs: ["name", "type"],
      names: ["name"],
      inside: ["parent", "child"],
      elements: {
        ...POSE,
        parent: LINKED,
        child: LINKED,
        axis: { needs: ["xyz"], numbers: { xyz: 3 } },
        limit: {
          numbers: { effort: 1, velocity: 1, lower: 1, upper: 1, acceleration: 1, deceleration: 1, jerk: 1 },
        },
        dynamics: { numbers: { damping: 1, friction: 1 } },
        mimic: { needs: ["joint"], names: ["joint"], numbers: { multiplier: 1, offset: 1 } },
      },
    },
    material: { ...MATERIAL, needs: ["name"], names: ["name"] },
  },
};

const TYPES = ["revolute", "continuous", "prismatic", "planar", "floating", "fixed"];
const WITH_AXIS = ["revolute", "continuous", "prismatic"];
const WITH_RANGE = ["revolute", "prismatic"];
const NUMBER = /^[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?$/;

/** `{name, links, joints, root}`: links and joints are Maps by name; `root` is the name of the root link. */
export function readUrdf(root) {
  if (root.name !== "robot") fail(`urdf: the root element is <${root.name}>, not <robot>`);
  const version = versionOf(root);
  dropLater(root, version);
  check(root, ROBOT, "<robot>");
  const links = byName(root, "link", linkOf);
  const joints = byName(root, "joint", (element, name) => jointOf(element, name, version));
  return { name: root.attributes.get("name"), links, joints, root: rootOf(links, joints) };
}

/** The version of URDF as a number; 0.9 if the robot states none. */
function versionOf(root) {
  const stated = root.attributes.get("version");
  if (stated === undefined) return 0.9;
  if (!VERSIONS.includes(stated)) fail(`urdf: URDF has no version '${stated}'`);
  return Number(stated);
}

/** Removes what the version does not have. Only a robot that states version 1.0 has no capsules. */
function dropLater(element, version) {
  if (element.name === "origin" && version < 1.1) element.attributes.delete("quat_xyzw");
  if (element.name === "limit" && version < 1.2) RATES.forEach((rate) => element.attributes.delete(rate));
  if (element.name === "geometry" && version === 1.0) {
    element.children = element.children.filter(({ name }) => name !== "capsule");
  }
  for (const child of element.children) dropLater(child, version);
}

function check(element, table, where) {
  for (const name of table.needs ?? []) if (!element.attributes.has(name)) fail(`urdf: ${where} has no ${name}`);
  for (const name of table.names ?? []) {
    if (!/[^ \t\n\r]/.test(element.attributes.get(name))) fail(`urdf: the ${name} of ${where} is empty`);
  }
  for (const [name, count] of Object.entries(table.numbers ?? {})) numbers(element, name, count, where);
  const counts = new Map();
  for (const child of element.children) {
    const single = lookUp(table.elements, child.name);
    const below = single ?? lookUp(table.repeatable, child.name);
    if (!below) continue;
    counts.set(child.name, (counts.get(child.name) ?? 0) + 1);
    if (single && counts.get(child.name) > 1) fail(`urdf: ${where} has more than one <${child.name}>`);
    check(child, below, `<${child.name}> in ${where}`);
  }
  for (const name of table.inside ?? []) if (!counts.has(name)) fail(`urdf: ${where} has no <${name}>`);
  table.check?.(element, where);
}

function lookUp(table, name) {
  return table && Object.hasOwn(table, name) ? table[name] : undefined;
}

// What a number is, by the name of its attribute: within bounds, EU-FIL-005, or no limit, EU-FIL-006.
const MEANING = {
  lower: lowerLimit,
  multiplier: divisor,
  ...Object.fromEntries(["upper", "effort", "velocity", ...RATES].map((name) => [name, upperLimit])),
};

/** The numbers of an attribute, null where a limit is none; undefined if it is left out. */
function numbers(element, name, count, where) {
  const text = element.attributes.get(name);
  if (text === undefined) return undefined;
  const words = text.split(/[ \t\n\r]+/).filter(Boolean);
  const values = words.map((word) => (NUMBER.test(word) ? Number(word) : NaN));
  if (values.length !== count || !values.every(Number.isFinite)) {
    fail(`urdf: ${name}="${text}" of ${where} is not ${count} finite decimal number(s)`);
  }
  return values.map((value) => (MEANING[name] ?? bounded)(value, `${name} of ${where}`));
}

function checkOrientation(element, where) {
  const quaternion = numbers(element, "quat_xyzw", 4, where);
  if (!quaternion) return;
  if (element.attributes.has("rpy")) fail(`urdf: ${where} has both rpy and quat_xyzw`);
  if (quaternion.every((number) => number === 0)) fail(`urdf: the quaternion of ${where} is zero`);
}

function checkGeometry(element, where) {
  const shapes = element.children.filter((child) => Object.hasOwn(SHAPES, child.name));
  if (shapes.length !== 1) fail(`urdf: ${where} contains ${shapes.length} shapes, not one`);
  const [shape] = shapes;
  const table = SHAPES[shape.name];
  check(shape, table, `<${shape.name}> in ${where}`);
  const sizes = Object.entries(table.numbers).flatMap(([name, count]) => numbers(shape, name, count, where) ?? []);
  const right = shape.name === "mesh" ? (size) => size !== 0 : (size) => size > 0;
  if (!sizes.every(right)) fail(`urdf: <${shape.name}> in ${where} has a size of ${sizes}`);
}

function byName(root, tag, read) {
  const found = new Map();
  for (const element of root.children) {
    if (element.name !== tag) continue;
    const name = element.attributes.get("name");
    if (found.has(name)) fail(`urdf: two elements <${tag}> have the name '${name}'`);
    found.set(name, read(element, name));
  }
  return found;
}

function child(element, tag) {
  return element.children.find((each) => each.name === tag);
}

/** The numbers of an attribute of a child element; `absent` if one of them is left out. */
function numbersOf(element, tag, name, absent) {
  const found = child(element, tag);
  return (found && numbers(found, name, absent.length, tag)) ?? absent;
}

function originOf(element) {
  const xyz = numbersOf(element, "origin", "xyz", [0, 0, 0]);
  const quaternion = numbersOf(element, "origin", "quat_xyzw", [0, 0, 0, 1]);
  if (child(element, "origin")?.attributes.has("quat_xyzw")) return { R: fromQuaternion(quaternion), p: xyz };
  return fromOrigin(xyz, numbersOf(element, "origin", "rpy", [0, 0, 0]));
}

function linkOf(element, name) {
  const inertial = child(element, "inertial");
  const shapes = element.children.filter(({ name }) => name === "visual" || name === "collision").map(shapeOf);
  if (!inertial) return { name, mass: 0, inertia: null, shapes };
  const [mass] = numbersOf(inertial, "mass", "value", [0]);
  const of = (key) => numbersOf(inertial, "inertia", key, [0])[0];
  const [xx, xy, xz, yy, yz, zz] = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"].map(of);
  const matrix = [
    [xx, xy, xz],
    [xy, yy, yz],
    [xz, yz, zz],
  ];
  return { name, mass, inertia: { pose: originOf(inertial), matrix }, shapes };
}

function shapeOf(element) {
  const shape = child(element, "geometry").children.find((each) => Object.hasOwn(SHAPES, each.name));
  const counts = Object.entries(SHAPES[shape.name].numbers);
  const size = counts.flatMap(([name, count]) => numbers(shape, name, count, shape.name) ?? Array(count).fill(1));
  const file = shape.attributes.get("filename");
  return { use: element.name, type: shape.name, size, ...(shape.name === "mesh" && { file }), pose: originOf(element) };
}

/** Limits, damping and friction are numbers, or null where there is no limit. */
function jointOf(element, name, version) {
  const type = element.attributes.get("type");
  if (!TYPES.includes(type)) fail(`urdf: joint '${name}' has the type '${type}', not one of ${TYPES.join(", ")}`);
  const limit = child(element, "limit");
  if (WITH_RANGE.includes(type) && !limit) fail(`urdf: joint '${name}' has no <limit>`);
  const axis = numbersOf(element, "axis", "xyz", [1, 0, 0]);
  if (WITH_AXIS.includes(type) && axis.every((number) => number === 0))
    fail(`urdf: the axis of joint '${name}' is zero`);
  const later = version >= 1.2;
  const ranged = WITH_RANGE.includes(type);
  for (const key of later ? (ranged ? ["lower", "upper"] : []) : ["effort", "velocity"]) {
    if (limit && !limit.attributes.has(key)) fail(`urdf: the <limit> of joint '${name}' has no ${key}`);
  }
  const [lower] = numbersOf(element, "limit", "lower", [later ? null : 0]);
  const [upper] = numbersOf(element, "limit", "upper", [later ? null : 0]);
  const isReversed = lower !== null && upper !== null && lower > upper;
  if ((later || ranged) && isReversed) fail(`urdf: joint '${name}' has lower ${lower} > upper ${upper}`);
  const [effort] = numbersOf(element, "limit", "effort", [null]);
  const [velocity] = numbersOf(element, "limit", "velocity", [null]);
  const [damping] = numbersOf(element, "dynamics", "damping", [0]);
  const [friction] = numbersOf(element, "dynamics", "friction", [0]);
  const rates = RATES.map((rate) => numbersOf(element, "limit", rate, [null])[0]);
  if ([effort, velocity, ...rates, damping, friction].some((number) => number < 0)) {
    fail(`urdf: joint '${name}' has a negative limit, damping or friction`);
  }
  const mimic = child(element, "mimic");
  return {
    name,
    type,
    axis,
    lower: ranged ? lower : null,
    upper: ranged ? upper : null,
    effort,
    velocity,
    damping,
    friction,
    origin: originOf(element),
    parent: child(element, "parent").attributes.get("link"),
    child: child(element, "child").attributes.get("link"),
    mimic: mimic && {
      joint: mimic.attributes.get("joint"),
      multiplier: numbersOf(element, "mimic", "multiplier", [1])[0],
      offset: numbersOf(element, "mimic", "offset", [0])[0],
    },
  };
}

/** The only link without a parent, of a tree. */
function rootOf(links, joints) {
  if (!links.size) fail("urdf: the robot has no link");
  const parents = new Map();
  for (const joint of joints.values()) {
    for (const link of [joint.parent, joint.child]) {
      if (!links.has(link)) fail(`urdf: joint '${joint.name}' names the link '${link}', which does not exist`);
    }
    if (parents.has(joint.child)) fail(`urdf: link '${joint.child}' is the child of two joints`);
    parents.set(joint.child, joint.parent);
  }
  const roots = [...links.keys()].filter((link) => !parents.has(link));
  if (roots.length !== 1) fail(`urdf: ${roots.length} links have no parent, not one`);
  const below = new Map([...links.keys()].map((link) => [link, []]));
  for (const joint of joints.values()) below.get(joint.parent).push(joint.child);
  let reached = 0;
  for (const open = [roots[0]]; open.length; reached += 1) open.push(...below.get(open.pop()));
  if (reached !== links.size) fail("urdf: joints form a cycle");
  return roots[0];
}
