// The form of a description of version 2.0 and 2.1.

import {
  atLeast,
  entries,
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
import { fail } from "./invalid.js";
import { divisor } from "./numbers.js";
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
const ACTUATOR = { gear_ratio: notZero, rotor_inertia: atLeast(0) };
const SHARED = {
  extended_urdf: name,
  urdf: name,
  root: oneOf("fixed", "floating"),
  frames: list(frame),
  configurations,
  metadata,
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
    closures: list(
      closure(["3d", "6d", "hinge", "distance"], {
        compliance,
        axis: vector,
        axes: list(vector, 2, 2),
        length: atLeast(SHORTEST),
      }),
    ),
    couplings: list(coupling),
    joints: changes({ ...CHANGE, stiffness: NOT_NEGATIVE, rest: ANY, mimic: oneOf(false) }),
    actuators: list(actuator({ ...ACTUATOR, name, control: list(number, 2, 2) })),
  },
};
export const VERSION_2_KEYS = Object.keys(KEYS[2.1]);

/** `version` is "2" or "2.1". */
export function readVersion2(value, version) {
  const { extended_urdf, ...optional } = KEYS[version];
  const read = mapping(value, "the description", { extended_urdf }, optional);
  return {
    version,
    root: read.root ?? "fixed",
    closures: read.closures ?? [],
    couplings: read.couplings ?? [],
    changes: read.joints ?? [],
    actuators: read.actuators ?? [],
    frames: read.frames ?? [],
    configurations: read.configurations ?? new Map(),
    own: userData(value),
  };
}

function closure(types, keys) {
  return (value, where) => {
    const type = (each, place) => (name(each, place).startsWith("x-") ? each : oneOf(...types)(each, place));
    const read = mapping(value, where, { name, type, frames: list(placed, 2, 2) }, keys);
    if (read.axis && read.axes) fail(`${where} has both axis and axes`);
    if ((read.axis || read.axes) && read.type !== "hinge") fail(`${where} has an axis, and the type ${read.type}`);
    if ("length" in read !== (read.type === "distance")) fail(`${where}: the key length belongs to the type distance`);
    if (read.compliance?.angular > 0 && ["3d", "distance"].includes(read.type)) {
      fail(`${where} has an angular compliance, but leaves the rotation free`);
    }
    if (read.type === "hinge") read.axes ??= [read.axis ?? [0, 0, 1], read.axis ?? [0, 0, 1]];
    if (read.axes?.some(isZero)) fail(`${where} has an axis of zero`);
    return read;
  };
}

const isZero = (axis) => axis.every((each) => each === 0);

function compliance(value, where) {
  const { linear, angular } = mapping(value, where, {}, COMPLIANCE);
  if (linear === undefined && angular === undefined) fail(`${where} has neither linear nor angular`);
  return { linear: linear ?? 0, angular: angular ?? 0 };
}

/** The frame of a closure: a name, or a pose on a link or joint. */
function placed(value, where) {
  return typeof value === "string" ? { name: name(value, where) } : pose(value, where, {});
}

function frame(value, where) {
  const read = pose(value, where, { name });
  return { name: read.name, frame: { ...read, name: undefined } };
}

function pose(value, where, required) {
  const read = mapping(value, where, required, { link: name, joint: name, xyz: vector, rpy: vector });
  if (read.link !== undefined && read.joint !== undefined) fail(`${where} has both link and joint`);
  if (read.link === undefined && read.joint === undefined) fail(`${where} has no link or joint`);
  return { xyz: [0, 0, 0], rpy: [0, 0, 0], ...read };
}

function coupling(value, where) {
  const joints = (each, place) => {
    const coefficients = new Map(
      entries(each, place).map(([joint, c]) => [joint, notZero(c, `'${joint}' of ${place}`)]),
    );
    if (coefficients.size < 2) fail(`${place} names fewer than two joints`);
    return coefficients;
  };
  return { offset: 0, ...mapping(value, where, { name, joints }, { offset: number }) };
}

function changes(properties) {
  return (value, where) => entries(value, where).map(([joint, each]) => change(joint, each, properties));
}

function change(joint, value, properties) {
  const where = `joint '${joint}'`;
  if (typeof value === "string") return { joint, type: oneOf(...WORDS)(value, where) };
  const own = { axes, pitch: number, merges: list(name, 3, 3) };
  const type = oneOf(...WORDS, "universal", "helical");
  const read = mapping(value, where, {}, { ...properties, type, ...own });
  for (const key of Object.keys(own)) {
    if (key in read && OWN_KEY[read.type] !== key)
      fail(`${where}: the key '${key}' does not fit the type ${read.type}`);
  }
  const needed = OWN_KEY[read.type];
  if (needed && needed !== "merges" && !(needed in read)) fail(`${where} has no key '${needed}'`);
  if ("rest" in read && !("stiffness" in read)) fail(`${where} has a rest position and no stiffness`);
  if (!read.type && !Object.keys(read).length) fail(`${where} states nothing`);
  if (read.pitch === 0) fail(`the pitch of ${where} is 0`);
  if (read.pitch !== undefined) divisor(read.pitch, `the pitch of ${where}`);
  const { mimic, ...rest } = read;
  return { joint, ...rest, ...(mimic === false && { freed: true }) };
}

function axes(value, where) {
  if (typeof value !== "string") {
    const read = list(vector, 2, 2)(value, where);
    if (read.some(isZero)) fail(`${where}: an axis is zero`);
    return read;
  }
  oneOf("xy", "xz", "yx", "yz", "zx", "zy")(value, where);
  return [...value].map((letter) => [0, 1, 2].map((i) => (LETTERS[i] === letter ? 1 : 0)));
}

function limits(value, where) {
  const read = mapping(value, where, {}, LIMITS);
  if (!Object.keys(read).length) fail(`${where} states no limit`);
  return read;
}

function actuator(optional) {
  return (value, where) => {
    if (typeof value === "string") return { joint: name(value, where) };
    const read = mapping(value, where, { joint: name }, optional);
    if (read.control?.[0] > read.control?.[1]) fail(`${where}: control is ${read.control}; write the smallest first`);
    return read;
  };
}

function configurations(value, where) {
  const read = (each, place) =>
    new Map(
      entries(each, place).map(([joint, q]) => [joint, [oneOrMore(number, 7)(q, `'${joint}' of ${place}`)].flat()]),
    );
  return new Map(entries(value, where).map(([key, each]) => [key, read(each, `configuration '${key}'`)]));
}

function metadata(value, where) {
  if (!(value instanceof Map)) fail(`${where} is not a mapping`);
  return value;
}
