// Robots on a page without a server: each element "eu-live" contains, in a script of type application/json, its files:
// {urdf: {name, text}, description: {name, text} or null, meshes: {name: base64}, q}, and shows the robot at q.
// An event "eu-robot" on it, whose detail are other files, shows these; meshes that it leaves out stay as they are.

import { Mechanism } from "../src/mechanism.js";
import { read } from "../src/index.js";
import { element } from "./elements.js";
import { View } from "./view.js";

class LiveRobot {
  constructor(root) {
    Object.assign(this, { root, meshes: {}, problems: [] });
    root.addEventListener("eu-robot", ({ detail }) => this.show(detail));
    this.show(JSON.parse(root.querySelector("script").textContent));
  }

  /** Show a robot, if it has no errors, and what is wrong with it. */
  show({ urdf, description, meshes, q }) {
    const { root } = this;
    this.meshes = { ...this.meshes, ...meshes };
    const { robot, diagnostics } = read({ description, urdf });
    const mesh = async (file) => {
      if (!Object.hasOwn(this.meshes, file)) throw new Error("the page does not contain it");
      return Uint8Array.from(atob(this.meshes[file]), (character) => character.charCodeAt(0)).buffer;
    };
    if (robot && root.view) root.view.show(robot, { q: q ?? kept(root.view.session.q, robot), mesh });
    else if (robot) root.view = new View(root, robot, { q: q ?? undefined, mesh, embedded: !root.closest(".eu-alone") });
    for (const each of this.problems) each.remove();
    const errors = diagnostics.filter(({ severity }) => severity === "error");
    this.problems = errors.map(({ message }) => element(root.view?.panel.form ?? root, "p", { class: "eu-live-problem" }, message));
  }
}

/** A configuration of the robot before, if the robot has the same joints. */
function kept(q, robot) {
  const other = Object.entries(new Mechanism(robot).neutral());
  const isOf = other.every(([joint, own]) => q[joint]?.length === own.length) && other.length === Object.keys(q).length;
  return isOf ? q : undefined;
}

for (const root of document.querySelectorAll(".eu-live")) new LiveRobot(root);
