// Where a constant twist leads in 1 s. A quaternion is x, y, z, w.

import { add, cross, norm, scale } from "./spatial.js";

/** The quaternion of the rotation by the angle |w|, rad, about w. */
export function quaternionOf(w) {
  const angle = norm(w);
  const s = angle < 1e-4 ? 0.5 - (angle * angle) / 48 : Math.sin(angle / 2) / angle;
  return [...scale(s, w), Math.cos(angle / 2)];
}

export function multiplied([ax, ay, az, aw], [bx, by, bz, bw]) {
  return [
    aw * bx + ax * bw + ay * bz - az * by,
    aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw,
    aw * bw - ax * bx - ay * by - az * bz,
  ];
}

export function normalized(quaternion) {
  const length = Math.hypot(...quaternion);
  return quaternion.map((each) => each / length);
}

/** How far a frame moves, in its own axes, along the twist (v, w) in its own axes. */
export function displacement(v, w) {
  const angle = norm(w);
  const square = angle * angle;
  const a = angle < 1e-4 ? 0.5 - square / 24 : (2 * Math.sin(angle / 2) ** 2) / square;
  const b = angle < 1e-3 ? 1 / 6 - square / 120 : (angle - Math.sin(angle)) / (square * angle);
  const turned = cross(w, v);
  return add(add(v, scale(a, turned)), scale(b, cross(w, turned)));
}
