// Poses in typed arrays: twelve numbers each, the rotation row by row and then the origin (m).

export const SIZE = 12;
export const IDENTITY = [1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0];

/** Writes a ∘ b; the three may not overlap. */
export function compose(out, o, a, i, b, j) {
  for (let row = 0; row < 9; row += 3) {
    const x = a[i + row];
    const y = a[i + row + 1];
    const z = a[i + row + 2];
    out[o + row] = x * b[j] + y * b[j + 3] + z * b[j + 6];
    out[o + row + 1] = x * b[j + 1] + y * b[j + 4] + z * b[j + 7];
    out[o + row + 2] = x * b[j + 2] + y * b[j + 5] + z * b[j + 8];
    out[o + 9 + row / 3] = x * b[j + 9] + y * b[j + 10] + z * b[j + 11] + a[i + 9 + row / 3];
  }
}

/** Writes the pose {R, p}, whose R is a list of rows. */
export function write(out, o, { R, p }) {
  for (let i = 0; i < 3; i += 1) {
    for (let j = 0; j < 3; j += 1) out[o + 3 * i + j] = R[i][j];
    out[o + 9 + i] = p[i];
  }
}

/** The pose as {R, p}, with R a list of rows. */
export function read(a, i) {
  const row = (j) => [a[i + j], a[i + j + 1], a[i + j + 2]];
  return { R: [row(0), row(3), row(6)], p: row(9) };
}

/** Writes the rotation by `angle` (rad) about the unit vector `axis`; the origin stays as it is. */
export function writeRotation(out, o, [x, y, z], angle) {
  const s = Math.sin(angle);
  const half = Math.sin(angle / 2);
  const c = 2 * half * half; // 1 - cos(angle), without cancellation
  out[o] = 1 - c * (y * y + z * z);
  out[o + 1] = c * x * y - s * z;
  out[o + 2] = c * x * z + s * y;
  out[o + 3] = c * x * y + s * z;
  out[o + 4] = 1 - c * (x * x + z * z);
  out[o + 5] = c * y * z - s * x;
  out[o + 6] = c * x * z - s * y;
  out[o + 7] = c * y * z + s * x;
  out[o + 8] = 1 - c * (x * x + y * y);
}

/** Writes the rotation of the quaternion x, y, z, w at q[i], of any length but zero; the origin stays as it is. */
export function writeQuaternion(out, o, q, i) {
  const length = Math.hypot(q[i], q[i + 1], q[i + 2], q[i + 3]);
  const x = q[i] / length;
  const y = q[i + 1] / length;
  const z = q[i + 2] / length;
  const w = q[i + 3] / length;
  out[o] = 1 - 2 * (y * y + z * z);
  out[o + 1] = 2 * (x * y - z * w);
  out[o + 2] = 2 * (x * z + y * w);
  out[o + 3] = 2 * (x * y + z * w);
  out[o + 4] = 1 - 2 * (x * x + z * z);
  out[o + 5] = 2 * (y * z - x * w);
  out[o + 6] = 2 * (x * z - y * w);
  out[o + 7] = 2 * (y * z + x * w);
  out[o + 8] = 1 - 2 * (x * x + y * y);
}
