// log6 of a pose and its derivative: the section on residuals in the chapter on closures.

import { add, apply, cross, dot, norm, scale, subtract, toQuaternion } from "./spatial.js";

/** Below this angle, series replace the closed forms, which lose digits there. */
const SMALL = 1;

/** The rotation vector of R, at most π long. */
export function log3(R) {
  const [x, y, z, w] = toQuaternion(R);
  const length = norm([x, y, z]);
  return scale(length === 0 ? 2 : (2 * Math.atan2(length, w)) / length, [x, y, z]);
}

/** {v, w} with p = V(w) v. */
export function log6({ R, p }) {
  const w = log3(R);
  return { v: solveV(w, p), w };
}

/** The derivative of log6 at {v, w}: `velocity` is that of the pose, a twist {v, w} expressed in its moving frame. */
export function log6Derivative({ R }, { v, w }, velocity) {
  const φ = norm(w);
  const wTwice = (a) => cross(w, cross(w, a));
  // The inverse of the right Jacobian of SO(3).
  const turning = velocity.w;
  const wRate = add(add(turning, scale(0.5, cross(w, turning))), scale(inverseFactor(φ), wTwice(turning)));
  // p = V(w) v, so V(w) v' = p' - V' v.
  const rate = dot(w, wRate);
  const { α, β, αRate, βRate } = factors(φ);
  const alongα = add(scale(αRate * rate, cross(w, v)), scale(α, cross(wRate, v)));
  const twice = add(cross(wRate, cross(w, v)), cross(w, cross(wRate, v)));
  const alongβ = add(scale(βRate * rate, wTwice(v)), scale(β, twice));
  const vRate = solveV(w, subtract(apply(R, velocity.v), add(alongα, alongβ)));
  return [...vRate, ...wRate];
}

/** V(w)⁻¹ p. */
function solveV(w, p) {
  const first = cross(w, p);
  return add(subtract(p, scale(0.5, first)), scale(inverseFactor(norm(w)), cross(w, first)));
}

/** (1 - φ/2 cot(φ/2)) / φ². */
function inverseFactor(φ) {
  if (φ < 1e-2) return 1 / 12 + φ ** 2 / 720 + φ ** 4 / 30240;
  return (1 - φ / 2 / Math.tan(φ / 2)) / φ ** 2;
}

/** The factors α and β of V, and their derivatives by φ, divided by φ. */
function factors(φ) {
  if (φ > SMALL) {
    const s = Math.sin(φ);
    const versine = 2 * Math.sin(φ / 2) ** 2;
    const αRate = (φ * s - 2 * versine) / φ ** 4;
    const βRate = (φ * versine - 3 * (φ - s)) / φ ** 5;
    return { α: versine / φ ** 2, β: (φ - s) / φ ** 3, αRate, βRate };
  }
  // Sums over k of (-1)^k φ^2k / (2k + 2)! and / (2k + 3)!, and of their derivatives.
  const sums = { α: 0, β: 0, αRate: 0, βRate: 0 };
  let term = 1 / 2;
  let slope = 0; // the same with φ^(2k - 2)
  for (let k = 0; k < 12; k += 1) {
    sums.α += term;
    sums.β += term / (2 * k + 3);
    sums.αRate += 2 * k * slope;
    sums.βRate += (2 * k * slope) / (2 * k + 3);
    const next = -1 / ((2 * k + 3) * (2 * k + 4));
    slope = term * next;
    term *= next * φ * φ;
  }
  return sums;
}
