// A robot from its two files.

import { checkBounds } from "./bounds.mjs";
import { readDescription } from "./description.mjs";
import { fail } from "./invalid.mjs";
import { link } from "./linking.mjs";
import { readText } from "./text.mjs";
import { readUrdf } from "./urdf.mjs";
import { parseXml } from "./xml.mjs";
import { parseYaml } from "./yaml.mjs";

/** Reads the files at two paths; throws `Invalid` if the robot has an error. */
export function readRobot(descriptionPath, urdfPath) {
  if (/\.xacro$/i.test(urdfPath)) fail(`'${urdfPath}' is a xacro, which this parser does not expand`);
  const description = readDescription(parseYaml(readText(descriptionPath)));
  const urdf = readUrdf(parseXml(readText(urdfPath)));
  const robot = link(description, urdf);
  checkBounds(robot);
  return robot;
}
