// What is shown of a robot.

import { read } from "../../src/index.js";

/** The robot, whose loops are not checked, or the tree of its URDF; null if it has an error. */
export function robotToShow(shows, { description, urdf }) {
  return read({ description: shows === "tree" ? null : description, urdf, loops: false }).robot;
}

/** "robot"; "tree", the URDF alone, if the description has errors; null if the URDF has. */
export const whatToShow = (texts) => ["robot", "tree"].find((shows) => robotToShow(shows, texts)) ?? null;
