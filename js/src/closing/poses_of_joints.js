// Coordinates that a person moves: those of a joint, and those of the pose of planar, spherical and floating joints.
//
// The velocities of these three are in the child's frame, so none of them is the rate of one coordinate. Positions are
// in the joint's frame (m); a rotation is a rotation vector: the axis times the angle (rad).

import { log3 } from "../mechanism/log6.js";
import { quaternionOf } from "../mechanism/motion.js";
import { Z, applyTransposed, fromQuaternion, multiply, rotation, subtract, transpose } from "../mechanism/spatial.js";

const NONE = 1e-9; // m or rad: motions of this size are rounding

/** Bound of a rotation vector, rad: at half a turn it has two directions. */
export const longest = Math.PI * (1 - 1e-6);

/** Whether a joint is moved by its pose. */
export const hasPose = ({ type }) => ["planar", "spherical", "floating"].includes(type);

/** The kind of each coordinate: "length" or "angle". */
export const POSES = {
  planar: ["length", "length", "angle"],
  spherical: ["angle", "angle", "angle"],
  floating: ["length", "length", "length", "angle", "angle", "angle"],
};

export function coordinatesOf({ type, x: i, end, quaternion }, x) {
  const own = Array.from(x.subarray(i, end));
  const wrapped = (angle) => Math.atan2(Math.sin(angle), Math.cos(angle));
  if (type === "continuous") return [wrapped(own[0])];
  if (type === "planar") return [own[0], own[1], wrapped(own[2])];
  if (quaternion < 0) return own;
  return [...own.slice(0, -4), ...log3(fromQuaternion(own.slice(-4)))];
}

/**
 * Motions of one velocity each that lead, one after the other, from some coordinates of a pose to others: a list of
 * [number of the velocity, how far (m or rad)]. A rotation is one about x, one about y and one about z of the child.
 */
export function motionsBetween(type, here, there) {
  return found(type, here, there)
    .map((amount, number) => [number, amount])
    .filter(([, amount]) => Math.abs(amount) > NONE);
}

function found(type, here, there) {
  if (type === "planar") {
    const shift = applyTransposed(rotation(Z, here[2]), [there[0] - here[0], there[1] - here[1], 0]);
    const angle = there[2] - here[2];
    return [shift[0], shift[1], Math.atan2(Math.sin(angle), Math.cos(angle))];
  }
  const [before, after] = [here, there].map((each) => fromQuaternion(quaternionOf(each.slice(-3))));
  const R = multiply(transpose(before), after); // Rx Ry Rz
  const angles = [
    Math.atan2(-R[1][2], R[2][2]),
    Math.atan2(R[0][2], Math.hypot(R[0][0], R[0][1])),
    Math.atan2(-R[0][1], R[0][0]),
  ];
  return type === "spherical" ? angles : [...applyTransposed(before, subtract(there, here)), ...angles];
}
