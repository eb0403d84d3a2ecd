// Where the loops of a robot are open: beside the picture, and in it.

import { Vector3 } from "three";
import { openLoops } from "../../src/closing.js";
import { button, element } from "../elements.js";

const SMALL = 1e-6; // what is not shown beside a larger part, m or rad
const [WIDTH, HEIGHT] = [160, 22]; // of a label, pixels

/** The open closures and couplings: [{name, text, position}], position in the world, m; null for couplings. */
function openOf({ mechanism, q, kinematics }) {
  const closures = new Map(mechanism.robot.closures.map((closure) => [closure.name, closure]));
  return openLoops(mechanism, q).map(({ name, position, angle }) => {
    const ends = closures.get(name)?.frames.map((frame) => kinematics.pose(frame).p);
    const parts = ends
      ? [position > SMALL && length(position), angle > SMALL && `${((angle * 180) / Math.PI).toPrecision(3)}°`]
      : [position.toPrecision(3)];
    return {
      name,
      text: parts.filter(Boolean).join(", "),
      position: ends ? ends[0].map((value, i) => (value + ends[1][i]) / 2) : null,
    };
  });
}

const length = (value) => (value < 0.1 ? `${(1000 * value).toPrecision(3)} mm` : `${value.toPrecision(3)} m`);

/** Fill an element with the open loops, and what to do. `actions.write` is null where the pose cannot be written. */
export function showOpen(parent, session, { assemble, write }) {
  const open = openOf(session);
  parent.replaceChildren();
  if (open.length) {
    const list = element(parent, "ul", { class: "drop-open" });
    for (const { name, text } of open) element(list, "li", {}, `${name} is open by ${text}`);
    button(parent, "Assemble", assemble, { class: "drop-main" });
  } else if (write) button(parent, "Write this pose as “assembled”", write, { class: "drop-main" });
}

/** Labels in the picture, at the open loops. */
export class OpenLoops {
  constructor(viewport, session) {
    Object.assign(this, { viewport, session });
    this.labels = element(viewport.canvas.parentElement, "div", { class: "drop-labels", "aria-hidden": "true" });
    session.addEventListener("change", () => this.fill());
    viewport.drawn.push(() => this.place());
    this.fill();
  }

  fill() {
    this.labels.replaceChildren();
    this.open = openOf(this.session)
      .filter(({ position }) => position)
      .map((each) => ({ ...each, label: element(this.labels, "span", {}, `${each.name}: ${each.text}`) }));
    this.place();
  }

  place() {
    const { camera, canvas } = this.viewport;
    const labels = this.open.map(({ position, label }) => {
      const { x, y, z } = new Vector3(...position).project(camera);
      label.hidden = z > 1;
      return { label, x: ((1 + x) / 2) * canvas.clientWidth, y: ((1 - y) / 2) * canvas.clientHeight };
    });
    labels.sort((a, b) => a.y - b.y);
    labels.forEach((each, i) => {
      for (const other of labels.slice(0, i)) {
        // One below the other, if they would cover each other.
        if (Math.abs(other.x - each.x) < WIDTH && each.y < other.y + HEIGHT) each.y = other.y + HEIGHT;
      }
      each.label.style.left = `${Math.min(each.x, canvas.clientWidth - WIDTH)}px`;
      each.label.style.top = `${each.y}px`;
    });
  }
}
