// What is wrong with a robot: the chapter on diagnostics.

import { CODES } from "./codes.js";

const MOST = 100; // of one code, EU-DIA-007
const LONGEST = 600; // characters of a message: a name or value may have megabytes

/** A text of a message, without the end of one that is too long. */
export const clipped = (text) => (text.length > LONGEST ? `${text.slice(0, LONGEST)}…` : text);

export class Diagnostics {
  constructor() {
    this.found = new Map(); // by code, place and part: an alias repeats what is wrong in its anchor
    this.counts = new Map(); // by code
    this.errors = 0; // also those that are left out
  }

  /**
   * Adds one diagnostic, with a code of the specification.
   *
   * `place`: {source, offset, part}; without an offset, the file as a whole; `part` tells apart what begins there.
   * `message` says what is wrong, with its value; `hint`: what to do, or null; a function is called only if the
   * diagnostic is kept.
   */
  report(code, { source, offset = null, part = null }, message, hint = null) {
    if (!CODES.has(code)) throw new Error(`the specification has no code ${code}`);
    const { phase, severity, clause } = CODES.get(code);
    if (severity === "error") this.errors += 1;
    const key = JSON.stringify([code, source.name, offset, part]);
    const count = this.counts.get(code) ?? 0;
    if (this.found.has(key) || count === MOST) return;
    this.counts.set(code, count + 1);
    const { line, column } = offset === null ? { line: null, column: null } : source.position(offset);
    const kept = { code, severity, phase, clause, file: source.name, line, column, message: clipped(message) };
    this.found.set(key, { ...kept, hint: hint instanceof Function ? hint() : hint });
  }

  /** Whether there is an error of one of these phases. */
  has(...phases) {
    return this.all().some(({ severity, phase }) => severity === "error" && phases.includes(phase));
  }

  all() {
    return [...this.found.values()];
  }

  /** In the order of the files and places. */
  list() {
    const all = this.all();
    const files = [...new Set(all.map(({ file }) => file))];
    const byPlace = (a, b) => files.indexOf(a.file) - files.indexOf(b.file) || a.line - b.line || a.column - b.column;
    return all.sort(byPlace).map(({ phase, ...each }) => each);
  }
}
