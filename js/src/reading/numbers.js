// The bounds of the numbers in both files, EU-FIL-005 and -006. A number is of one of these kinds: `divisor`, which
// others are divided by; `lower` and `upper`, limits that are none beyond the bound; or undefined.

const LARGEST = 1e15;
const SMALLEST = 1e-15;

/** Whether a limit is so large that it is none. */
export function isNone(number, kind) {
  return (kind === "lower" && number < -LARGEST) || (kind === "upper" && number > LARGEST);
}

/** The sizes that are allowed, if that of a number is not one of them; or null. */
export function allowedSizes(number, kind) {
  const isRight = isNone(number, kind) || Math.abs(number) <= LARGEST;
  if (kind !== "divisor") return isRight ? null : "at most 1e15 in size";
  return isRight && (number === 0 || Math.abs(number) >= SMALLEST) ? null : "from 1e-15 to 1e15 in size";
}
