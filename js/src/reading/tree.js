// Names of links and joints, and the tree that they form: EU-URD-009 to -011, and -014 to -018.

import { childrenOf } from "./element_check.js";
import { meant } from "./near.js";
import { valueOf } from "./xml.js";

const isName = (text) => /[^ \t\n\r]/.test(text ?? "");

/** Checks the names of links and joints of the root element, also if other elements have errors; whether all are right. */
export function checkNames(robot, isFloating, diagnostics) {
  let isRight = true;
  const error = (...diagnostic) => {
    isRight = false;
    diagnostics.report(...diagnostic);
  };
  const [links, joints] = ["link", "joint"].map((kind) => childrenOf(robot, kind));
  if (!links.length) error("urdf-no-link", robot, "the robot has no link", "add a <link>");
  checkUnique(links, isFloating, error);
  checkUnique(joints, isFloating, error);
  const names = new Set(links.map(({ attributes }) => attributes.get("name")));
  if (![...names].every(isName)) return false; // a link that is named elsewhere may be the one without a name
  for (const joint of links.length ? joints : []) {
    for (const end of ["parent", "child"]) {
      const [place] = childrenOf(joint, end);
      const link = place?.attributes.get("link");
      if (!isName(link) || names.has(link)) continue;
      const message = `the ${end} of joint '${joint.attributes.get("name") ?? ""}' is '${link}', which is no link`;
      error("urdf-unknown-link", valueOf(place, "link"), message, meant(link, names));
    }
  }
  return isRight;
}

function checkUnique(elements, isFloating, error) {
  const seen = new Set();
  for (const element of elements) {
    const name = element.attributes.get("name");
    if (!isName(name)) continue;
    const place = valueOf(element, "name");
    if (seen.has(name)) {
      error(`urdf-duplicate-${element.name}`, place, `another ${element.name} has the name '${name}'`, "rename one");
    }
    if (name === "universe" || (isFloating && name === "root_joint")) {
      error("urdf-reserved-name", place, `the name '${name}' is reserved`, "write another name");
    }
    seen.add(name);
  }
}

/** The name of the root link, or null after an error; the names of links and joints are right. */
export function rootOf(links, joints, diagnostics) {
  let isRight = true;
  const error = (...diagnostic) => {
    isRight = false;
    diagnostics.report(...diagnostic);
  };
  const parents = new Map(); // a link → its joint
  for (const joint of joints) {
    const other = parents.get(joint.child);
    if (other) {
      const message = `link '${joint.child}' is the child of the joints '${other.name}' and '${joint.name}'`;
      const hint = "remove this joint, and describe it under closures";
      error("urdf-two-parents", valueOf(childrenOf(joint.element, "child")[0], "link"), message, hint);
    } else parents.set(joint.child, joint);
  }
  if (!isRight) return null; // a link may lack its parent because another has two
  for (const joint of cycles(parents)) {
    const message = `joint '${joint.name}' is in a cycle: link '${joint.child}' is below itself`;
    error("urdf-cycle", joint.element, message, "remove one joint of the cycle, and describe it under closures");
  }
  const roots = links.filter(({ name }) => !parents.has(name));
  if (roots.length > 1) {
    const listed = roots
      .slice(0, 10)
      .map(({ name }) => `'${name}'`)
      .join(", ");
    const message = `${roots.length} links have no parent: ${listed}`;
    error("urdf-two-roots", valueOf(roots[1].element, "name"), message, "add a joint of which this link is the child");
  }
  return isRight ? roots[0].name : null;
}

/** The last joint of each cycle, in the order of the file, if each link has one parent. */
function cycles(parents) {
  const found = [];
  const order = new Map([...parents.values()].map((joint, i) => [joint, i]));
  const passed = new Map(); // a link → the start of the walk that came there
  for (const start of parents.keys()) {
    let link = start;
    for (; parents.has(link) && !passed.has(link); link = parents.get(link).parent) passed.set(link, start);
    if (passed.get(link) !== start) continue;
    let last = parents.get(link);
    for (let joint = last; (joint = parents.get(joint.parent)) !== parents.get(link);) {
      if (order.get(joint) > order.get(last)) last = joint;
    }
    found.push(last);
  }
  return found;
}
