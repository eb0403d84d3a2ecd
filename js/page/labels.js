// Names in the picture, as text beside the points that they name; of those that overlap, the nearest is shown.

import { element } from "./elements.js";

const APART = 2; // space between labels, pixels

export class Labels {
  constructor(viewport) {
    this.viewport = viewport;
    this.root = element(viewport.canvas.parentElement, "div", { class: "eu-labels", "aria-hidden": "true" });
    this.all = [];
    this.placing = () => this.place();
    viewport.drawn.push(this.placing);
  }

  /** @param pointOf The point in the world, a Vector3; false while it is not shown. */
  add(text, pointOf) {
    this.all.push({ label: element(this.root, "span", {}, text), pointOf });
  }

  place() {
    const { camera, canvas } = this.viewport;
    const { clientWidth, clientHeight } = canvas;
    const seen = [];
    for (const { label, pointOf } of this.all) {
      const at = pointOf();
      label.hidden = true;
      if (!at) continue;
      at.project(camera);
      if (Math.abs(at.x) > 1 || Math.abs(at.y) > 1 || at.z > 1) continue;
      seen.push({ label, depth: at.z, x: (clientWidth * (1 + at.x)) / 2, y: (clientHeight * (1 - at.y)) / 2 });
    }
    for (const each of seen) each.label.hidden = false;
    const sizes = new Map(seen.map(({ label }) => [label, [label.offsetWidth, label.offsetHeight]]));
    const taken = [];
    for (const { label, x, y } of seen.sort((a, b) => a.depth - b.depth)) {
      const [width, height] = sizes.get(label);
      const box = [x, y - height, x + width + APART, y + APART];
      label.hidden = taken.some(([left, top, right, bottom]) => box[0] < right && left < box[2] && box[1] < bottom && top < box[3]);
      if (label.hidden) continue;
      taken.push(box);
      label.style.transform = `translate(${x + 4}px, ${y - height}px)`;
    }
  }

  dispose() {
    this.root.remove();
    this.viewport.drawn.splice(this.viewport.drawn.indexOf(this.placing), 1);
  }
}
