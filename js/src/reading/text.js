// A file as UTF-8 text within its bound, EU-FIL-001 to -003.

import { closeSync, constants, fstatSync, openSync, readFileSync } from "node:fs";
import { fail } from "./invalid.js";

const MOST_BYTES = 16_777_216;

/** The text of the regular file at `path`, without a byte order mark. */
export function readText(path) {
  const bytes = readBytes(path);
  if (bytes.length > MOST_BYTES) fail(`${path}: the file has more than ${MOST_BYTES} bytes`);
  try {
    return new TextDecoder("utf-8", { fatal: true }).decode(bytes);
  } catch {
    fail(`${path}: the file is not UTF-8 text; save it as UTF-8`);
  }
}

function readBytes(path) {
  let file;
  try {
    // Without waiting for a writer, if it is a pipe.
    file = openSync(path, constants.O_RDONLY | constants.O_NONBLOCK);
    const status = fstatSync(file);
    if (!status.isFile()) fail(`${path}: not a regular file`);
    return status.size > MOST_BYTES ? { length: status.size } : readFileSync(file);
  } catch (error) {
    if (error.code === undefined) throw error;
    fail(`${path}: the file cannot be read (${error.code})`);
  } finally {
    if (file !== undefined) closeSync(file);
  }
}
