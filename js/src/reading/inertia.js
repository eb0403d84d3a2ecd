// Masses and inertias that no body can have, and leaves without inertia: EU-INR-001 to -004.

import { childrenOf } from "./element_check.js";
import { valueOf } from "./xml.js";
import { principalMoments } from "../mechanism/principal_moments.js";
import { NO_MOTION, add, apply, compose, dot, multiply, scale, subtract, transpose } from "../mechanism/spatial.js";

const SLACK = 1e-6; // of the largest principal moment
const ZERO = 1e-12; // of the sum of the principal moments about the joint's origin

/** Checks each link of a URDF; the names of the links with an error. */
export function checkInertia({ links }, diagnostics) {
  const wrong = new Set();
  for (const { name, element, mass, inertia } of links.values()) {
    if (!inertia) continue;
    const [inertial] = childrenOf(element, "inertial");
    if (mass < 0) {
      const place = valueOf(childrenOf(inertial, "mass")[0], "value");
      diagnostics.report(
        "negative-mass",
        place,
        `the mass of link '${name}' is ${mass} kg`,
        "write the mass of its body",
      );
      wrong.add(name);
    }
    const [place] = childrenOf(inertial, "inertia");
    const [least, middle, largest] = principalMoments(inertia.matrix);
    const stated = `principal moments of link '${name}' are ${[least, middle, largest].map(shown).join(", ")} kg·m²`;
    const hint = "take all six values from one export, about the centre of mass";
    if (least < -SLACK * largest) {
      diagnostics.report("inertia-not-psd", place, `${stated}: none can be negative`, hint);
      wrong.add(name);
    } else if (largest - least - middle > SLACK * largest) {
      diagnostics.report("inertia-triangle", place, `${stated}: the largest exceeds the sum of the others`, hint);
    }
  }
  return wrong;
}

const shown = (number) => Number(number.toPrecision(4));

/** Checks that each leaf of a robot has inertia along each motion of its joint; `wrong` are links to leave out. */
export function checkLeaves(robot, wrong, diagnostics) {
  for (const { joint, carries, links } of bodies(robot)) {
    const hasArmatures = joint.armature?.length && joint.armature.every((armature) => armature > 0);
    if (carries || joint.mimic || hasArmatures || links.some(({ link }) => wrong.has(link.name))) continue;
    const inertia = bodyInertia(links);
    const missing = motions(joint, inertia).find(({ moment }) => moment <= ZERO * trace(inertia.aboutOrigin));
    if (!missing) continue;
    const place = robot.links.get(joint.child).element;
    const message = `link '${joint.child}' has no inertia along ${missing.what} of joint '${joint.name}'`;
    const hint = "give the link its mass and inertia, or the joint an armature, or make the joint fixed";
    diagnostics.report("leaf-without-inertia", place, message, hint);
  }
}

/**
 * The moving bodies of a robot: `joint` moves them, `links` have poses in the frame that the joint moves, and `carries`
 * says whether another moving joint begins there.
 */
function bodies(robot) {
  const root = { joint: { name: "root_joint", type: "floating", child: robot.rootLink }, carries: false, links: [] };
  const found = robot.root === "floating" ? [root] : [];
  const places = new Map(); // a link → its body, and its pose there
  const place = (link, body, pose) => {
    places.set(link, { body, pose });
    if (robot.links.has(link)) body.links.push({ link: robot.links.get(link), pose });
  };
  place(robot.rootLink, root, NO_MOTION);
  for (const joint of robot.joints) {
    const above = places.get(joint.parent);
    if (joint.type === "fixed") {
      place(joint.child, above.body, compose(compose(above.pose, joint.placement), joint.after));
      continue;
    }
    above.body.carries = true;
    found.push({ joint, carries: false, links: [] });
    place(joint.child, found.at(-1), joint.after);
  }
  return found;
}

/** The mass of a body, and its inertia about its centre of mass and about the origin of the joint that moves it. */
function bodyInertia(links) {
  const parts = links
    .filter(({ link }) => link.inertia)
    .map(({ link: { mass, inertia }, pose }) => {
      const { R, p } = compose(pose, inertia.pose);
      return { mass, center: p, inertia: multiply(multiply(R, inertia.matrix), transpose(R)) };
    });
  const mass = parts.reduce((sum, part) => sum + part.mass, 0);
  const moment = parts.map((part) => scale(part.mass, part.center)).reduce(add, [0, 0, 0]);
  const center = mass > 0 ? scale(1 / mass, moment) : [0, 0, 0];
  const about = (point) =>
    parts.map((part) => shifted(part, subtract(part.center, point))).reduce(sum, shifted({ mass: 0 }));
  return { mass, aboutCenter: about(center), aboutOrigin: about([0, 0, 0]) };
}

const sum = (a, b) => a.map((row, i) => add(row, b[i]));
const trace = (matrix) => matrix[0][0] + matrix[1][1] + matrix[2][2];

/** The inertia about a point from which the centre of mass is at `d`. */
function shifted({ mass, inertia }, d = [0, 0, 0]) {
  const of = (i, j) => (inertia?.[i][j] ?? 0) + mass * ((i === j ? dot(d, d) : 0) - d[i] * d[j]);
  return [0, 1, 2].map((i) => [0, 1, 2].map((j) => of(i, j)));
}

/** The inertia along each motion of a joint: the table of the chapter. */
function motions({ type, axes, pitch }, { mass, aboutCenter, aboutOrigin }) {
  const along = (axis, inertia = aboutOrigin) => dot(axis, apply(inertia, axis));
  const slide = { what: "a translation", moment: mass };
  const turn = (moment) => ({ what: "a rotation", moment });
  switch (type) {
    case "prismatic":
      return [slide];
    case "planar":
      return [slide, turn(aboutCenter[2][2])];
    case "floating":
      return [slide, turn(principalMoments(aboutCenter)[0])];
    case "spherical":
      return [turn(principalMoments(aboutOrigin)[0])];
    case "universal":
      return [turn(along(axes[1]))];
    case "cylindrical":
      return [slide, turn(along(axes[0]))];
    case "helical":
      return [turn(along(axes[0]) + (pitch / (2 * Math.PI)) ** 2 * mass)];
    default: // revolute and continuous
      return [turn(along(axes[0]))];
  }
}
