// Ranks and least solutions of dense matrices. A matrix is a list of rows.

/** The inner product of the first numbers of a with b. */
export function inner(a, b, n = a.length) {
  let sum = 0;
  for (let i = 0; i < n; i += 1) sum += a[i] * b[i];
  return sum;
}

/** The largest magnitude; NaN if one is. */
export const largest = (a) => a.reduce((most, each) => Math.max(most, Math.abs(each)), 0);

/** The Euclidean norm. */
export const length = (a) => Math.sqrt(inner(a, a));

/** A x. */
export const times = (A, x) => Float64Array.from(A, (row) => inner(row, x));

const FLOOR = 1e-9;
const NOTHING = 1e-12;

/**
 * The number of singular values before the widest gap.
 *
 * A fixed threshold would have to separate the rounding of numbers in files from the small singular values of short
 * levers. Instead the values relative to `reference` are placed between 1 and FLOOR.
 */
export function rank(values, reference = values[0] ?? 0) {
  if (!(reference > NOTHING)) return 0;
  const ladder = [1, ...values.map((value) => Math.min(Math.max(value / reference, FLOOR), 1)), FLOOR];
  let found = 0;
  for (let i = 1; i < ladder.length - 1; i += 1) {
    if (ladder[i] / ladder[i + 1] > ladder[found] / ladder[found + 1]) found = i;
  }
  return found;
}

// If each diagonal entry of the triangle is above the first or below the second fraction of the largest one, `rank`
// would count those above.
const CERTAIN = 1e-3;
const ZERO = 1e-12;

/**
 * A decomposed matrix A (m, n): its transpose is Q R, by Householder's reflections, the longest remaining row first;
 * where that leaves the rank in doubt, or the singular values are wanted, R = V S Uᵀ.
 */
export class Decomposition {
  constructor(rows, n, { singularValues = false } = {}) {
    this.n = n;
    this.reflect(rows);
    const first = Math.abs(this.diagonal[0] ?? 0);
    this.rank = this.diagonal.findIndex((each) => Math.abs(each) < CERTAIN * first);
    if (this.rank < 0) this.rank = this.diagonal.length;
    const sure = first > NOTHING && this.diagonal.slice(this.rank).every((each) => Math.abs(each) < ZERO * first);
    if (singularValues || !sure) this.diagonalize();
  }

  /** Row i of A is row `order[i]` of those given; the reflections are where R leaves room. */
  reflect(rows) {
    const { n } = this;
    const m = rows.length;
    const R = rows.map((row) => Float64Array.from(row));
    const order = rows.map((_, i) => i);
    const squares = R.map((row) => inner(row, row));
    const count = Math.min(m, n);
    Object.assign(this, { R, order, diagonal: new Float64Array(count), factors: new Float64Array(count) });
    for (let j = 0; j < count; j += 1) {
      let pivot = j;
      for (let i = j + 1; i < m; i += 1) if (squares[i] > squares[pivot]) pivot = i;
      for (const list of [R, order, squares]) [list[j], list[pivot]] = [list[pivot], list[j]];
      const v = R[j];
      const size = Math.sqrt(squares[j]);
      if (size === 0) break;
      this.diagonal[j] = v[j] > 0 ? -size : size;
      this.factors[j] = 1 / (size * (size + Math.abs(v[j])));
      v[j] -= this.diagonal[j];
      for (let i = j + 1; i < m; i += 1) squares[i] = this.mirror(R[i], j);
    }
  }

  /** Reflects a vector by reflection j; the squared norm of what is beyond its entry j. */
  mirror(x, j) {
    const { n, factors } = this;
    const v = this.R[j];
    let along = 0;
    for (let k = j; k < n; k += 1) along += v[k] * x[k];
    along *= factors[j];
    x[j] -= along * v[j];
    let square = 0;
    for (let k = j + 1; k < n; k += 1) {
      x[k] -= along * v[k];
      square += x[k] * x[k];
    }
    return square;
  }

  /** R = V S Uᵀ by rotations of pairs of its rows (one-sided Jacobi; Hestenes, 1958). */
  diagonalize() {
    const { R, diagonal } = this;
    const count = diagonal.length;
    const rows = Array.from(diagonal, (own, i) =>
      Float64Array.from(R, (each, j) => (j < i ? 0 : j > i ? each[i] : own)),
    );
    const turns = Array.from(diagonal, (_, i) => Float64Array.from(diagonal, (_, j) => (i === j ? 1 : 0)));
    const squares = rows.map((row) => inner(row, row));
    const nothing = 1e-32 * squares.reduce((sum, each) => sum + each, 0);
    for (let sweep = 0, turned = true; turned && sweep < 60; sweep += 1) {
      turned = false;
      for (let i = 0; i < count - 1; i += 1) {
        for (let j = i + 1; j < count; j += 1) {
          const c = inner(rows[i], rows[j]);
          if (Math.abs(c) <= 1e-15 * Math.sqrt(squares[i] * squares[j]) || Math.abs(c) <= nothing) continue;
          turned = true;
          const ratio = (squares[j] - squares[i]) / (2 * c);
          const tangent = (ratio < 0 ? -1 : 1) / (Math.abs(ratio) + Math.sqrt(1 + ratio * ratio));
          turn(rows[i], rows[j], tangent);
          turn(turns[i], turns[j], tangent);
          [squares[i], squares[j]] = [inner(rows[i], rows[i]), inner(rows[j], rows[j])];
        }
      }
    }
    const sorted = squares.map((_, i) => i).sort((i, j) => squares[j] - squares[i]);
    this.values = sorted.map((i) => Math.sqrt(squares[i]));
    this.left = sorted.map((i) => rows[i]); // times the singular values
    this.right = sorted.map((i) => turns[i]);
    this.rank = rank(this.values);
  }

  /**
   * The x (n) of least norm with A x = b (m). If no x meets all rows: with the singular values, the one with the least
   * squares; without them, one that meets as many rows as the rank is.
   */
  solve(b) {
    const x = new Float64Array(this.n);
    if (this.values) {
      for (let k = 0; k < this.rank; k += 1) {
        let along = 0;
        for (let i = 0; i < this.order.length; i += 1) along += this.left[k][i] * b[this.order[i]];
        along /= this.values[k] ** 2;
        for (let i = 0; i < this.right[k].length; i += 1) x[i] += along * this.right[k][i];
      }
    } else {
      for (let i = 0; i < this.rank; i += 1) x[i] = (b[this.order[i]] - inner(this.R[i], x, i)) / this.diagonal[i];
    }
    return this.turned(x);
  }

  /** Orthonormal vectors of the null space of A. */
  nullSpace() {
    return Array.from({ length: this.n - this.rank }, (_, k) => {
      const x = new Float64Array(this.n);
      if (this.values && this.rank + k < this.right.length) x.set(this.right[this.rank + k]);
      else x[this.rank + k] = 1;
      return this.turned(x);
    });
  }

  /** Q x, in place of x. */
  turned(x) {
    for (let j = this.diagonal.length - 1; j >= 0; j -= 1) if (this.factors[j]) this.mirror(x, j);
    return x;
  }
}

/** Rotates two vectors by the angle with this tangent. */
function turn(x, y, tangent) {
  const cosine = 1 / Math.sqrt(1 + tangent * tangent);
  const sine = tangent * cosine;
  for (let k = 0; k < x.length; k += 1) {
    const u = x[k];
    x[k] = cosine * u - sine * y[k];
    y[k] = cosine * y[k] + sine * u;
  }
}

/** The singular values of A (m, n), the largest first. */
export const singularValues = (rows, n) => new Decomposition(rows, n, { singularValues: true }).values;

/** The x with G x = b, of a positive definite G, of which the lower rows are given and overwritten (Cholesky). */
export function solvePositive(G, b) {
  const x = Float64Array.from(b);
  const least = 1e-16 * G.reduce((most, row, i) => Math.max(most, row[i]), 0);
  for (let i = 0; i < G.length; i += 1) {
    const row = G[i];
    for (let j = 0; j < i; j += 1) row[j] = (row[j] - inner(row, G[j], j)) / G[j][j];
    row[i] = Math.sqrt(Math.max(row[i] - inner(row, row, i), least));
    x[i] = (x[i] - inner(row, x, i)) / row[i];
  }
  for (let i = x.length - 1; i >= 0; i -= 1) {
    x[i] /= G[i][i];
    for (let k = 0; k < i; k += 1) x[k] -= G[i][k] * x[i];
  }
  return x;
}
