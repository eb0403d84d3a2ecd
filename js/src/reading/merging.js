// Three joints that become one spherical joint: the section on merging, EU-JNT-011 to -014, -022 and -024.

import {
  NO_MOTION,
  add,
  apply,
  compose,
  cross,
  dot,
  norm,
  scale,
  subtract,
  transpose,
  unit,
} from "../mechanism/spatial.js";

const LIGHT = 1e-5; // kg
const FAR = 1e-4; // m
const PARALLEL = 1e-6; // the sine of the angle
const TIE = 1e-9;

// Ordered as EU-JNT-028 asks: which joint is assigned to x, y and z.
const ASSIGNMENTS = [
  [0, 1, 2],
  [0, 2, 1],
  [1, 0, 2],
  [1, 2, 0],
  [2, 0, 1],
  [2, 1, 0],
];

export const areParallel = (a, b) => norm(cross(unit(a), unit(b))) < PARALLEL;

/**
 * Why three joints cannot merge: [code, message], or null. `childrenOf` maps a link to its joints, `held` has links of
 * closures.
 */
export function whyNotMerged(joints, types, links, childrenOf, held) {
  const wrong = joints.find((joint) => !types.includes(joint.type));
  if (wrong) return ["merge-not-chain", `joint '${wrong.name}' is ${wrong.type}, not ${types.join(" or ")}`];
  const between = [0, 1].map((i) => joints[i].child);
  const broken = between.find(
    (link, i) => childrenOf.get(link).length !== 1 || childrenOf.get(link)[0] !== joints[i + 1],
  );
  if (broken !== undefined) return ["merge-not-chain", `link '${broken}' is not the parent of the next joint alone`];
  const heavy = between.find((link) => links.get(link).mass >= LIGHT);
  if (heavy !== undefined) {
    return [
      "merge-inertia",
      `link '${heavy}' between them has a mass of ${links.get(heavy).mass} kg, not below ${LIGHT} kg`,
    ];
  }
  const closed = between.find((link) => held.has(link));
  if (closed !== undefined) return ["merge-closure-frame", `a closure has a frame on link '${closed}' between them`];
  const { axes, centre, points } = chainAtZero(joints);
  const parallel = [
    [0, 1],
    [0, 2],
    [1, 2],
  ].find(([i, j]) => areParallel(axes[i], axes[j]));
  if (parallel) {
    const [a, b] = parallel.map((i) => `'${joints[i].name}'`);
    return ["joint-axes-parallel", `the axes of ${a} and ${b} are parallel`];
  }
  const distances = points.map((point, i) => norm(cross(subtract(centre, point), axes[i])));
  if (distances.every((distance) => distance <= FAR)) return null;
  return ["merge-axes", `an axis misses the centre by ${Math.max(...distances)} m, more than ${FAR} m`];
}

/** Poses (in the parent link of the first joint) and axes of the chain at zero, and P. */
function chainAtZero(joints) {
  const poses = [];
  joints.reduce((above, joint) => {
    poses.push(compose(above, joint.origin));
    return poses.at(-1);
  }, NO_MOTION);
  const axes = poses.map(({ R }, i) => unit(apply(R, unit(joints[i].axis))));
  const points = poses.map(({ p }) => p);
  return { poses, axes, points, centre: nearestPoint(axes, points) };
}

/** The point with the smallest sum of squared distances to three lines. */
function nearestPoint(axes, points) {
  const start = points[2]; // near it, differences are exact
  const across = (axis, a) => subtract(a, scale(dot(axis, a), axis));
  const columns = [0, 1, 2].map((k) => {
    const e = [0, 1, 2].map((i) => (i === k ? 1 : 0));
    return axes.map((axis) => across(axis, e)).reduce(add);
  });
  const right = axes.map((axis, i) => across(axis, subtract(points[i], start))).reduce(add);
  const [a, b, c] = columns;
  const determinant = dot(a, cross(b, c));
  const solution = [dot(right, cross(b, c)), dot(a, cross(right, c)), dot(a, cross(b, right))];
  return add(start, scale(1 / determinant, solution));
}

/** The merged joint's placement in the parent link, the child link's pose after it, and those of the two links. */
export function mergedFrames(joints) {
  const { poses, centre } = chainAtZero(joints);
  const { R, p } = poses[2];
  const origin = norm(subtract(centre, p)) <= FAR ? p : centre;
  const after = { R: NO_MOTION.R, p: apply(transpose(R), subtract(p, origin)) };
  return { placement: { R, p: origin }, after, between: poses.slice(0, 2) };
}

/** The joint that gives each of the axes x, y and z its properties. */
export function assignedJoints(joints) {
  const { poses, axes } = chainAtZero(joints);
  const columns = transpose(poses[2].R);
  const scores = ASSIGNMENTS.map((order) => order.reduce((sum, i, k) => sum + Math.abs(dot(columns[k], axes[i])), 0));
  const highest = Math.max(...scores);
  const best = ASSIGNMENTS[scores.findIndex((score) => score >= highest - TIE)];
  return best.map((i) => joints[i]);
}
