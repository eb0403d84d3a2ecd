// The dimensions of a mechanism: rank and mobility of its loops, and what its actuators control.

import { assembled, close, openAt, startOf } from "./assemble.js";
import { Decomposition, inner, largest, length, rank, singularValues } from "./linear_algebra.js";
import { problemOf } from "./problem.js";

const MOVES = [0.05, 0.1, 0.2, 0.2]; // steps to further closed configurations
const NEGLIGIBLE = 1e-4; // entries below this, relative to the largest, are rounding of numbers in files

const MOST_WORK = 1e7; // of n² max(m, n), summed over the K (m, n) of the groups: some seconds

/**
 * Closes the loops near q, and finds ranks at a generic closed configuration: the largest ones there and at some others
 * around it.
 *
 * @param q By default `assembled`, or the neutral one.
 * @returns {nv, nc, rank, mobility, uncontrolled, dependentActuators}: velocities, constraint rows, rank of K, degrees
 *   of freedom, those left with every actuator held, and sets of names of actuators that cannot move independently. If
 *   the loops do not close, or have too many rows, what depends on ranks is null, or empty.
 */
export function analyze(mechanism, q = startOf(mechanism)) {
  const problem = problemOf(mechanism);
  const x = assembled(problem, problem.tree.read(q));
  return openAt(problem, x).length ? unranked(problem) : analysisOf(problem, x);
}

const sizes = ({ tree, constraints }) => ({ nv: tree.nv, nc: constraints.reduce((sum, { rows }) => sum + rows, 0) });

function unranked(problem) {
  return { ...sizes(problem), rank: null, mobility: null, uncontrolled: null, dependentActuators: [] };
}

/** As `analyze`, at a closed configuration; the last one is kept. */
export function analysisOf(problem, x) {
  const { analyzed } = problem;
  if (analyzed && x.every((each, i) => each === analyzed.x[i])) return analyzed.analysis;
  const analysis = computed(problem, x);
  problem.analyzed = { x: Float64Array.from(x), analysis };
  return analysis;
}

function computed(problem, x) {
  const { groups } = problem;
  const work = groups.reduce((sum, { n, scale }) => sum + n * n * Math.max(n, scale.length), 0);
  if (work > MOST_WORK) return unranked(problem);
  const found = genericJacobians(problem, x).map((at, index) => groupAnalysis(problem, groups[index], at));
  const inLoops = new Set(groups.flatMap(({ columns }) => columns));
  const outside = problem.tree.columns.filter(
    (_, velocity) => !inLoops.has(velocity) && !problem.actuated.has(velocity),
  );
  const rank = found.reduce((sum, each) => sum + each.rank, 0);
  return {
    ...sizes(problem),
    rank,
    mobility: problem.tree.nv - rank,
    uncontrolled: found.reduce((sum, each) => sum + each.uncontrolled, outside.length),
    dependentActuators: found.flatMap((each) => each.dependent),
  };
}

/** Of each group K at x, and at some closed configurations around it. */
function genericJacobians(problem, x) {
  const groups = problem.groups;
  const norm = (group, at) => length(group.residual(at));
  const found = groups.map((group) => [group.jacobian(x)]);
  const open = groups.map((group) => norm(group, x));
  const bases = found.map(([K], i) => new Decomposition(K, groups[i].n).nullSpace());
  MOVES.forEach((size, number) => {
    let near = x;
    groups.forEach((group, i) => (near = group.moved(near, freeStep(bases[i], group.n, number, size))));
    near = close(problem, near);
    groups.forEach((group, i) => {
      if (norm(group, near) <= Math.max(10 * open[i], 1e-8)) found[i].push(group.jacobian(near));
    });
  });
  return found;
}

/** A generic step in the span of `basis` whose largest entry is `size`; zero if the span is empty. */
function freeStep(basis, n, number, size) {
  const some = Float64Array.from({ length: n }, (_, i) => Math.sin((1 + number * n + i) ** 2));
  const free = new Float64Array(n);
  for (const vector of basis) {
    const along = inner(vector, some);
    vector.forEach((each, i) => (free[i] += along * each));
  }
  const most = largest(free);
  return free.map((each) => (most > 1e-6 ? (each * size) / most : 0));
}

function groupAnalysis(problem, { columns, n }, at) {
  const actuated = columns.map((column) => problem.actuated.has(column));
  const count = actuated.filter(Boolean).length;
  const ranks = at.map((K) => {
    const values = singularValues(K, n);
    const rest = singularValues(
      K.map((row) => row.map((rate, i) => (actuated[i] ? 0 : rate))),
      n,
    );
    return { K, rank: rank(values), held: count + rank(rest, values[0]) };
  });
  const most = Math.max(...ranks.map((each) => each.rank));
  const held = Math.max(...ranks.map((each) => each.held));
  const { K } = ranks.find((each) => each.held === held);
  const names = columns.map((column) => problem.joints[column].name);
  return {
    rank: most,
    uncontrolled: n - held,
    dependent: dependentActuators(K, n, most, held - most, actuated, names),
  };
}

/**
 * Torques z with zᵀ Sᵀ v = 0 for all v with K v = 0 move nothing. The actuators in one vector of a sparse basis of them
 * depend on one another, and so do those of two vectors that have an actuator in common.
 */
function dependentActuators(K, n, found, controlled, actuated, members) {
  const names = members.filter((_, i) => actuated[i]);
  if (names.length === controlled) return [];
  const free = nullSpace(K, n, found).map((vector) => vector.filter((_, i) => actuated[i]));
  let sets = [];
  for (const row of sparseBasis(nullSpace(free, names.length, controlled))) {
    const together = new Set(names.filter((_, i) => row[i]));
    const apart = sets.filter((other) => ![...other].some((name) => together.has(name)));
    for (const other of sets) if (!apart.includes(other)) other.forEach((name) => together.add(name));
    sets = [...apart, together];
  }
  const order = [...new Set(names)];
  const sorted = sets.map((set) => [...set].sort((a, b) => order.indexOf(a) - order.indexOf(b)));
  return sorted.sort((a, b) => order.indexOf(a[0]) - order.indexOf(b[0]));
}

/** The null space of A (m, n) whose rank is known. */
function nullSpace(A, n, count) {
  const of = new Decomposition(A, n, { singularValues: true });
  of.rank = count;
  return of.nullSpace();
}

/** A basis of the same space with few nonzero entries: the reduced echelon form with complete pivoting. */
function sparseBasis(vectors) {
  const basis = vectors.map((vector) => Float64Array.from(vector));
  basis.forEach((_, row) => {
    let [pivot, column, most] = [row, 0, -1];
    for (let i = row; i < basis.length; i += 1) {
      basis[i].forEach((each, j) => {
        if (Math.abs(each) > most) [pivot, column, most] = [i, j, Math.abs(each)];
      });
    }
    [basis[row], basis[pivot]] = [basis[pivot], basis[row]];
    basis[row] = basis[row].map((each) => each / basis[row][column]);
    basis.forEach((other, i) => {
      const factor = other[column];
      if (i !== row) basis[row].forEach((each, j) => (other[j] -= factor * each));
    });
  });
  return basis.map((vector) => {
    const least = NEGLIGIBLE * largest(vector);
    return vector.map((each) => (Math.abs(each) < least ? 0 : each));
  });
}
