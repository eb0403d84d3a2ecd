// Residuals of closures and couplings, and their rows of K: EU-CLO-008 to -010, -014, -015, EU-CPL-005.

import { log6, log6Derivative } from "./log6.js";
import {
  IDENTITY,
  add,
  apply,
  applyTransposed,
  compose,
  cross,
  dot,
  inverse,
  norm,
  rotation,
  scale,
  subtract,
  unit,
} from "./spatial.js";

const Z = [0, 0, 1];
const OPPOSITE = 1e-9;

/** The residual of every closure and coupling, by name. */
export function residuals(kinematics) {
  const { closures, couplings } = kinematics.robot;
  const found = Object.create(null);
  for (const closure of closures) found[closure.name] = closureAt(kinematics, closure).residual;
  for (const { name, joints, offset } of couplings) {
    const terms = [...joints].map(([joint, c]) => c * kinematics.coordinates({ name: joint, type: "revolute" })[0]);
    found[name] = [terms.reduce((sum, term) => sum + term, 0) - offset];
  }
  return found;
}

/** {columns, rows} of the constraint Jacobian. */
export function jacobian(kinematics) {
  const { columns, first, robot } = kinematics;
  const rows = Object.create(null);
  for (const closure of robot.closures) rows[closure.name] = closureRows(kinematics, closure);
  for (const { name, joints } of robot.couplings) {
    const row = columns.map(() => 0);
    for (const [joint, c] of joints) row[first.get(joint)] = c;
    rows[name] = [row];
  }
  return { columns, rows };
}

/** `residual`, and `derivative` along a motion of B relative to A: {p, w}, the rates of p and of R, expressed in A. */
function closureAt(kinematics, closure) {
  const [a, b] = closure.frames.map((frame) => kinematics.pose(frame));
  const relative = compose(inverse(a), b);
  return { a, b, relative, ...TYPES[closure.type](relative, closure) };
}

const TYPES = {
  "3d": ({ p }) => ({ residual: p, derivative: (rate) => rate.p }),

  "6d": (relative) => {
    const residual = log6(relative);
    const inB = (rate) => ({ v: applyTransposed(relative.R, rate.p), w: applyTransposed(relative.R, rate.w) });
    return {
      residual: [...residual.v, ...residual.w],
      derivative: (rate) => log6Derivative(relative, residual, inB(rate)),
    };
  },

  hinge: ({ R, p }, { axes: [a, b] }) => {
    const β = apply(R, b);
    const c = cross(a, β);
    const θ = Math.atan2(norm(c), dot(a, β));
    const [first, second] = measures(a);
    const along = (s) => [dot(first, s), dot(second, s)];
    // s = f c; if the axes are opposite, along a direction of its choice.
    const f = norm(c) === 0 ? 1 : θ / norm(c);
    const s = norm(c) === 0 ? scale(θ, first) : scale(f, c);
    const derivative = (rate) => {
      const βRate = cross(rate.w, β);
      const fRate = -dot(a, βRate) * angleFactor(θ);
      return [...rate.p, ...along(add(scale(fRate, c), scale(f, cross(a, βRate))))];
    };
    return { residual: [...p, ...along(s)], derivative };
  },

  distance: ({ p }, { length }) => {
    const size = norm(p);
    const direction = size === 0 ? [1, 0, 0] : scale(1 / size, p);
    return { residual: [size - length], derivative: (rate) => [dot(direction, rate.p)] };
  },
};

/** The two unit vectors along which a hinge on the axis `a` measures. */
function measures(a) {
  if (norm(add(a, Z)) <= OPPOSITE)
    return [
      [1, 0, 0],
      [0, -1, 0],
    ];
  const c = cross(Z, a);
  const angle = Math.atan2(norm(c), a[2]);
  const R = norm(c) === 0 ? IDENTITY : rotation(unit(c), angle);
  return [0, 1].map((j) => [R[0][j], R[1][j], R[2][j]]);
}

/** (sin θ - θ cos θ) / sin³ θ. */
function angleFactor(θ) {
  const s = Math.sin(θ);
  if (θ < 1e-2) return (1 / 3 - θ ** 2 / 30 + θ ** 4 / 840) * (θ === 0 ? 1 : (θ / s) ** 3);
  return s === 0 ? 0 : (s - θ * Math.cos(θ)) / s ** 3;
}

function closureRows(kinematics, closure) {
  const { a, b, residual, derivative } = closureAt(kinematics, closure);
  const [ofA, ofB] = closure.frames.map(({ link }) => kinematics.twists(link));
  const rows = residual.map(() => kinematics.columns.map(() => 0));
  const none = { v: [0, 0, 0], w: [0, 0, 0] };
  for (const column of new Set([...ofA.keys(), ...ofB.keys()])) {
    const one = ofA.get(column) ?? none;
    const other = ofB.get(column) ?? none;
    // B relative to A, as seen from A: the velocity of B's origin in the motion that is left.
    const turning = subtract(other.w, one.w);
    const moving = add(subtract(other.v, one.v), cross(turning, b.p));
    derivative({ p: applyTransposed(a.R, moving), w: applyTransposed(a.R, turning) }).forEach((each, i) => {
      rows[i][column] = each;
    });
  }
  return rows;
}
