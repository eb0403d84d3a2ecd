// A robot from its two files.

import { checkBounds } from "./bounds.js";
import { readDescription } from "./description.js";
import { fail } from "./invalid.js";
import { link } from "./linking.js";
import { readText } from "./text.js";
import { readUrdf } from "./urdf.js";
import { parseXml } from "./xml.js";
import { parseYaml } from "./yaml.js";

/** Reads the files at two paths; throws `Invalid` if the robot has an error. */
export function readRobot(descriptionPath, urdfPath) {
  if (/\.xacro$/i.test(urdfPath)) fail(`'${urdfPath}' is a xacro, which this parser does not expand`);
  const description = readDescription(parseYaml(readText(descriptionPath)));
  const urdf = readUrdf(parseXml(readText(urdfPath)));
  const robot = link(description, urdf);
  checkBounds(robot);
  return robot;
}
