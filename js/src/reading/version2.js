// The form of a description of version 2.0 and 2.1.

import {
  anyMapping,
  atLeast,
  divisor,
  entries,
  item,
  list,
  lower,
  magnitude,
  mapping,
  name,
  notZero,
  number,
  oneOf,
  oneOrMore,
  upper,
  vector,
} from "./form.js";
import { userData } from "./own.js";

const LETTERS = "xyz";
const WORDS = ["spherical", "cylindrical", "fixed"];
const OWN_KEY = { universal: "axes", helical: "pitch", spherical: "merges" };
const SHORTEST = 1e-4; // m, of a distance

const NOT_NEGATIVE = oneOrMore(atLeast(0), 6);
const ANY = oneOrMore(number, 6);
const COMPLIANCE = { linear: atLeast(0), angular: atLeast(0) };
const MAGNITUDE = oneOrMore(magnitude, 6);
const LIMITS = { lower: oneOrMore(lower, 6), upper: oneOrMore(upper, 6), velocity: MAGNITUDE, effort: MAGNITUDE };

const CHANGE = { limits, damping: NOT_NEGATIVE, friction: NOT_NEGATIVE, armature: NOT_NEGATIVE };
const ACTUATOR = { joint: name, gear_ratio: notZero, rotor_inertia: atLeast(0) };
const SHARED = {
  extended_urdf: name,
  urdf: name,
  root: oneOf("fixed", "floating"),
  frames: list(frame),
  configurations,
  metadata: anyMapping,
};

/** The keys that closures of one type have. */
const OF_TYPES = {
  hinge: { axis: vector, axes: list(vector, 2, 2) },
  distance: { length: atLeast(SHORTEST) },
};

/** Checks by version and key. */
const KEYS = {
  2: {
    ...SHARED,
    closures: list(closure(["3d", "6d"], {})),
    joints: changes(CHANGE),
    actuators: list(actuator(ACTUATOR)),
  },
  2.1: {
    ...SHARED,
    closures: list(closure(["3d", "6d", "hinge", "distance"], { compliance, ...OF_TYPES.hinge, ...OF_TYPES.distance })),
    couplings: list(item(coupling)),
    joints: changes({ ...CHANGE, stiffness: NOT_NEGATIVE, rest: ANY, mimic: oneOf(false) }),
    actuators: list(actuator({ ...ACTUATOR, name, control: list(number, 2, 2) })),
  },
};
export const VERSION_2_KEYS = Object.keys(KEYS[2.1]);

/** `version` is "2" or "2.1". */
export function readVersion2(top, version, diagnostics) {
  const read = mapping(top, "the description", diagnostics, KEYS[version]);
  return {
    version,
    root: read.root ?? "fixed",
    node: top,
    closures: read.closures ?? [],
    couplings: read.couplings ?? [],
    changes: read.joints ?? [],
    actuators: read.actuators ?? [],
    frames: read.frames ?? [],
    configurations: read.configurations ?? [],
    own: userData(top.plain()),
  };
}

/** Reports that a key excludes others of the same mapping. */
function conflict(node, key, why, diagnostics) {
  diagnostics.report("conflicting-keys", node.key(key), `the key ${key} conflicts with ${why}`, `remove one of them`);
}

function closure(types, keys) {
  const type = (node, ...rest) => (node.content?.startsWith?.("x-") ? node.content : oneOf(...types)(node, ...rest));
  const checks = { name, type, frames: list(placed, 2, 2), ...keys };
  return item((node, where, diagnostics) => {
    const isDistance = node.isMapping && node.get("type")?.content === "distance" && "length" in keys;
    const needs = ["name", "type", "frames", ...(isDistance ? ["length"] : [])];
    const isLater = node.isMapping && !("length" in keys) && OF_TYPES[node.get("type")?.content];
    const read = mapping(node, where, diagnostics, isLater ? { ...checks, ...isLater } : checks, { needs });
    if (!read?.type) return read;
    for (const [other, own] of Object.entries(OF_TYPES)) {
      for (const key of Object.keys(own)) {
        if (read.type !== other && key in keys && node.has(key))
          conflict(node, key, `the type ${read.type}`, diagnostics);
      }
    }
    if (read.type === "hinge" && node.has("axis") && node.has("axes")) conflict(node, "axis", "axes", diagnostics);
    if (read.compliance?.angular > 0 && ["3d", "distance"].includes(read.type)) {
      const message = `a closure of type ${read.type} leaves the rotation free, but its angular compliance is not 0`;
      diagnostics.report("closure-compliance", node.get("compliance").get("angular"), message, "remove angular");
    }
    if (read.type === "hinge") {
      if (read.axis) checkAxis("closure-axis-zero", read.axis, node.get("axis"), diagnostics);
      read.axes?.forEach((axis, i) => checkAxis("closure-axis-zero", axis, node.get("axes").get(i), diagnostics));
      read.axes ??= [read.axis ?? [0, 0, 1], read.axis ?? [0, 0, 1]];
    }
    return read;
  });
}

function checkAxis(code, axis, place, diagnostics) {
  if (axis?.every((each) => each === 0)) {
    diagnostics.report(code, place, "the axis is zero, which has no direction", "write a vector along the axis");
  }
}

function compliance(node, where, diagnostics) {
  const read = mapping(node, where, diagnostics, COMPLIANCE, { any: Object.keys(COMPLIANCE) });
  return read && { linear: read.linear ?? 0, angular: read.angular ?? 0 };
}

/** The frame of a closure: a name, or a pose on a link or joint. */
function placed(node, where, diagnostics) {
  if (typeof node.content === "string") return { name: name(node, where, diagnostics), node };
  return pose({})(node, where, diagnostics);
}

function frame(node, where, diagnostics) {
  const read = item(pose({ name }))(node, where, diagnostics);
  return read && { name: read.name, frame: { ...read, name: undefined }, node, isFaulty: read.isFaulty };
}

function pose(keys) {
  const checks = { ...keys, link: name, joint: name, xyz: vector, rpy: vector };
  return (node, where, diagnostics) => {
    const read = mapping(node, where, diagnostics, checks, { needs: [...Object.keys(keys), ["link", "joint"]] });
    if (read && node.has("link") && node.has("joint")) conflict(node, "joint", "link", diagnostics);
    return read && { xyz: [0, 0, 0], rpy: [0, 0, 0], ...read };
  };
}

function coupling(node, where, diagnostics) {
  const joints = (each, place) => {
    const given = entries(each, place, diagnostics);
    if (each.isMapping && given.length < 2) {
      const message = `${place} has ${given.length} joints, not two or more`;
      diagnostics.report("wrong-length", each, message, "a coupling relates two joints");
    }
    const coefficient = ([joint, value]) => [joint, notZero(value, `coefficient of joint '${joint}'`, diagnostics)];
    return new Map(given.map(coefficient));
  };
  const read = mapping(node, where, diagnostics, { name, joints, offset: number }, { needs: ["name", "joints"] });
  return read && { offset: 0, ...read };
}

function changes(properties) {
  return (node, where, diagnostics) =>
    entries(node, where, diagnostics).map(([joint, value, key]) => {
      const check = item((...rest) => change(joint, properties, ...rest));
      return { joint, node: value, key, ...check(value, `joint '${joint}'`, diagnostics) };
    });
}

/** The entry of a joint: a word or a mapping. */
function change(joint, properties, node, where, diagnostics) {
  if (typeof node.content === "string") return { type: oneOf(...WORDS)(node, where, diagnostics) };
  const type = node.isMapping ? node.get("type")?.content : undefined;
  const stated = node.isMapping ? Object.values(OWN_KEY).filter((key) => node.has(key)) : [];
  const checks = {
    ...properties,
    type: oneOf(...WORDS, "universal", "helical"),
    axes,
    pitch: divisor,
    merges: list(name, 3, 3),
  };
  const own =
    type === "universal" || type === "helical" ? OWN_KEY[type] : type === undefined && stated.length && "type";
  const read = mapping(node, where, diagnostics, checks, {
    needs: own ? [own] : [],
    any: type === undefined && !stated.length ? Object.keys(properties) : [],
    requires: { rest: "stiffness" },
  });
  if (!read) return read;
  for (const key of stated) {
    if (read.type && OWN_KEY[read.type] !== key) conflict(node, key, `the type ${read.type}`, diagnostics);
  }
  if (read.pitch === 0) {
    const message = `the pitch of ${where} is 0`;
    diagnostics.report("joint-pitch-zero", node.get("pitch"), message, "write the advance per revolution, in m");
  }
  if (Array.isArray(node.get("axes")?.content)) {
    read.axes?.forEach((axis, i) => checkAxis("joint-axis-zero", axis, node.get("axes").get(i), diagnostics));
  }
  const { mimic, ...kept } = read;
  return { ...kept, ...(mimic === false && { freed: true }) };
}

function axes(node, where, diagnostics) {
  if (typeof node.content !== "string") return list(vector, 2, 2)(node, where, diagnostics);
  const word = oneOf("xy", "xz", "yx", "yz", "zx", "zy")(node, where, diagnostics);
  return word && [...word].map((letter) => [0, 1, 2].map((i) => (LETTERS[i] === letter ? 1 : 0)));
}

function limits(node, where, diagnostics) {
  return mapping(node, where, diagnostics, LIMITS, { any: Object.keys(LIMITS) });
}

function actuator(checks) {
  return item((node, where, diagnostics) => {
    if (typeof node.content === "string") return { joint: name(node, where, diagnostics), node };
    const read = mapping(node, where, diagnostics, checks, { needs: ["joint"] });
    if (read?.control?.[0] > read?.control?.[1]) {
      const message = `control is from ${read.control[0]} to ${read.control[1]}`;
      diagnostics.report("actuator-control-reversed", node.get("control"), message, "write the smaller number first");
    }
    return read;
  });
}

function configurations(node, where, diagnostics) {
  return entries(node, where, diagnostics).map(([name, value, key]) => {
    const coordinates = entries(value, `configuration '${name}'`, diagnostics).map(([joint, each, place]) => {
      const what = `joint '${joint}' of configuration '${name}'`;
      const read = item((...rest) => ({ q: [oneOrMore(number, 7)(...rest)].flat() }))(each, what, diagnostics);
      return { joint, ...read, node: each, key: place };
    });
    return { name, coordinates, node: value, key };
  });
}
