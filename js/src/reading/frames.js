// Frames by name and by pose: the chapter on frames. A frame is {link, xyz, rpy}.

import { meant } from "./near.js";

const ORIGIN = { xyz: [0, 0, 0], rpy: [0, 0, 0] };

/** Reports a name that the format keeps for itself, EU-URD-011; whether it did. */
export function checkReserved(name, place, root, diagnostics) {
  const isReserved = name === "universe" || (root === "floating" && name === "root_joint");
  if (isReserved)
    diagnostics.report("urdf-reserved-name", place, `the name '${name}' is reserved`, "write another name");
  return isReserved;
}

export class Frames {
  /** `created`: the joints that the description creates; without a `child`, they have an error. */
  constructor({ root, frames }, urdf, created, diagnostics) {
    this.diagnostics = diagnostics;
    this.links = new Set(urdf.links.keys());
    this.joints = new Map([...urdf.joints.values(), ...created].map((joint) => [joint.name, joint.child]));
    this.named = new Map();
    for (const { name, frame, node, isFaulty } of frames) {
      const place = node.get("name");
      if (checkReserved(name, place, root, diagnostics)) continue;
      if (this.links.has(name) || this.joints.has(name) || this.named.has(name)) {
        const kind = this.named.has(name) ? "frame" : this.links.has(name) ? "link" : "joint";
        const message = `the frame '${name}' has the name of another ${kind}`;
        diagnostics.report("duplicate-frame", place, message.replace("another link", "a link"), "write another name");
        continue;
      }
      this.named.set(name, isFaulty ? null : this.find(frame));
    }
  }

  /** The frame that a name or a pose of the description specifies; null after an error. */
  find({ name, link, joint, xyz, rpy, node }) {
    if (link !== undefined)
      return this.links.has(link) ? { link, xyz, rpy } : this.unknown("link", link, node.get("link"));
    if (joint !== undefined) {
      if (!this.joints.has(joint)) return this.unknown("joint", joint, node.get("joint"));
      return this.joints.get(joint) === undefined ? null : { link: this.joints.get(joint), xyz, rpy };
    }
    if (this.named.has(name)) return this.named.get(name);
    const isLink = this.links.has(name);
    if (!this.joints.has(name)) return isLink ? { link: name, ...ORIGIN } : this.unknown("frame", name, node);
    const child = this.joints.get(name);
    if (!isLink || child === name) return child === undefined ? null : { link: child, ...ORIGIN };
    const message = `'${name}' is a link, and a joint whose child is the link '${child}'`;
    this.diagnostics.report("ambiguous-frame", node, message, "write {link: …} or {joint: …}, or rename one of them");
    return null;
  }

  unknown(kind, name, place) {
    const names = { link: this.links, joint: this.joints.keys() };
    const known = names[kind] ?? [...this.links, ...this.joints.keys(), ...this.named.keys()];
    const what = kind === "frame" ? "link, joint or frame" : kind;
    this.diagnostics.report("unknown-frame", place, `'${name}' is no ${what} of the robot`, meant(name, known));
    return null;
  }

  /** The frames that the description adds. */
  all() {
    return [...this.named.values()];
  }
}
