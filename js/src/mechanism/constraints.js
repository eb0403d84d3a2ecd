// Residuals of closures and couplings, and their rows of K: EU-CLO-008 to -010, -014, -015, EU-CPL-005.

import { SIZE, read } from "./poses.js";
import { log6, log6Derivative } from "./log6.js";
import {
  IDENTITY,
  add,
  apply,
  applyTransposed,
  compose,
  cross,
  dot,
  fromOrigin,
  inverse,
  norm,
  rotation,
  scale,
  subtract,
  unit,
} from "./spatial.js";

const Z = [0, 0, 1];
const OPPOSITE = 1e-9;

/** The closures and couplings of a robot, in this order. */
export function constraintsOf(robot, tree) {
  return [
    ...robot.closures.map((closure) => new Closure(closure, tree)),
    ...robot.couplings.map((coupling) => new Coupling(coupling, tree)),
  ];
}

/** What holds two frames. Units of rows: m and rad. */
class Closure {
  constructor(closure, tree) {
    const { name, type, frames } = closure;
    Object.assign(this, { name, type, closure, units: UNITS[type], rows: UNITS[type].length });
    this.bodies = frames.map(({ link }) => tree.bodies.get(link));
    this.frames = frames.map(({ xyz, rpy }) => fromOrigin(xyz, rpy));
    const base = tree.common(this.bodies);
    this.joints = this.bodies.flatMap((body) => tree.jointsBetween(base, [body])); // that move B relative to A
    this.motions = this.bodies.flatMap((end, side) => {
      return tree.jointsBetween(base, [end]).flatMap(({ motion, column, velocities }) => {
        return Array.from({ length: velocities }, (_, i) => ({
          motion: motion + i,
          column: column + i,
          sign: side ? 1 : -1,
        }));
      });
    });
    this.columns = [...new Set(this.motions.map(({ column }) => column))];
  }

  /** The poses of A and B, and of B in A. */
  at({ poses }) {
    const [a, b] = this.bodies.map((body, i) => compose(read(poses, SIZE * body), this.frames[i]));
    return { a, b, relative: compose(inverse(a), b) };
  }

  residual(x, placed) {
    return TYPES[this.type](this.at(placed).relative, this.closure).residual;
  }

  /** How far it is open: {position, m; angle, rad}. */
  opening(x, placed) {
    const r = this.residual(x, placed);
    if (this.type === "distance") return { position: Math.abs(r[0]), angle: 0 };
    return { position: norm(this.at(placed).relative.p), angle: norm(r.slice(3)) };
  }

  /** Calls `add` with a column, a row, and the rate of the row along a motion that belongs to the column. */
  differentiate(placed, add) {
    const { twists, origin } = placed;
    const { a, b, relative } = this.at(placed);
    const { derivative } = TYPES[this.type](relative, this.closure);
    const arm = subtract(b.p, origin);
    // The rates of the rows along six motions of B relative to A, in the world: those of its origin, and rotations.
    const rates = UNITS_OF_MOTION.map(([v, w]) =>
      derivative({ p: applyTransposed(a.R, v), w: applyTransposed(a.R, w) }),
    );
    for (const { motion, column, sign } of this.motions) {
      const t = 6 * motion;
      const [wx, wy, wz] = [twists[t + 3], twists[t + 4], twists[t + 5]];
      const vx = twists[t] + wy * arm[2] - wz * arm[1];
      const vy = twists[t + 1] + wz * arm[0] - wx * arm[2];
      const vz = twists[t + 2] + wx * arm[1] - wy * arm[0];
      for (let row = 0; row < this.rows; row += 1) {
        const moved = vx * rates[0][row] + vy * rates[1][row] + vz * rates[2][row];
        const turned = wx * rates[3][row] + wy * rates[4][row] + wz * rates[5][row];
        add(column, row, sign * (moved + turned));
      }
    }
  }
}

/** A linear relation of coordinates: EU-CPL-005. */
class Coupling {
  constructor({ name, joints, offset }, tree) {
    Object.assign(this, { name, type: "coupling", offset, rows: 1, bodies: [] });
    this.terms = [...joints].map(([joint, coefficient]) => {
      const { x, column, type } = tree.byName.get(joint);
      return { x, column, type, coefficient };
    });
    this.columns = this.terms.map(({ column }) => column);
    const largest = this.terms.reduce((a, b) => (Math.abs(b.coefficient) > Math.abs(a.coefficient) ? b : a));
    this.size = Math.abs(largest.coefficient);
    this.units = [largest.type === "prismatic" ? "m" : "rad"];
  }

  residual(x) {
    return [this.terms.reduce((sum, { x: i, coefficient }) => sum + coefficient * x[i], 0) - this.offset];
  }

  /** What the coordinate with the largest coefficient would have to move. */
  opening(x) {
    const amount = Math.abs(this.residual(x)[0]) / this.size;
    return this.units[0] === "m" ? { position: amount, angle: 0 } : { position: 0, angle: amount };
  }

  differentiate(placed, add) {
    for (const { column, coefficient } of this.terms) add(column, 0, coefficient);
  }
}

const NONE = [0, 0, 0];
const UNITS_OF_MOTION = [...IDENTITY.map((axis) => [axis, NONE]), ...IDENTITY.map((axis) => [NONE, axis])];

const UNITS = {
  "3d": ["m", "m", "m"],
  "6d": ["m", "m", "m", "rad", "rad", "rad"],
  hinge: ["m", "m", "m", "rad", "rad"],
  distance: ["m"],
};

// Of each type the `residual`, and the `derivative` along a motion of B relative to A: {p, w}, the rates of p and of R,
// expressed in A.
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
