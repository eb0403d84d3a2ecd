// Frames by name and by pose: the chapter on frames. A frame is {link, xyz, rpy}.

import { fail } from "./invalid.js";

const ORIGIN = { xyz: [0, 0, 0], rpy: [0, 0, 0] };

export class Frames {
  /** `created`: the joints that the description creates. */
  constructor(description, urdf, created) {
    this.links = new Set([...urdf.links.keys()]);
    this.joints = new Map([...urdf.joints.values(), ...created].map((joint) => [joint.name, joint.child]));
    this.named = new Map();
    this.checkReserved(description, [...urdf.links.keys(), ...urdf.joints.keys()]);
    for (const { name, frame } of description.frames) {
      if (this.links.has(name) || this.joints.has(name) || this.named.has(name))
        fail(`the name '${name}' of a frame is taken`);
      this.named.set(name, null);
      this.named.set(name, this.find(frame));
    }
  }

  checkReserved({ root, frames }, names) {
    for (const name of [...names, ...frames.map((frame) => frame.name)]) {
      if (name === "universe" || (root === "floating" && name === "root_joint")) fail(`the name '${name}' is reserved`);
    }
  }

  /** The frame that a name or a pose of the description specifies. */
  find({ name, link, joint, xyz, rpy }) {
    if (link !== undefined) {
      if (!this.links.has(link)) fail(`there is no link '${link}'`);
      return { link, xyz, rpy };
    }
    if (joint !== undefined) {
      if (!this.joints.has(joint)) fail(`there is no joint '${joint}'`);
      return { link: this.joints.get(joint), xyz, rpy };
    }
    if (this.named.has(name)) return this.named.get(name);
    const found = new Set([
      ...(this.links.has(name) ? [name] : []),
      ...(this.joints.has(name) ? [this.joints.get(name)] : []),
    ]);
    if (!found.size) fail(`there is no frame '${name}'`);
    if (found.size > 1) fail(`the frame '${name}' is ambiguous: a link and a joint with another child have this name`);
    return { link: [...found][0], ...ORIGIN };
  }

  /** The frames that the description adds. */
  all() {
    return [...this.named.values()];
  }
}
