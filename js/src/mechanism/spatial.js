// Vectors, rotations and poses. A matrix is a list of rows. A pose is {R, p}: it maps c to R c + p.

export const IDENTITY = [
  [1, 0, 0],
  [0, 1, 0],
  [0, 0, 1],
];
export const Z = [0, 0, 1];
export const NO_MOTION = { R: IDENTITY, p: [0, 0, 0] };

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (factor, a) => [factor * a[0], factor * a[1], factor * a[2]];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const norm = (a) => Math.hypot(...a);

/** The unit vector along `a`, which is not zero, whatever its length. */
export function unit(a) {
  const largest = Math.max(...a.map(Math.abs));
  const scaled = a.map((number) => number / largest);
  const length = norm(scaled);
  return scaled.map((number) => number / length);
}

export const transpose = (R) => [0, 1, 2].map((i) => [R[0][i], R[1][i], R[2][i]]);
export const apply = (R, a) => [dot(R[0], a), dot(R[1], a), dot(R[2], a)];
export const applyTransposed = (R, a) => [0, 1, 2].map((i) => R[0][i] * a[0] + R[1][i] * a[1] + R[2][i] * a[2]);

export function multiply(A, B) {
  return A.map((row) => [0, 1, 2].map((j) => row[0] * B[0][j] + row[1] * B[1][j] + row[2] * B[2][j]));
}

export const compose = (a, b) => ({ R: multiply(a.R, b.R), p: add(apply(a.R, b.p), a.p) });

export function inverse({ R, p }) {
  return { R: transpose(R), p: scale(-1, applyTransposed(R, p)) };
}

/** The rotation by `angle` (rad) about the unit vector `axis`. */
export function rotation(axis, angle) {
  const [x, y, z] = axis;
  const s = Math.sin(angle);
  const half = Math.sin(angle / 2);
  const c = 2 * half * half; // 1 - cos(angle), without cancellation
  return [
    [1 - c * (y * y + z * z), c * x * y - s * z, c * x * z + s * y],
    [c * x * y + s * z, 1 - c * (x * x + z * z), c * y * z - s * x],
    [c * x * z - s * y, c * y * z + s * x, 1 - c * (x * x + y * y)],
  ];
}

/** The pose of `xyz` (m) and `rpy` (rad), EU-FRM-006. */
export function fromOrigin(xyz, [roll, pitch, yaw]) {
  const turned = multiply(rotation([0, 1, 0], pitch), rotation([1, 0, 0], roll));
  return { R: multiply(rotation([0, 0, 1], yaw), turned), p: xyz };
}

/** The rotation of a quaternion x, y, z, w of any length but zero. */
export function fromQuaternion(quaternion) {
  const length = Math.hypot(...quaternion);
  const [x, y, z, w] = quaternion.map((number) => number / length);
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
    [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
    [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
  ];
}

/** The unit quaternion x, y, z, w of a rotation, with w >= 0. */
export function toQuaternion(R) {
  const trace = R[0][0] + R[1][1] + R[2][2];
  const i = [R[0][0], R[1][1], R[2][2]].indexOf(Math.max(R[0][0], R[1][1], R[2][2]));
  let quaternion;
  if (trace > R[i][i]) {
    quaternion = [R[2][1] - R[1][2], R[0][2] - R[2][0], R[1][0] - R[0][1], 1 + trace];
  } else {
    const j = (i + 1) % 3;
    const k = (i + 2) % 3;
    quaternion = [0, 0, 0, R[k][j] - R[j][k]];
    quaternion[i] = 1 + R[i][i] - R[j][j] - R[k][k];
    quaternion[j] = R[j][i] + R[i][j];
    quaternion[k] = R[k][i] + R[i][k];
  }
  const length = Math.hypot(...quaternion) * (quaternion[3] < 0 ? -1 : 1);
  return quaternion.map((number) => number / length);
}
