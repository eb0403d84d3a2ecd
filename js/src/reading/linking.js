// The mechanism: what the description makes of the URDF.
// {name, version, root, rootLink, links, frameNames, joints, closures, couplings, actuators, configurations, own,
// frameOf, allFrames}
// A joint moves `child` relative to `parent`: its frame is at `placement` in the parent link, and the child link is at
// `after` in the frame that it moves. A body that no URDF link names has a link of its own.

import { linkActuators } from "./actuators.js";
import { linkClosures } from "./closures.js";
import { linkConfigurations } from "./configurations.js";
import { linkCouplings } from "./couplings.js";
import { Frames } from "./frames.js";
import { fail } from "./invalid.js";
import { areParallel, assignedJoints, mergedFrames, whyNotMerged } from "./merging.js";
import { checkMimics, findLeaders, isMimic } from "./mimic.js";
import { applyStated, inherited } from "./properties.js";
import { JOINT_TYPES } from "../mechanism/joint_types.js";
import { NO_MOTION, unit } from "../mechanism/spatial.js";

const ROTARY = ["revolute", "continuous"];
const MOVING = ["revolute", "continuous", "prismatic", "planar", "floating"];

/** The types in the URDF of a joint that is replaced, EU-JNT-005. */
const REPLACES = {
  spherical: ROTARY,
  universal: ROTARY,
  split: ROTARY,
  cylindrical: [...ROTARY, "prismatic"],
  helical: [...ROTARY, "prismatic"],
  fixed: MOVING,
};

/** Properties that an entry of a mimic joint may state, EU-JNT-030. */
const OF_MIMICS = ["joint", "armature", "damping", "friction", "stiffness", "rest"];

export function link(description, urdf) {
  const changes = changesByJoint(description.changes, urdf.joints);
  const mimics = description.version === "1" ? new Set() : mimicsOf(urdf.joints, description.changes);
  checkMimicChanges(description, changes, mimics, urdf.joints);
  const replaced = new Map([...changes.values()].map((change) => [change, replacement(change, urdf)]));
  const created = createdJoints(replaced);
  checkCreatedNames(description, created, urdf.joints);
  const frames = new Frames(description, urdf, created);
  const closures = linkClosures(description, frames);
  const held = new Set(closures.flatMap((closure) => closure.frames.map((frame) => frame.link)));
  const merges = mergesOf(description, urdf, changes, held);
  const joints = modelJoints(urdf, changes, replaced, merges, mimics);
  const byName = new Map(joints.filter((joint) => !joint.isLock).map((joint) => [joint.name, joint]));
  findLeaders(byName);
  checkBodies(closures, joints);
  const moving = new Map([...byName].filter(([, joint]) => joint.type !== "fixed"));
  return {
    name: urdf.name,
    version: description.version,
    root: description.root,
    rootLink: urdf.root,
    links: urdf.links,
    frameNames: description.frames.map((frame) => frame.name),
    joints,
    closures: closures.filter((closure) => !closure.type.startsWith("x-")),
    couplings: linkCouplings(description, moving),
    actuators: linkActuators(description, moving, changes),
    configurations: linkConfigurations(description, moving),
    own: description.own,
    frameOf: (name) => frames.find({ name }),
    allFrames: frames.all(),
  };
}

/** The change of each joint that is changed or merged. */
function changesByJoint(list, joints) {
  const changes = new Map();
  for (const change of list) {
    for (const name of change.merges ?? [change.joint]) {
      if (!joints.has(name)) fail(`the description changes joint '${name}', which does not exist`);
      if (changes.has(name)) fail(`the description changes joint '${name}' more than once`);
      changes.set(name, change);
    }
  }
  return changes;
}

/** The mimic joints that the description does not free. */
function mimicsOf(joints, changes) {
  checkMimics(joints);
  const mimics = new Set([...joints.values()].filter(isMimic));
  for (const { joint, merges, freed } of changes) {
    if (!freed) continue;
    const found = (merges ?? [joint]).map((name) => joints.get(name)).filter((each) => mimics.delete(each));
    if (!found.length) fail(`joint '${joint}' is freed, but is not a mimic joint`);
  }
  return mimics;
}

function checkMimicChanges({ version }, changes, mimics, joints) {
  for (const mimic of mimics) {
    const own = changes.get(mimic.name);
    const allowed = version === "2.1" && own && Object.keys(own).every((key) => OF_MIMICS.includes(key));
    if (own && !allowed) fail(`joint '${mimic.name}' is a mimic joint: the description cannot change it`);
    const leader = joints.get(mimic.mimic.joint);
    if (changes.get(leader.name)?.type)
      fail(`joint '${leader.name}' is the leader of a mimic joint: it cannot be replaced`);
  }
}

/** Joints with a name of their own, not that of the joint that they replace. */
function createdJoints(replaced) {
  return [...replaced].flatMap(([change, joints]) => {
    const last = change.merges ? change.merges[2] : change.joint;
    return joints.filter((joint) => joint.name !== last);
  });
}

function checkCreatedNames({ root }, created, joints) {
  const names = new Set(joints.keys());
  for (const { name } of created) {
    if (names.has(name)) fail(`the description creates joint '${name}', but another joint has that name`);
    names.add(name);
    if (name === "universe" || (root === "floating" && name === "root_joint")) fail(`the name '${name}' is reserved`);
  }
}

/** The joints that replace those of one change, with the properties that they inherit. */
function replacement(change, urdf) {
  if (change.merges) {
    const [first, , last] = change.merges.map((name) => urdf.joints.get(name));
    return [{ name: change.joint, type: "spherical", parent: first.parent, child: last.child }];
  }
  const joint = urdf.joints.get(change.joint);
  if (change.type && !REPLACES[change.type].includes(joint.type)) {
    fail(`joint '${joint.name}', which is ${joint.type}, cannot become ${change.type}`);
  }
  if (change.axes && areParallel(...change.axes)) fail(`the axes of joint '${joint.name}' are parallel`);
  if (change.type === "split") return splitJoint(joint, change, urdf.links);
  const type = change.type ?? joint.type;
  return [modelJoint(joint, { type, axes: change.axes?.map(unit), pitch: change.pitch })];
}

/** Two joints of the type of `joint`, about two axes of its frame, EU-ONE-006. */
function splitJoint(joint, { letters, axes }, links) {
  let between = joint.name;
  while (links.has(between)) between += "'";
  const [first, second] = letters.map((letter) => `${joint.name}_${letter}`);
  return [
    modelJoint(joint, { name: first, child: between, axes: [axes[0]] }),
    modelJoint(joint, { name: second, parent: between, placement: NO_MOTION, axes: [axes[1]] }),
  ];
}

function modelJoint(joint, changed = {}) {
  const type = changed.type ?? joint.type;
  return {
    name: joint.name,
    parent: joint.parent,
    child: joint.child,
    placement: joint.origin,
    after: NO_MOTION,
    mimic: null,
    ...changed,
    type,
    axes: changed.axes ?? (joint.axis.some(Boolean) ? [unit(joint.axis)] : []),
    ...inherited(type, Array(JOINT_TYPES[type].velocities).fill(joint), changed.pitch),
  };
}

/** Maps the last joint of each three that merge to `{name, joints, change}`. */
function mergesOf(description, urdf, changes, held) {
  const childrenOf = new Map([...urdf.links.keys()].map((name) => [name, []]));
  for (const joint of urdf.joints.values()) childrenOf.get(joint.parent).push(joint);
  const merges = new Map();
  for (const change of description.changes) {
    if (!change.merges) continue;
    const joints = change.merges.map((name) => urdf.joints.get(name));
    const why = whyNotMerged(joints, ROTARY, urdf.links, childrenOf, held);
    if (why) fail(`the joints of '${change.joint}' cannot merge: ${why}`);
    merges.set(joints[2], { name: change.joint, joints, change });
  }
  if (description.version === "1") findMerges(urdf, changes, childrenOf, held, merges);
  return merges;
}

/** Version 1 merges without being asked, from the root outwards, EU-ONE-007. */
function findMerges(urdf, changes, childrenOf, held, merges) {
  for (const open = [...childrenOf.get(urdf.root)]; open.length;) {
    const first = open.pop();
    const chain = [first];
    while (chain.length < 3 && childrenOf.get(chain.at(-1).child).length === 1)
      chain.push(...childrenOf.get(chain.at(-1).child));
    const free = chain.length === 3 && !chain.some((joint) => changes.has(joint.name));
    const merged = free && !whyNotMerged(chain, ["revolute"], urdf.links, childrenOf, held);
    if (merged) merges.set(chain[2], { name: chain[2].name, joints: chain, change: {} });
    open.push(...childrenOf.get((merged ? chain[2] : first).child));
  }
}

/** The joints of the model, each after the one that moves its parent. */
function modelJoints(urdf, changes, replaced, merges, mimics) {
  const between = new Set([...merges.values()].flatMap(({ joints }) => joints.slice(0, 2)));
  const joints = [];
  for (const joint of urdf.joints.values()) {
    if (between.has(joint)) continue;
    if (merges.has(joint)) joints.push(...mergedJoint(merges.get(joint)));
    else {
      const change = changes.get(joint.name);
      const made = change ? replaced.get(change) : [modelJoint(joint)];
      if (mimics.has(joint)) made[0].mimic = joint.mimic;
      if (change) applyStated(made[0], change);
      joints.push(...made);
    }
  }
  return outwards(joints, urdf.root);
}

/** A spherical joint, and the two links between its joints as links of its parent's body, EU-JNT-022 and -023. */
function mergedJoint({ name, joints, change }) {
  const { placement, after, between } = mergedFrames(joints);
  const { parent } = joints[0];
  const merged = { name, type: "spherical", parent, child: joints[2].child, placement, after, mimic: null, axes: [] };
  Object.assign(merged, inherited("spherical", assignedJoints(joints)));
  applyStated(merged, change);
  const lock = (pose, i) => ({
    type: "fixed",
    isLock: true,
    parent,
    child: joints[i].child,
    placement: pose,
    after: NO_MOTION,
  });
  return [...between.map(lock), merged];
}

function outwards(joints, root) {
  const below = new Map();
  for (const joint of joints) {
    if (!below.has(joint.parent)) below.set(joint.parent, []);
    below.get(joint.parent).push(joint);
  }
  const ordered = [...(below.get(root) ?? [])];
  for (let i = 0; i < ordered.length; i += 1) ordered.push(...(below.get(ordered[i].child) ?? []));
  return ordered;
}

/** EU-CLO-003. */
function checkBodies(closures, joints) {
  const bodies = new Map();
  const bodyOf = (link) => bodies.get(link) ?? link;
  for (const joint of joints) if (joint.type === "fixed") bodies.set(joint.child, bodyOf(joint.parent));
  for (const { name, frames } of closures) {
    if (bodyOf(frames[0].link) === bodyOf(frames[1].link)) fail(`closure '${name}' connects two frames of one body`);
  }
}
