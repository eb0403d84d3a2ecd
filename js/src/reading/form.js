// The form of values in a description, EU-SCH-001 to -006 and EU-EXT-001. A check takes a node, where it is in words, and
// the diagnostics. It returns the value, or undefined after an error.

import { isNear } from "./near.js";
import { allowedSizes, isNone } from "./numbers.js";

export const isUserKey = (key) => key.startsWith("x-");

/** A value in a message. */
export function shown({ content, isList, isMapping }) {
  if (isList) return "a list";
  if (isMapping) return "a mapping";
  if (content === null) return "left empty";
  return typeof content === "string"
    ? `'${content.length > 60 ? `${content.slice(0, 60)}…` : content}'`
    : String(content);
}

function wrongType(node, where, wanted, diagnostics) {
  const isWord = typeof node.content === "string" && /^[-+]?[0-9.]+$/.test(node.content);
  const hint = wanted.startsWith("a number") && isWord ? "remove the quotes" : `write ${wanted}`;
  diagnostics.report("wrong-type", node, `${where} is ${shown(node)}, not ${wanted}`, hint);
}

/** The entries [name, value, key] of a mapping from names, without user data. */
export function entries(node, where, diagnostics) {
  if (!node.isMapping) {
    wrongType(node, where, "a mapping", diagnostics);
    return [];
  }
  if (node.has("")) diagnostics.report("wrong-value", node.key(""), `${where} has an empty name`, "write a name");
  return [...node.content].filter(([key]) => key && !isUserKey(key)).map(([key, each]) => [key, each.value, each.key]);
}

/**
 * A mapping as an object, with its `node`. What is left out is left out.
 *
 * `checks`: by key. `needs`: keys that must be there; each is a name, or a list of names of which one must be.
 * `any`: names of which one must be there, unless another key is. `requires`: keys that another key requires.
 */
export function mapping(node, where, diagnostics, checks, { needs = [], any = [], requires = {} } = {}) {
  if (!node.isMapping) return wrongType(node, where, "a mapping", diagnostics);
  const read = { node };
  const unknown = [];
  for (const [key, { key: place, value }] of node.content) {
    if (Object.hasOwn(checks, key)) read[key] = checks[key](value, `${key} of ${where}`, diagnostics);
    else if (!isUserKey(key)) {
      unknown.push(key);
      const right = Object.keys(checks).find((each) => isNear(key, each));
      const hint = right ? `did you mean '${right}'?` : "a key of your own begins with x-";
      diagnostics.report("unknown-key", place, `${where} has an unknown key '${key}'`, hint);
    }
  }
  const isThere = (name) => node.has(name) || unknown.some((key) => isNear(key, name));
  for (const [key, other] of Object.entries(requires)) {
    if (!Object.hasOwn(checks, key) || !node.has(key) || isThere(other)) continue;
    diagnostics.report("missing-key", node.key(key), `${where} has ${key}, but no ${other}`, `add ${other}`);
  }
  const missing = needs.filter((names) => ![names].flat().some(isThere)).map((names) => [names].flat().join(" or "));
  if (any.length && !unknown.length && !any.some((name) => node.has(name))) missing.push(any.join(" or "));
  if (missing.length) {
    diagnostics.report("missing-key", node, `${where} has no ${missing.join(", no ")}`, `add ${missing.join(", ")}`);
  }
  return read;
}

/** A mapping with any keys. */
export function anyMapping(node, where, diagnostics) {
  return node.isMapping ? node : wrongType(node, where, "a mapping", diagnostics);
}

/** An item with `isFaulty`: whether it has an error. */
export function item(check) {
  return (node, where, diagnostics) => {
    const before = diagnostics.errors;
    const read = check(node, where, diagnostics);
    return read && { ...read, isFaulty: diagnostics.errors > before };
  };
}

export function list(check, least = 0, most = Infinity) {
  return (node, where, diagnostics) => {
    if (!node.isList) return wrongType(node, where, "a list", diagnostics);
    const { length } = node.content;
    if (length < least || length > most) {
      const wanted = least === most ? least : `${least} to ${most}`;
      diagnostics.report("wrong-length", node, `${where} has ${length} items, not ${wanted}`, `write ${wanted} items`);
    }
    return node.content.map((each, i) => check(each, `item ${i + 1} of ${where}`, diagnostics));
  };
}

/** A string that is not empty. */
export function name(node, where, diagnostics) {
  if (typeof node.content !== "string") return wrongType(node, where, "a string", diagnostics);
  if (node.content !== "") return node.content;
  return diagnostics.report("wrong-value", node, `${where} is empty`, "write a name");
}

export function oneOf(...allowed) {
  return (node, where, diagnostics) => {
    const { content } = node;
    if (typeof content !== typeof allowed[0]) {
      return wrongType(node, where, typeof allowed[0] === "string" ? "a string" : "a boolean", diagnostics);
    }
    if (allowed.includes(content)) return content;
    const right =
      typeof content === "string" && allowed.find((each) => each === content.toLowerCase() || isNear(content, each));
    const hint = right ? `did you mean '${right}'?` : `write ${allowed.join(", ")}`;
    return diagnostics.report(
      "wrong-value",
      node,
      `${where} is ${shown(node)}, not one of ${allowed.join(", ")}`,
      hint,
    );
  };
}

/** A number of a kind of `numbers.js`: `least` or more, and not 0 if it is a divisor. */
function numberOf({ kind, least = -Infinity, isZeroAllowed = kind !== "divisor" } = {}) {
  return (node, where, diagnostics) => {
    const { content } = node;
    if (typeof content !== "number") return wrongType(node, where, "a number", diagnostics);
    if (content < least || (content === 0 && !isZeroAllowed)) {
      const wanted = content < least ? `at least ${least}` : "other than 0";
      return diagnostics.report(
        "out-of-range",
        node,
        `${where} is ${content}, not ${wanted}`,
        `write a number that is ${wanted}`,
      );
    }
    const sizes = allowedSizes(content, kind);
    if (sizes) {
      diagnostics.report(
        "number-out-of-bounds",
        node,
        `${where} is ${content}, not ${sizes}`,
        "correct the exponent or the unit",
      );
    }
    return isNone(content, kind) ? null : content;
  };
}

export const number = numberOf();
export const lower = numberOf({ kind: "lower" });
export const upper = numberOf({ kind: "upper" });
/** A velocity or effort limit. */
export const magnitude = numberOf({ kind: "upper", least: 0 });
export const atLeast = (least) => numberOf({ least });
export const notZero = numberOf({ kind: "divisor" });
/** A number that may be 0 in form. */
export const divisor = numberOf({ kind: "divisor", isZeroAllowed: true });

/** A number, or a list of 1 to `most` numbers. */
export function oneOrMore(check, most) {
  const several = list(check, 1, most);
  return (node, ...rest) => (node.isList ? several : check)(node, ...rest);
}

export const vector = list(number, 3, 3);
