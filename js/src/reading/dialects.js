// A description for a URDF that has none: its loops and motors in the dialects of Isaac Sim (loop_joint), of
// URDF+ (loop, coupling) and of Drake (ball_constraint, tendon_constraint). docs/import.md describes them; here, several
// points of two links stay 3d closures.

import { isDialect } from "./advised.js";
import { Diagnostics, clipped } from "./diagnostics.js";
import { decimals } from "./element_check.js";
import { Source } from "./source.js";
import { parseXml } from "./xml.js";

const TYPES = {
  spherical: "3d",
  ball: "3d",
  position: "3d",
  fixed: "6d",
  revolute: "hinge",
  continuous: "hinge",
};
const SINGLE = ["revolute", "continuous", "prismatic"];

/**
 * The text of a description of version 2.1, and what it lacks of the URDF, as sentences.
 *
 * `urdfName`: the file name that the description gives for the URDF.
 */
export function closuresOfDialects(urdfText, urdfName = "robot.urdf") {
  const source = new Source(urdfName, urdfText.replace(/^\uFEFF/, ""));
  const root = parseXml(source, new Diagnostics()); // `read` reports what is wrong with it
  const found = new Found();
  for (const element of root?.children ?? []) {
    try {
      const read = READ.get(localName(element));
      if (read) read(element, found, root);
      else if (isDialect(element)) lose("no import reads it; write what it means under closures");
    } catch (error) {
      if (!(error instanceof Loss)) throw error;
      found.losses.push(`<${element.name}>${said(element)} is left out: ${error.message}`);
    }
  }
  if (found.isDrake && !isWorldRoot(root)) found.root = "floating";
  return { description: found.text(urdfName), losses: found.losses.map(clipped) };
}

class Loss extends Error {}

function lose(why) {
  throw new Loss(why);
}

const localName = ({ name }) => name.slice(name.indexOf(":") + 1);
const said = ({ attributes }) => (attributes.has("name") ? ` '${attributes.get("name")}'` : "");
const childrenOf = (element, ...names) => element.children.filter((each) => names.includes(localName(each)));
const child = (element, ...names) => childrenOf(element, ...names)[0] ?? lose(`it has no <${names[0]}>`);
const attribute = (element, name) => element.attributes.get(name) ?? lose(`<${element.name}> has no ${name}`);

function numbers(element, name, count, absent) {
  const text = absent ? (element.attributes.get(name) ?? absent) : attribute(element, name);
  const values = decimals(text);
  if (values.length !== count || !values.every(Number.isFinite)) lose(`${name} is '${text}', not ${count} number(s)`);
  return values;
}

const number = (element, name = "value") => numbers(element, name, 1)[0];

/** What is found in one URDF. */
class Found {
  root = "fixed";
  isDrake = false;
  frames = [];
  closures = [];
  couplings = [];
  actuators = [];
  losses = [];
  carrying = new Map(); // a link → the joint that moves it
  names = new Map(); // each with how often it is stated

  /** A name that no closure, coupling or frame has yet. */
  unique(name) {
    let free = name;
    for (; this.names.has(free); free = `${name}_${this.names.get(name)}`)
      this.names.set(name, this.names.get(name) + 1);
    this.names.set(free, 1);
    return free;
  }

  text(urdfName) {
    const lines = ['extended_urdf: "2.1"'];
    if (urdfName !== "robot.urdf") lines.push(`urdf: ${flow(urdfName)}`);
    if (this.root !== "fixed") lines.push(`root: ${this.root}`);
    for (const key of ["frames", "closures", "couplings", "actuators"]) {
      if (this[key].length) lines.push(`${key}:`, ...this[key].map((item) => `  - ${flow(item)}`));
    }
    return `${lines.join("\n")}\n`;
  }
}

/** A value as YAML on one line. */
function flow(value) {
  if (Array.isArray(value)) return `[${value.map(flow).join(", ")}]`;
  if (typeof value === "number") return String(value);
  if (typeof value === "string") {
    const isPlain = /^[A-Za-z_][\w.-]*$/.test(value) && !/^(true|false|null)$/i.test(value);
    return isPlain ? value : JSON.stringify(value);
  }
  return `{${Object.entries(value)
    .map(([key, each]) => `${flow(key)}: ${flow(each)}`)
    .join(", ")}}`;
}

/** A frame on a link, at the pose of an element `origin`, which may be left out. */
function placed(link, origin) {
  if (origin?.attributes.has("quat_xyzw")) lose(`<${origin.name}> has quat_xyzw; write rpy`);
  const [xyz, rpy] = ["xyz", "rpy"].map((name) => (origin ? numbers(origin, name, 3, "0 0 0") : [0, 0, 0]));
  return { link, ...(xyz.some(Boolean) && { xyz }), ...(rpy.some(Boolean) && { rpy }) };
}

function addClosure(element, stated, frames, axis, found) {
  const type = (Object.hasOwn(TYPES, stated) && TYPES[stated]) || lose(`no closure is of the type '${stated}'`);
  const name = found.unique(element.attributes.get("name") || `${frames[0].link}_${frames[1].link}`);
  if (type !== "hinge") found.closures.push({ name, type, frames });
  else if (axis) found.closures.push({ name, type, frames, axis: numbers(axis, "xyz", 3) });
  else {
    found.closures.push({ name, type: "3d", frames });
    found.losses.push(
      `closure '${name}' is 3d: the URDF states no axis; if you know it, make it a hinge about this axis`,
    );
  }
}

function loopJoint(element, found) {
  const ends = childrenOf(element, "link1", "link2");
  if (ends.length !== 2) lose("it must have two elements <link1> and <link2>");
  const frames = ends.map((end) => placed(attribute(end, "link"), end));
  addClosure(element, attribute(element, "type"), frames, childrenOf(element, "axis")[0], found);
}

function loop(element, found) {
  const frames = [
    ["predecessor", "parent"],
    ["successor", "child"],
  ].map(([name, old]) => {
    const end = child(element, name, old);
    const [origin] = localName(end) === name ? childrenOf(end, "origin") : childrenOf(element, `${old}_origin`);
    return placed(attribute(end, "link"), origin);
  });
  addClosure(element, element.attributes.get("type") ?? "spherical", frames, childrenOf(element, "axis")[0], found);
}

/** ratio times the coordinates of the joints to the predecessor is those of the joints to the successor. */
function coupling(element, found, root) {
  const [before, after] = ["predecessor", "successor"].map((name) =>
    jointsAbove(attribute(child(element, name), "link"), found, root),
  );
  const ratio = number(child(element, "ratio")) || lose("its ratio is 0");
  const joints = new Map();
  const add = (chain, other, factor) => {
    for (const joint of chain) {
      const type = joint.attributes.get("type");
      if (other.includes(joint) || type === "fixed") continue;
      if (!SINGLE.includes(type)) lose(`joint${said(joint)} is ${type}`);
      joints.set(attribute(joint, "name"), factor);
    }
  };
  add(before, after, ratio);
  add(after, before, -1);
  addCoupling(element.attributes.get("name"), joints, 0, found);
}

function addCoupling(stated, joints, offset, found) {
  if (joints.size < 2) lose("it relates fewer than two joints");
  const name = found.unique(stated || [...joints.keys()].join("_"));
  found.couplings.push({ name, joints: Object.fromEntries(joints), ...(offset && { offset }) });
  return name;
}

/** The joints between the root and a link. */
function jointsAbove(link, { carrying }, root) {
  if (!carrying.size) {
    for (const joint of childrenOf(root, "joint")) carrying.set(attribute(child(joint, "child"), "link"), joint);
  }
  const found = new Set();
  for (let joint = carrying.get(link); joint && !found.has(joint);) {
    found.add(joint);
    joint = carrying.get(attribute(child(joint, "parent"), "link"));
  }
  return [...found].reverse();
}

function ballConstraint(element, found) {
  found.isDrake = true;
  const part = (name) => child(element, `ball_constraint_${name}`);
  const frames = [
    ["body_A", "p_AP"],
    ["body_B", "p_BQ"],
  ].map(([body, point]) => ({ link: attribute(part(body), "name"), xyz: numbers(part(point), "value", 3) }));
  addClosure(element, "ball", frames, undefined, found);
}

function tendonConstraint(element, found) {
  found.isDrake = true;
  const value = (name, absent) => {
    const [part] = childrenOf(element, `tendon_constraint_${name}`);
    return part ? number(part) : absent;
  };
  const lower = value("lower_limit", -Infinity);
  if (lower !== value("upper_limit", Infinity)) lose("it bounds a sum of coordinates, and does not fix it");
  const joints = new Map();
  for (const joint of childrenOf(element, "tendon_constraint_joint")) {
    const name = attribute(joint, "name");
    joints.set(name, (joints.get(name) ?? 0) + number(joint, "a"));
  }
  const name = addCoupling(null, joints, lower - value("offset", 0), found);
  found.losses.push(`coupling '${name}' is rigid: the stiffness and damping of its constraint are left out`);
}

/** The root link is `world` if no joint has it as its child, and a link has that name. */
function isWorldRoot(root) {
  return childrenOf(root, "link").some(({ attributes }) => attributes.get("name") === "world");
}

function joint(element, found) {
  if (element.name !== "drake:joint") return;
  found.isDrake = true;
  lose("it is a joint of Drake alone; `eurdf import` makes it one of a description");
}

function fixedFrame(element, found) {
  const frame = placed(attribute(child(element, "parent"), "link"), childrenOf(element, "origin")[0]);
  found.frames.push({ name: found.unique(element.attributes.get("name") || `${frame.link}_frame`), ...frame });
}

function drakeFrame(element, found) {
  if (element.name === "frame") return;
  found.isDrake = true;
  found.frames.push({ name: found.unique(attribute(element, "name")), ...placed(attribute(element, "link"), element) });
}

/** A motor; Drake states its gear and its rotor too. */
function transmission(element, found) {
  const name = attribute(child(element, "joint"), "name");
  if (found.actuators.some((other) => (other.joint ?? other) === name)) lose(`joint '${name}' has another actuator`);
  const [actuator] = childrenOf(element, "actuator");
  const of = (key) => (actuator ? childrenOf(actuator, key) : []).map((part) => [key, number(part)]);
  const motor = Object.fromEntries([...of("gear_ratio"), ...of("rotor_inertia")]);
  found.actuators.push(Object.keys(motor).length ? { joint: name, ...motor } : name);
}

const READ = new Map(
  Object.entries({
    loop_joint: loopJoint,
    fixed_frame: fixedFrame,
    frame: drakeFrame,
    loop,
    loop_constraint: loop,
    coupling,
    ball_constraint: ballConstraint,
    tendon_constraint: tendonConstraint,
    joint,
    transmission,
  }),
);
