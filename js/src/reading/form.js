// The form of values in a description, EU-SCH-001 to -006 and EU-EXT-001. Each check returns the value.

import { fail } from "./invalid.js";
import { bounded, divisor, lowerLimit, upperLimit } from "./numbers.js";

export const isUserKey = (key) => key.startsWith("x-");

/** The entries of a mapping from names, without user data. */
export function entries(value, where) {
  if (!(value instanceof Map)) fail(`${where} is not a mapping`);
  if (value.has("")) fail(`${where} has an empty name`);
  return [...value].filter(([key]) => !isUserKey(key));
}

/** A mapping as an object: `required` and `optional` are checks by key. What is left out is left out. */
export function mapping(value, where, required, optional = {}) {
  const given = entries(value, where);
  for (const key of Object.keys(required)) if (!value.has(key)) fail(`${where} has no key '${key}'`);
  const checks = { ...required, ...optional };
  const read = {};
  for (const [key, each] of given) {
    if (!Object.hasOwn(checks, key)) fail(`${where} has an unknown key '${key}'`);
    read[key] = checks[key](each, `'${key}' of ${where}`);
  }
  return read;
}

export function list(item, least = 0, most = Infinity) {
  return (value, where) => {
    if (!Array.isArray(value)) fail(`${where} is not a list`);
    if (value.length < least || value.length > most) fail(`${where} has a wrong number of items, ${value.length}`);
    return value.map((each, i) => item(each, `item ${i + 1} of ${where}`));
  };
}

/** A string that is not empty. */
export function name(value, where) {
  if (typeof value !== "string") fail(`${where} is not a string`);
  if (value === "") fail(`${where} is empty`);
  return value;
}

export function oneOf(...allowed) {
  return (value, where) => {
    if (!allowed.includes(value)) fail(`${where} is ${JSON.stringify(value)}, not one of ${allowed.join(", ")}`);
    return value;
  };
}

function anyNumber(value, where) {
  if (typeof value !== "number") fail(`${where} is not a number`);
  return value;
}

export const number = (value, where) => bounded(anyNumber(value, where), where);
export const lower = (value, where) => lowerLimit(anyNumber(value, where), where);
export const upper = (value, where) => upperLimit(anyNumber(value, where), where);

/** A velocity or effort limit. */
export function magnitude(value, where) {
  if (anyNumber(value, where) < 0) fail(`${where} is ${value}, less than 0`);
  return upper(value, where);
}

export function atLeast(least) {
  return (value, where) => {
    if (number(value, where) < least) fail(`${where} is ${value}, less than ${least}`);
    return value;
  };
}

export function notZero(value, where) {
  if (number(value, where) === 0) fail(`${where} is 0`);
  return divisor(value, where);
}

/** A number, or a list of 1 to `most` numbers. */
export function oneOrMore(item, most) {
  const several = list(item, 1, most);
  return (value, where) => (Array.isArray(value) ? several(value, where) : item(value, where));
}

export const vector = list(number, 3, 3);
