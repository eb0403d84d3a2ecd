// Closures and the frames that they connect, EU-CLO-001 to -004.

import { fail } from "./invalid.js";
import { unit } from "../mechanism/spatial.js";

/** The closures of a description, with frames {link, xyz, rpy}. */
export function linkClosures(description, frames) {
  const names = new Set();
  const pairs = new Set();
  return description.closures.map((closure) => {
    const where = `closure '${closure.name}'`;
    if (names.has(closure.name)) fail(`two closures have the name '${closure.name}'`);
    names.add(closure.name);
    const ends = closure.frames.map((frame) => frames.find(frame));
    const [a, b] = ends.map(({ link, xyz, rpy }) => JSON.stringify([link, xyz, rpy])); // in which -0 is 0
    if (a === b) fail(`${where} connects a frame to itself`);
    const pair = JSON.stringify([a, b].sort());
    if (pairs.has(pair)) fail(`${where} connects the same frames as another closure`);
    pairs.add(pair);
    return { ...closure, frames: ends, axes: closure.axes?.map(unit) };
  });
}
