// The two files of a robot, by their paths.

import { closeSync, constants, fstatSync, openSync, readSync } from "node:fs";
import { basename } from "node:path";
import { MOST_BYTES } from "../src/reading/source.js";
import { namedFiles } from "./named_files.js";

const READ = MOST_BYTES + 1; // one more than a file may have, EU-FIL-002

/** What `read` takes, of the files at two paths. */
export const textsAt = ({ description, urdf }) => ({
  description: fileAt(description),
  urdf: fileAt(urdf),
  files: namedFiles(urdf),
});

/** {name, text, problem} of a file; `text` is null if it cannot be read, and `problem` too if it does not exist. */
function fileAt(path) {
  const name = basename(path);
  if (/\.xacro$/i.test(name)) return { name, text: null, problem: "this parser expands no xacro" };
  let file;
  try {
    // Without waiting for a writer, if it is a pipe.
    file = openSync(path, constants.O_RDONLY | constants.O_NONBLOCK);
    if (!fstatSync(file).isFile()) return { name, text: null, problem: "it is no regular file" };
    return { name, text: bytesOf(file) };
  } catch (error) {
    if (error.syscall === undefined) throw error;
    return { name, text: null, problem: error.code === "ENOENT" ? null : error.code };
  } finally {
    if (file !== undefined) closeSync(file);
  }
}

function bytesOf(file) {
  const bytes = new Uint8Array(Math.min(fstatSync(file).size, READ));
  let length = 0;
  for (let more = 1; more && length < bytes.length; length += more) more = readSync(file, bytes, { offset: length });
  return bytes.subarray(0, length);
}
