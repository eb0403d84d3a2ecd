// The characteristic length: half the sum of the distances from joint to joint around the longest loop, m.

import { SIZE, compose, write } from "../mechanism/poses.js";
import { NO_MOTION, norm } from "../mechanism/spatial.js";

/** 1 m for loops without extent, such as a spherical linkage whose joints are all at one point. */
export function characteristicLength({ tree, constraints }) {
  const links = new Float64Array(SIZE * tree.bodies.size); // of each link its pose in the frame that a joint moves
  write(links, SIZE * tree.root, NO_MOTION);
  const frame = new Float64Array(SIZE);
  const reaches = new Map(); // of each joint the distance from the one that moves its parent
  for (const joint of tree.joints) {
    const { parent, child, placement, after, type } = joint;
    if (parent < 0) continue;
    compose(frame, 0, links, SIZE * parent, placement, 0);
    if (type === "fixed") compose(links, SIZE * child, frame, 0, after, 0);
    else links.set(after, SIZE * child);
    if (type !== "fixed") reaches.set(joint, norm(frame.subarray(9)));
  }
  let longest = 0;
  for (const { joints, bodies: ends, frames } of constraints) {
    if (!ends.length) continue; // a coupling has no extent
    const arms = ends.map((link, i) => {
      write(frame, 0, frames[i]);
      const anchor = new Float64Array(SIZE);
      compose(anchor, 0, links, SIZE * link, frame, 0);
      return norm(anchor.subarray(9));
    });
    const around = joints.reduce((sum, joint) => sum + (reaches.get(joint) ?? 0), arms[0] + arms[1]);
    longest = Math.max(longest, around);
  }
  return longest > 1e-9 ? longest / 2 : 1;
}
