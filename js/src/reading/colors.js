// The colours of shapes. A material is defined where it is used, in the robot or at an earlier use, EU-URD-029; of two
// definitions of a name, the first one counts.

import { childrenOf, numbersOf } from "./element_check.js";

export class Colors {
  /** `robot`: the root element. */
  constructor(robot) {
    this.known = new Map();
    this.of(robot);
  }

  /** Red, green, blue and alpha from 0 to 1 of the last material in an element; null where the URDF gives none. */
  of(element) {
    let found = null;
    for (const material of childrenOf(element, "material")) {
      const name = material.attributes.get("name") ?? "";
      found = this.known.get(name) ?? null;
      if (this.known.has(name) || !material.children.some((each) => ["color", "texture"].includes(each.name))) continue;
      found = numbersOf(material, "color", "rgba", null)?.map((each) => Math.min(Math.max(each, 0), 1)) ?? null;
      if (name) this.known.set(name, found);
    }
    return found;
  }
}
