// A file as UTF-8 text within its bound, EU-FIL-001 to -003, and the lines and columns of its characters.
// A place is an object with a `source`, and with an `offset` in it (in UTF-16 units) unless it is the file as a whole.

/** Of a file. */
export const MOST_BYTES = 16_777_216;

export class Source {
  /** `text`: without a byte order mark. */
  constructor(name, text) {
    this.name = name;
    this.text = text;
  }

  /** The place of the file as a whole. */
  get whole() {
    return { source: this };
  }

  at(offset) {
    return { source: this, offset };
  }

  /** {line, column} of an offset, from 1, in Unicode characters: EU-DIA-011 and -012. */
  position(offset) {
    this.starts ??= [0, ...[...this.text.matchAll(/\r\n?|\n/g)].map((end) => end.index + end[0].length)];
    let [line, after] = [0, this.starts.length];
    while (after - line > 1) {
      const middle = (line + after) >> 1;
      if (this.starts[middle] <= offset) line = middle;
      else after = middle;
    }
    const before = this.text.slice(this.starts[line], offset);
    const pairs = before.match(/[\uD800-\uDBFF][\uDC00-\uDFFF]/g)?.length ?? 0;
    return { line: line + 1, column: before.length - pairs + 1 };
  }
}

/**
 * The source with that name, or null if it has an error. `text`: a string, or the bytes of a file; `problem`: why
 * there is none.
 */
export function readSource({ name, text, problem }, diagnostics) {
  const whole = new Source(name, "").whole;
  if (text === null || text === undefined) {
    diagnostics.report("file-unreadable", whole, `${name} cannot be read: ${problem ?? "there is no such file"}`);
    return null;
  }
  const bytes = typeof text === "string" ? new TextEncoder().encode(text) : text;
  if (bytes.length > MOST_BYTES) {
    const message = `${name} has more than ${MOST_BYTES} bytes (16 MiB)`;
    diagnostics.report("file-too-large", whole, message, "check that it is the file that you mean");
    return null;
  }
  const hint = "save the file as UTF-8";
  if (bytes[0] === 0 || (bytes[1] === 0 && bytes.length > 1)) {
    diagnostics.report("file-not-utf8", new Source(name, "").at(0), `${name} is UTF-16 or UTF-32, not UTF-8`, hint);
    return null;
  }
  try {
    return new Source(name, new TextDecoder("utf-8", { fatal: true }).decode(bytes));
  } catch {
    const valid = validPart(bytes);
    const place = new Source(name, valid).at(valid.length);
    diagnostics.report("file-not-utf8", place, `${name} has a byte here that is not UTF-8`, hint);
    return null;
  }
}

/** The text before the first byte that is not UTF-8: by bisection, because a decoder does not say where it failed. */
function validPart(bytes) {
  const decoded = (length) =>
    new TextDecoder("utf-8", { fatal: true }).decode(bytes.subarray(0, length), { stream: true });
  let [right, wrong] = [0, bytes.length + 1]; // lengths; a character that is cut at the end is wrong only there
  while (wrong - right > 1) {
    const middle = (right + wrong) >> 1;
    try {
      decoded(middle);
      right = middle;
    } catch {
      wrong = middle;
    }
  }
  return decoded(right);
}
