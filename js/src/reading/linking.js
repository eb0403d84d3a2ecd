// The mechanism: what the description makes of the URDF.
// {name, version, root, rootLink, links, frameNames, joints, closures, couplings, actuators, configurations, own, node,
// frameOf, allFrames}
// A joint moves `child` relative to `parent`: its frame is at `placement` in the parent link, and the child link is at
// `after` in the frame that it moves. A body that no URDF link names has a link of its own. `node` is the description;
// links and joints have the `element` of the URDF, and closures the `node`, that states them.

import { linkActuators } from "./actuators.js";
import { betweenBodies, checkBuilt, linkClosures } from "./closures.js";
import { linkConfigurations } from "./configurations.js";
import { linkCouplings } from "./couplings.js";
import { Frames, checkReserved } from "./frames.js";
import { JointNames } from "./joint_names.js";
import { areParallel, assignedJoints, mergedFrames, whyNotMerged } from "./merging.js";
import { findLeaders, isMimic } from "./mimic.js";
import { meant } from "./near.js";
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

/** The mechanism, or null if it has an error. */
export function link(description, urdf, diagnostics) {
  const before = diagnostics.errors;
  const changes = changesByJoint(description.changes, urdf.joints, diagnostics);
  const mimics = description.version === "1" ? new Set() : mimicsOf(urdf.joints, description.changes, diagnostics);
  checkMimicChanges(description, changes, mimics, urdf.joints, diagnostics);
  const replaced = new Map(description.changes.map((change) => [change, replacement(change, urdf, diagnostics)]));
  const created = createdJoints(replaced);
  checkCreatedNames(description, created, urdf.joints, diagnostics);
  const frames = new Frames(
    description,
    urdf,
    created.map(({ joint }) => joint),
    diagnostics,
  );
  const linked = linkClosures(description, frames, diagnostics);
  const held = new Set(linked.flatMap((closure) => closure.frames.map((frame) => frame.link)));
  const merges = mergesOf(description, urdf, changes, held, diagnostics);
  const joints = modelJoints(urdf, changes, replaced, merges, mimics, diagnostics);
  const byName = new Map(joints.filter((joint) => !joint.isLock).map((joint) => [joint.name, joint]));
  findLeaders(byName, diagnostics);
  const closures = betweenBodies(linked, joints, diagnostics);
  const names = new JointNames(byName, urdf.joints, description.changes, merges);
  checkUserKeys(description, names, diagnostics);
  const couplings = linkCouplings(description, names, diagnostics);
  const actuators = linkActuators(description, names, changes, diagnostics);
  const configurations = linkConfigurations(description, names, diagnostics);
  if (diagnostics.errors > before || description.changes.some((change) => change.isFaulty)) return null;
  closures.forEach((closure) => checkBuilt(closure, diagnostics));
  return {
    name: urdf.name,
    version: description.version,
    root: description.root,
    rootLink: urdf.root,
    links: urdf.links,
    frameNames: description.frames.map((frame) => frame.name),
    joints,
    closures: closures.filter((closure) => !closure.type.startsWith("x-")),
    couplings,
    actuators,
    configurations,
    own: description.own,
    node: description.node,
    frameOf: (name) => frames.find({ name }),
    allFrames: frames.all(),
  };
}

/** Where a change names a joint that it changes or merges. */
const placeOfName = ({ merges, node, key }, i) => (merges ? node.get("merges").get(i) : key);

/** The change of each joint that is changed or merged; a change with a wrong name becomes faulty. */
function changesByJoint(list, joints, diagnostics) {
  const changes = new Map();
  for (const change of [...list.filter(({ merges }) => merges), ...list.filter(({ merges }) => !merges)]) {
    for (const [i, name] of (change.merges ?? [change.joint]).entries()) {
      const place = placeOfName(change, i);
      if (joints.has(name) && !changes.has(name)) {
        changes.set(name, change);
        continue;
      }
      if (joints.has(name)) {
        const message = `joint '${name}' is changed or merged twice`;
        diagnostics.report(
          "duplicate-replacement",
          change.merges ? place : change.node,
          message,
          "keep one of the two",
        );
      } else
        diagnostics.report("unknown-joint", place, `'${name}' is no joint of the URDF`, meant(name, joints.keys()));
      change.isFaulty = true;
      change.isUnknown = !change.merges && !joints.has(name);
    }
  }
  return changes;
}

/** The mimic joints that the description does not free. */
function mimicsOf(joints, changes, diagnostics) {
  const mimics = new Set([...joints.values()].filter(isMimic));
  for (const change of changes) {
    const { joint, merges, freed, node } = change;
    if (!freed || change.isFaulty) continue;
    const found = (merges ?? [joint]).map((name) => joints.get(name)).filter((each) => mimics.delete(each));
    if (found.length) continue;
    change.isFaulty = true;
    diagnostics.report("joint-not-mimic", node.get("mimic"), `joint '${joint}' is no mimic joint`, "remove the key");
  }
  return mimics;
}

/** EU-JNT-004 and -030. */
function checkMimicChanges({ version }, changes, mimics, joints, diagnostics) {
  const report = (change, place, message, hint) => {
    change.isFaulty = true;
    diagnostics.report("joint-mimics", place, message, hint);
  };
  const placeIn = (change, name) => (change.merges ? placeOfName(change, change.merges.indexOf(name)) : change.node);
  const hint = "version 2.1 frees a mimic joint by mimic: false";
  for (const { name, mimic } of mimics) {
    const own = changes.get(name);
    if (own && !own.isFaulty) {
      const isAllowed = version === "2.1" && !own.type && !own.limits;
      const place = version === "2.1" && !own.type ? own.node.get("limits") : placeIn(own, name);
      const what = place === own.node || own.merges ? "cannot be changed" : "cannot have limits";
      if (!isAllowed) report(own, place, `joint '${name}' is a mimic joint, which ${what}`, hint);
    }
    const leading = changes.get(joints.get(mimic.joint).name);
    if (!leading?.type || leading.isFaulty) continue;
    report(leading, placeIn(leading, mimic.joint), `joint '${mimic.joint}' is the leader of '${name}'`, hint);
  }
}

/** Joints with a name of their own, not that of the joint that they replace: {joint, change}. */
function createdJoints(replaced) {
  return [...replaced].flatMap(([change, joints]) => {
    const last = change.merges ? change.merges[2] : change.joint;
    return joints.filter((joint) => joint.name !== last).map((joint) => ({ joint, change }));
  });
}

function checkCreatedNames({ root }, created, joints, diagnostics) {
  const names = new Set(joints.keys());
  for (const { joint, change } of created) {
    if (names.has(joint.name)) {
      change.isFaulty = true;
      const message = `the description creates joint '${joint.name}', and another joint has that name`;
      diagnostics.report("duplicate-joint-name", change.key, message, "write another name");
    } else if (checkReserved(joint.name, change.key, root, diagnostics)) change.isFaulty = true;
    names.add(joint.name);
  }
}

/** EU-EXT-003. */
function checkUserKeys({ version, node }, names, diagnostics) {
  if (version === "1" || !node) return;
  const mappings = [
    node.get("joints"),
    ...(node.get("couplings")?.content ?? []).map((coupling) => coupling.get("joints")),
    ...[...(node.get("configurations")?.content ?? [])].map(([, { value }]) => value),
  ];
  for (const mapping of mappings.filter((each) => each?.isMapping)) {
    for (const [key, { key: place }] of mapping.content) {
      if (!key.startsWith("x-") || !names.has(key)) continue;
      const message = `'${key}' is a joint, but a key that begins with x- is your own data`;
      diagnostics.report("own-key-is-joint", place, message, "rename the joint");
    }
  }
}

/** The joints that replace those of one change. After an error, they have no child. */
function replacement(change, urdf, diagnostics) {
  if (change.isUnknown) return [];
  if (change.merges) {
    const [first, , last] = change.merges.map((name) => urdf.joints.get(name));
    return [{ name: change.joint, type: "spherical", parent: first?.parent, child: last?.child }];
  }
  const joint = urdf.joints.get(change.joint);
  if (change.isFaulty) return [modelJoint(joint)];
  if (change.type && !REPLACES[change.type].includes(joint.type)) {
    change.isFaulty = true;
    const place = change.node.isMapping ? change.node.get("type") : change.node;
    const type = change.type === "split" ? "universal" : change.type;
    const message = `joint '${joint.name}' is ${joint.type}, and cannot become ${type}`;
    diagnostics.report(
      "joint-kind",
      place,
      message,
      `a ${type} joint is ${REPLACES[change.type].join(" or ")} in the URDF`,
    );
    return change.type === "split" ? splitJoint(joint, change, urdf.links) : [modelJoint(joint)];
  }
  if (change.axes && areParallel(...change.axes)) {
    change.isFaulty = true;
    const message = `the axes of joint '${joint.name}' are parallel`;
    diagnostics.report("joint-axes-parallel", change.node.get("axes"), message, "write two different directions");
  }
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
    element: joint.element,
    ...changed,
    type,
    axes: changed.axes ?? (joint.axis.some(Boolean) ? [unit(joint.axis)] : []),
    ...inherited(type, Array(JOINT_TYPES[type].velocities).fill(joint), changed.pitch),
  };
}

/** Maps the last joint of each three that merge to `{name, joints, change}`. */
function mergesOf(description, urdf, changes, held, diagnostics) {
  const childrenOf = new Map([...urdf.links.keys()].map((name) => [name, []]));
  for (const joint of urdf.joints.values()) childrenOf.get(joint.parent).push(joint);
  const merges = new Map();
  for (const change of description.changes) {
    if (!change.merges || change.isFaulty) continue;
    const joints = change.merges.map((name) => urdf.joints.get(name));
    const why = whyNotMerged(joints, ROTARY, urdf.links, childrenOf, held);
    if (why) {
      change.isFaulty = true;
      const [code, reason] = why;
      diagnostics.report(code, change.node.get("merges"), `the joints of '${change.joint}' cannot merge: ${reason}`);
    } else merges.set(joints[2], { name: change.joint, joints, change });
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
function modelJoints(urdf, changes, replaced, merges, mimics, diagnostics) {
  const between = new Set([...merges.values()].flatMap(({ joints }) => joints.slice(0, 2)));
  const joints = [];
  for (const joint of urdf.joints.values()) {
    if (between.has(joint)) continue;
    if (merges.has(joint)) joints.push(...mergedJoint(merges.get(joint), diagnostics));
    else {
      const change = changes.get(joint.name);
      const made = change && !change.merges ? replaced.get(change) : [modelJoint(joint)];
      if (mimics.has(joint)) made[0].mimic = joint.mimic;
      if (change?.isFaulty) made.forEach((each) => (each.isFaulty = true));
      else if (change) applyStated(made[0], change, diagnostics);
      joints.push(...made);
    }
  }
  return outwards(joints, urdf.root);
}

/** A spherical joint, and the two links between its joints as links of its parent's body, EU-JNT-022 and -023. */
function mergedJoint({ name, joints, change }, diagnostics) {
  const { placement, after, between } = mergedFrames(joints);
  const { parent } = joints[0];
  const merged = {
    name,
    type: "spherical",
    parent,
    child: joints[2].child,
    placement,
    after,
    mimic: null,
    axes: [],
    element: joints[2].element,
  };
  Object.assign(merged, inherited("spherical", assignedJoints(joints)));
  applyStated(merged, change, diagnostics);
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
