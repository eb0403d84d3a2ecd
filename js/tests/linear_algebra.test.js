import assert from "node:assert/strict";
import { test } from "node:test";

import {
  Decomposition,
  inner,
  length,
  rank,
  singularValues,
  solvePositive,
  times,
} from "../src/closing/linear_algebra.js";

/** Numbers from -1 to 1, as good as random. */
const some = (seed) => {
  let k = seed;
  return () => (Math.sin((k += 1)) * 43758.5453) % 1;
};
const matrix = (m, n, next) => Array.from({ length: m }, () => Float64Array.from({ length: n }, next));
const near = (a, b, tolerance = 1e-10) =>
  a.forEach((each, i) => assert.ok(Math.abs(each - b[i]) <= tolerance, `${a} ≠ ${b}`));
const zeros = (n) => new Float64Array(n);

for (const [m, n, r] of [
  [3, 7, 3],
  [5, 5, 5],
  [7, 4, 4],
  [6, 8, 2],
  [9, 5, 3],
]) {
  const [left, right] = [matrix(m, r, some(m)), matrix(r, n, some(n))];
  const A = matrix(m, n, () => 0).map((_, i) =>
    Float64Array.from({ length: n }, (_, j) => right.reduce((sum, row, k) => sum + left[i][k] * row[j], 0)),
  );
  for (const exact of [false, true]) {
    const of = new Decomposition(A, n, { singularValues: exact });

    test(`a matrix (${m}, ${n}) of rank ${r} has ${n - r} orthonormal free vectors, ${exact}`, () => {
      assert.equal(of.rank, r);
      const free = of.nullSpace();
      assert.equal(free.length, n - r);
      for (const [i, vector] of free.entries()) {
        near(times(A, vector), zeros(m));
        free.forEach((other, j) => assert.ok(Math.abs(inner(vector, other) - (i === j)) < 1e-12));
      }
    });

    test(`of the solutions of (${m}, ${n}) of rank ${r} it finds the least, ${exact}`, () => {
      const b = times(A, Float64Array.from({ length: n }, some(3)));
      const x = of.solve(b);
      near(times(A, x), b);
      for (const vector of of.nullSpace()) assert.ok(Math.abs(inner(vector, x)) < 1e-12);
    });
  }

  test(`of contradicting equations (${m}, ${n}) of rank ${r} it finds the least squares`, () => {
    const b = Float64Array.from({ length: m }, some(9));
    const x = new Decomposition(A, n, { singularValues: true }).solve(b);
    const missed = times(A, x).map((row, i) => row - b[i]);
    const columns = Array.from({ length: n }, (_, j) => Float64Array.from(A, (row) => row[j]));
    near(times(columns, missed), zeros(n));
  });

  test(`the singular values of (${m}, ${n}) have the sums of squares and of fourth powers of A Aᵀ`, () => {
    const squares = singularValues(A, n).map((value) => value ** 2);
    const gram = A.map((one) => Float64Array.from(A, (other) => inner(one, other)));
    const trace = gram.reduce((sum, row, i) => sum + row[i], 0);
    assert.ok(Math.abs(squares.reduce((a, b) => a + b) - trace) < 1e-12 * trace);
    assert.ok(
      Math.abs(length(squares) ** 2 - gram.reduce((sum, row) => sum + inner(row, row), 0)) < 1e-12 * trace ** 2,
    );
  });
}

test("the rank ends at the widest gap", () => {
  assert.equal(rank([2, 1, 1e-3]), 3);
  assert.equal(rank([2, 1, 1e-6, 1e-7]), 2);
  assert.equal(rank([1e-13]), 0);
  assert.equal(rank([1e-5], 1), 0);
  assert.equal(rank([]), 0);
});

test("a positive definite system is solved", () => {
  const A = matrix(4, 4, some(1));
  const G = A.map((one) => Float64Array.from(A, (other) => inner(one, other)));
  const b = times(G, [1, -2, 3, 0.5]);
  near(
    solvePositive(
      G.map((row) => row.slice()),
      b,
    ),
    [1, -2, 3, 0.5],
    1e-9,
  );
});
