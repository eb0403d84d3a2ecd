// An error in one of the two files, EU-CNF-001: what is wrong, and where.

export class Invalid extends Error {}

/** Throws: `message` says what is wrong, where, and what would be right. */
export function fail(message) {
  throw new Invalid(message);
}
