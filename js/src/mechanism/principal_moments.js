// Principal moments of a body: the eigenvalues of its inertia, by Jacobi's rotations.

const SWEEPS = 30; // it converges in fewer than ten
const PAIRS = [
  [0, 1],
  [0, 2],
  [1, 2],
];

/** The eigenvalues of a symmetric matrix of three rows, from the least to the largest. */
export function principalMoments(matrix) {
  const a = matrix.map((row) => [...row]);
  for (let sweep = 0; sweep < SWEEPS; sweep += 1) PAIRS.forEach(([p, q]) => rotate(a, p, q));
  return [a[0][0], a[1][1], a[2][2]].sort((x, y) => x - y);
}

/** Turns in the plane of p and q such that their product is zero. */
function rotate(a, p, q) {
  if (a[p][q] === 0) return;
  const r = 3 - p - q;
  const half = (a[q][q] - a[p][p]) / (2 * a[p][q]);
  const t = Math.sign(half || 1) / (Math.abs(half) + Math.hypot(half, 1));
  const c = 1 / Math.hypot(t, 1);
  const s = t * c;
  const [pr, qr] = [a[p][r], a[q][r]];
  a[p][p] -= t * a[p][q];
  a[q][q] += t * a[p][q];
  a[p][q] = a[q][p] = 0;
  a[p][r] = a[r][p] = c * pr - s * qr;
  a[q][r] = a[r][q] = s * pr + c * qr;
}
