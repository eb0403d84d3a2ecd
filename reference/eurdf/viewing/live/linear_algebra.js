// Rotations, poses and the singular value decomposition.
//
// A vector is an array of numbers, a quaternion is x y z w. A pose is {R, p}: the rotation, row by row (9), and the
// origin (3), m.
"use strict";

(function () {
  const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
  const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const scaled = (s, a) => [s * a[0], s * a[1], s * a[2]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const norm = (a) => Math.hypot(...a);

  const rotate = (R, v) => [
    R[0] * v[0] + R[1] * v[1] + R[2] * v[2],
    R[3] * v[0] + R[4] * v[1] + R[5] * v[2],
    R[6] * v[0] + R[7] * v[1] + R[8] * v[2],
  ];
  const rotateBack = (R, v) => [
    R[0] * v[0] + R[3] * v[1] + R[6] * v[2],
    R[1] * v[0] + R[4] * v[1] + R[7] * v[2],
    R[2] * v[0] + R[5] * v[1] + R[8] * v[2],
  ];
  const column = (R, j) => [R[j], R[3 + j], R[6 + j]];

  function product(A, B) {
    const C = new Array(9);
    for (let i = 0; i < 9; i += 3)
      for (let j = 0; j < 3; j++) C[i + j] = A[i] * B[j] + A[i + 1] * B[3 + j] + A[i + 2] * B[6 + j];
    return C;
  }

  const compose = (a, b) => ({ R: product(a.R, b.R), p: add(a.p, rotate(a.R, b.p)) });

  /** The pose of b in a, both given in the world. */
  function relative(a, b) {
    const back = [a.R[0], a.R[3], a.R[6], a.R[1], a.R[4], a.R[7], a.R[2], a.R[5], a.R[8]];
    return { R: product(back, b.R), p: rotateBack(a.R, subtract(b.p, a.p)) };
  }

  function rotation([x, y, z, w]) {
    return [
      1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
      2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
      2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y),
    ];
  }

  /** The unit quaternion of a rotation, from its largest component. */
  function quaternion(R) {
    const [a, b, c] = [R[0], R[4], R[8]];
    const squares = [1 + a - b - c, 1 - a + b - c, 1 - a - b + c, 1 + a + b + c];
    const largest = squares.indexOf(Math.max(...squares));
    const [x, y, z] = [R[7] - R[5], R[2] - R[6], R[3] - R[1]];
    const [xy, xz, yz] = [R[1] + R[3], R[2] + R[6], R[5] + R[7]];
    const s = squares[largest];
    return unit([[s, xy, xz, x], [xy, s, yz, y], [xz, yz, s, z], [x, y, z, s]][largest]);
  }

  const unit = (v) => {
    const length = norm(v);
    return v.map((each) => each / length);
  };

  /** The quaternion of the rotation by the angle |w|, rad, about w. */
  function exponential(w) {
    const angle = norm(w);
    const s = angle < 1e-4 ? 0.5 - (angle * angle) / 48 : Math.sin(angle / 2) / angle;
    return [...scaled(s, w), Math.cos(angle / 2)];
  }

  function multiplied([ax, ay, az, aw], [bx, by, bz, bw]) {
    return [
      aw * bx + ax * bw + ay * bz - az * by,
      aw * by - ax * bz + ay * bw + az * bx,
      aw * bz + ax * by - ay * bx + az * bw,
      aw * bw - ax * bx - ay * by - az * bz,
    ];
  }

  /** The rotation vector of a rotation, rad. */
  function log3(R) {
    const [x, y, z, w] = quaternion(R);
    const s = Math.hypot(x, y, z);
    const sign = w < 0 ? -1 : 1;
    const factor = s < 1e-9 ? 2 : (2 * Math.atan2(s, sign * w)) / s;
    return scaled(sign * factor, [x, y, z]);
  }

  /** The logarithm of a pose: linear, angular. */
  function log6({ R, p }) {
    const w = log3(R);
    const angle = norm(w);
    const factor =
      angle < 1e-3 ? 1 / 12 + (angle * angle) / 720 : (1 - angle / (2 * Math.tan(angle / 2))) / (angle * angle);
    const turned = cross(w, p);
    return [...add(add(p, scaled(-0.5, turned)), scaled(factor, cross(w, turned))), ...w];
  }

  /** How far a frame moves, in its own axes, that has the constant twist (v, w) in its own axes for 1 s. */
  function displacement(v, w) {
    const angle = norm(w);
    const square = angle * angle;
    const a = angle < 1e-4 ? 0.5 - square / 24 : (1 - Math.cos(angle)) / square;
    const b = angle < 1e-3 ? 1 / 6 - square / 120 : (angle - Math.sin(angle)) / (square * angle);
    const turned = cross(w, v);
    return add(add(v, scaled(a, turned)), scaled(b, cross(w, turned)));
  }

  const MOST_SWEEPS = 60;

  function inner(a, b) {
    let sum = 0;
    for (let i = 0; i < a.length; i++) sum += a[i] * b[i];
    return sum;
  }

  /** Rotate two columns by the angle whose tangent is t. */
  function turn(x, y, t) {
    const cosine = 1 / Math.sqrt(1 + t * t);
    const sine = t * cosine;
    for (let k = 0; k < x.length; k++) {
      const u = x[k];
      x[k] = cosine * u - sine * y[k];
      y[k] = cosine * y[k] + sine * u;
    }
  }

  /**
   * A = U S Vᵀ by rotations of pairs of columns (one-sided Jacobi; Hestenes, 1958).
   *
   * @param columns The n columns of A, each of m numbers.
   * @returns The singular values, descending (the lesser of m and n), and for each of them `left`, the singular value
   *   times its column of U (m), and `right`, its column of V (n).
   */
  function svd(columns) {
    const n = columns.length;
    const m = n ? columns[0].length : 0;
    if (m < n) {
      const rows = Array.from({ length: m }, (_, i) => columns.map((each) => each[i]));
      const { values, left, right } = svd(rows);
      const times = (vector, factor) => vector.map((each) => factor * each);
      return {
        values,
        left: right.map((each, k) => times(each, values[k])),
        right: left.map((each, k) => times(each, values[k] ? 1 / values[k] : 0)),
      };
    }
    const left = columns.map((each) => Float64Array.from(each));
    const right = columns.map((_, j) => Float64Array.from({ length: n }, (_, i) => (i === j ? 1 : 0)));
    const squares = left.map((each) => inner(each, each));
    const nothing = 1e-32 * squares.reduce((sum, each) => sum + each, 0);
    for (let sweep = 0, turned = true; turned && sweep < MOST_SWEEPS; sweep++) {
      turned = false;
      for (let i = 0; i < n - 1; i++)
        for (let j = i + 1; j < n; j++) {
          const [a, b, c] = [squares[i], squares[j], inner(left[i], left[j])];
          if (Math.abs(c) <= 1e-15 * Math.sqrt(a * b) || Math.abs(c) <= nothing) continue;
          turned = true;
          const ratio = (b - a) / (2 * c);
          const t = (ratio < 0 ? -1 : 1) / (Math.abs(ratio) + Math.sqrt(1 + ratio * ratio));
          turn(left[i], left[j], t);
          turn(right[i], right[j], t);
          [squares[i], squares[j]] = [inner(left[i], left[i]), inner(left[j], left[j])];
        }
    }
    const values = squares.map(Math.sqrt);
    const order = values.map((_, index) => index).sort((i, j) => values[j] - values[i]);
    return {
      values: order.map((index) => values[index]),
      left: order.map((index) => left[index]),
      right: order.map((index) => right[index]),
    };
  }

  // As in eurdf.kinematics.rank.
  const FLOOR = 1e-9;
  const NOTHING = 1e-12;

  /** The number of singular values before the widest gap. */
  function rank(values) {
    const largest = values.length ? values[0] : 0;
    if (!(largest > NOTHING)) return 0;
    const ladder = [1, ...values.map((value) => Math.min(Math.max(value / largest, FLOOR), 1)), FLOOR];
    let found = 0;
    for (let i = 1; i < ladder.length - 1; i++)
      if (ladder[i] / ladder[i + 1] > ladder[found] / ladder[found + 1]) found = i;
    return found;
  }

  /** The least solution x (n) of A x = b (m), in the least squares sense; `of` decomposes A, with the rank `count`. */
  function leastSolution(of, count, b, n) {
    const x = new Float64Array(n);
    for (let k = 0; k < count; k++) {
      const part = inner(of.left[k], b) / (of.values[k] * of.values[k]);
      for (let i = 0; i < x.length; i++) x[i] += part * of.right[k][i];
    }
    return x;
  }

  const eurdf = (globalThis.eurdf = globalThis.eurdf || {});
  eurdf.algebra = {
    add, subtract, scaled, dot, cross, norm, unit, rotate, rotateBack, column, compose, relative, rotation, exponential,
    multiplied, log6, displacement, inner, svd, rank, leastSolution,
  };
})();
