// Closures and the frames that they connect, EU-CLO-001 to -004.

import { unit } from "../mechanism/spatial.js";

/** The closures of a description that have no error, with frames {link, xyz, rpy}. */
export function linkClosures({ closures }, frames, diagnostics) {
  const names = new Set();
  const pairs = new Map(); // the name of the closure, by its frames
  const linked = [];
  for (const closure of closures) {
    const { name, node } = closure;
    const isRepeated = names.has(name);
    names.add(name);
    if (closure.isFaulty) continue;
    if (isRepeated) {
      const message = `another closure has the name '${name}'`;
      diagnostics.report("duplicate-closure-name", node.get("name"), message, "write another name");
      continue;
    }
    const ends = closure.frames.map((frame) => frames.find(frame));
    if (ends.includes(null)) continue;
    const [a, b] = ends.map(({ link, xyz, rpy }) => JSON.stringify([link, xyz, rpy])); // in which -0 is 0
    const pair = JSON.stringify([a, b].sort());
    if (a === b) {
      const message = `both frames of closure '${name}' are the same frame, on link '${ends[0].link}'`;
      diagnostics.report("closure-same-frame", closure.frames[1].node, message, "name the frame on the other side");
    } else if (pairs.has(pair)) {
      const message = `closure '${name}' connects the same frames as closure '${pairs.get(pair)}'`;
      diagnostics.report("closure-duplicate", node, message, "keep one of the two");
    } else {
      pairs.set(pair, name);
      linked.push({ ...closure, frames: ends, axes: closure.axes?.map(unit) });
    }
  }
  return linked;
}

/** EU-CLO-003: those closures that connect two bodies. */
export function betweenBodies(closures, joints, diagnostics) {
  const bodies = new Map();
  const bodyOf = (link) => bodies.get(link) ?? link;
  for (const { type, isFaulty, parent, child } of joints) {
    if (type === "fixed" && !isFaulty) bodies.set(child, bodyOf(parent));
  }
  return closures.filter(({ name, frames, node }) => {
    if (bodyOf(frames[0].link) !== bodyOf(frames[1].link)) return true;
    const links = [...new Set(frames.map(({ link }) => `'${link}'`))].join(" and ");
    const message = `closure '${name}' connects two frames of one body: only fixed joints are between them (${links})`;
    diagnostics.report("closure-same-body", node, message, "name a frame on the other side of the cut");
    return false;
  });
}

/** EU-CLO-007. */
export function checkBuilt({ name, type, node }, diagnostics) {
  if (!type.startsWith("x-")) return;
  const message = `closure '${name}' of type ${type} is left out`;
  diagnostics.report(
    "closure-type-unknown",
    node.get("type"),
    message,
    "this parser builds 3d, 6d, hinge and distance",
  );
}
