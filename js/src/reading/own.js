// User data by JSON pointer, EU-CAN-002 and -003.

import { isUserKey } from "./form.js";

const escape = (key) => key.replaceAll("~", "~0").replaceAll("/", "~1");

/** A mapping from the pointer of each user-defined key of version 2, at any level, to its value. */
export function userData(value, pointer = "", found = new Map()) {
  const items = value instanceof Map ? [...value] : Array.isArray(value) ? [...value.entries()] : [];
  for (const [key, each] of items) {
    const here = `${pointer}/${escape(String(key))}`;
    if (value instanceof Map && isUserKey(key)) found.set(here, each);
    else userData(each, here, found);
  }
  return found;
}

/** A mapping from the pointer of each key of version 1 that is not `known` to its value. */
export function unknownKeys(value, known) {
  return new Map([...value].filter(([key]) => !known.includes(key)).map(([key, each]) => [`/${escape(key)}`, each]));
}

/** A value of a description as a JSON value. */
export function toJson(value) {
  if (Array.isArray(value)) return value.map(toJson);
  if (!(value instanceof Map)) return value;
  const object = Object.create(null); // in which `__proto__` is a key like any other
  for (const [key, each] of value) object[key] = toJson(each);
  return object;
}
