// The bounds of the numbers in both files, EU-FIL-005 and -006.

import { fail } from "./invalid.js";

const LARGEST = 1e15;
const SMALLEST = 1e-15;

export function bounded(number, where) {
  if (Math.abs(number) > LARGEST) fail(`${where} is ${number}, beyond ${LARGEST} in size`);
  return number;
}

/** A number that others are divided by; 0 is left to the caller. */
export function divisor(number, where) {
  if (number !== 0 && Math.abs(number) < SMALLEST) fail(`${where} is ${number}, below ${SMALLEST} in size`);
  return bounded(number, where);
}

/** A limit, or null where the number is so large that it is none. */
export function lowerLimit(number, where) {
  return number < -LARGEST ? null : bounded(number, where);
}

export function upperLimit(number, where) {
  return number > LARGEST ? null : bounded(number, where);
}
