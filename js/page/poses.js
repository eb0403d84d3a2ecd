// A pose as text: for the YAML file of a robot, and for Python.

import { stringify } from "yaml";

/** Coordinates as files have them; one number stands for itself. Joints at 0 are left out, as neutral. */
const stated = (q) =>
  Object.fromEntries(
    Object.entries(q)
      .filter(([, values]) => values.some(Boolean))
      .map(([joint, values]) => [joint, values.length === 1 ? values[0] : values]),
  );

/** An entry of `configurations`. */
export function asYaml(name, q) {
  return stringify({ configurations: { [name]: stated(q) } }, { collectionStyle: "any", flowCollectionPadding: false });
}

/** A line of Python, for a robot that `eurdf.load` gave. */
export function asPython(q) {
  const values = Object.entries(stated(q)).map(([joint, value]) => `${JSON.stringify(joint)}: ${JSON.stringify(value)}`);
  return `q = robot.configuration({${values.join(", ")}})\n`;
}
