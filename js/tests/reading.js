// Robots in texts, for the tests of the reader.

import { read } from "../src/index.js";

/** A link and, for each further name, a link on a continuous joint about z, in a row; `more` is in `<robot>`. */
export function urdf(names, more = "", attributes = "") {
  const links = names.map((name) => `<link name="${name}">${inertial(1, 1)}</link>`);
  const joints = names.slice(1).map((name, i) => joint(`to_${name}`, names[i], name));
  return `<robot name="r" ${attributes}>\n${[...links, ...joints, more].join("\n")}\n</robot>`;
}

export function joint(name, parent, child, more = '<axis xyz="0 0 1"/>', type = "continuous") {
  return `<joint name="${name}" type="${type}"><parent link="${parent}"/><child link="${child}"/>${more}</joint>`;
}

export const inertial = (mass, ixx, iyy = ixx, izz = ixx, origin = "") =>
  `<inertial>${origin}<mass value="${mass}"/>` +
  `<inertia ixx="${ixx}" iyy="${iyy}" izz="${izz}" ixy="0" ixz="0" iyz="0"/></inertial>`;

/** What `read` finds; `description` is the text, or null for a bare URDF. */
export function reading(text, description = null, files = undefined) {
  const given = description === null ? null : { name: "robot.yaml", text: description };
  return read({ description: given, urdf: { name: "robot.urdf", text }, files });
}

/** Each diagnostic as its code, and what is in the text at its place up to a quote, a space or `>`. */
export function found(...given) {
  const lines = given[0].split(/\r\n?|\n/);
  return reading(...given).diagnostics.map(({ code, line, column }) => {
    const rest = [...lines[line - 1]].slice(column - 1).join("");
    return `${code} ${rest.match(/^<?[^\s"'>]*/)[0]}`;
  });
}
