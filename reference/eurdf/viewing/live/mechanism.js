// A mechanism as plain data: poses of its bodies, residual of its constraints, and their derivative K.
//
// A configuration is an array with the coordinates of each joint, as files have them: angles in rad, lengths in m,
// quaternions x y z w. Joints that mimic another one have none.
"use strict";

(function () {
  const {
    add, subtract, scaled, dot, cross, norm, unit, rotate, rotateBack, column, compose, relative, rotation, exponential,
    multiplied, log6, displacement,
  } = globalThis.eurdf.algebra;

  const HERE = [0, 0, 0];
  const IDENTITY = { R: [1, 0, 0, 0, 1, 0, 0, 0, 1], p: HERE };
  const poseOf = ([x, y, z, ...q]) => ({ R: rotation(q), p: [x, y, z] });
  const about = (axis, angle) => rotation(exponential(scaled(angle, axis)));

  /** The velocity of a rotation about an axis through a point, and of a translation along an axis: that of the point at
   * the origin of the world, and the angular one. */
  const turning = (axis, point) => ({ linear: cross(point, axis), angular: axis });
  const sliding = (axis) => ({ linear: axis, angular: HERE });
  const both = (a, b) => ({ linear: add(a.linear, b.linear), angular: add(a.angular, b.angular) });

  // For each type of joint: the pose of its moving frame for its coordinates, and the velocity of its child in the world
  // for each of its velocities. `at` and `moved` are the poses in the world of its frame and of its moving frame.
  const TYPES = {
    fixed: { transform: () => IDENTITY, motions: () => [] },
    revolute: {
      transform: (joint, [angle]) => ({ R: about(joint.axes[0], angle), p: HERE }),
      motions: (joint, c, at) => [turning(rotate(at.R, joint.axes[0]), at.p)],
    },
    prismatic: {
      transform: (joint, [length]) => ({ R: IDENTITY.R, p: scaled(length, joint.axes[0]) }),
      motions: (joint, c, at) => [sliding(rotate(at.R, joint.axes[0]))],
    },
    helical: {
      transform: (joint, [angle]) => ({
        R: about(joint.axes[0], angle),
        p: scaled((joint.pitch / (2 * Math.PI)) * angle, joint.axes[0]),
      }),
      motions: (joint, c, at) => {
        const axis = rotate(at.R, joint.axes[0]);
        return [both(turning(axis, at.p), sliding(scaled(joint.pitch / (2 * Math.PI), axis)))];
      },
    },
    cylindrical: {
      transform: (joint, [length, angle]) => ({ R: about(joint.axes[0], angle), p: scaled(length, joint.axes[0]) }),
      motions: (joint, c, at) => {
        const axis = rotate(at.R, joint.axes[0]);
        return [sliding(axis), turning(axis, at.p)];
      },
    },
    universal: {
      transform: (joint, [first, second]) =>
        compose({ R: about(joint.axes[0], first), p: HERE }, { R: about(joint.axes[1], second), p: HERE }),
      motions: (joint, [first], at) => [
        turning(rotate(at.R, joint.axes[0]), at.p),
        turning(rotate(at.R, rotate(about(joint.axes[0], first), joint.axes[1])), at.p),
      ],
    },
    planar: {
      transform: (joint, [x, y, angle]) => ({ R: about([0, 0, 1], angle), p: [x, y, 0] }),
      motions: (joint, c, at, moved) => [
        sliding(column(moved.R, 0)),
        sliding(column(moved.R, 1)),
        turning(column(moved.R, 2), moved.p),
      ],
    },
    spherical: {
      transform: (joint, c) => ({ R: rotation(c), p: HERE }),
      motions: (joint, c, at, moved) => [0, 1, 2].map((j) => turning(column(moved.R, j), moved.p)),
    },
    floating: {
      transform: (joint, [x, y, z, ...q]) => ({ R: rotation(q), p: [x, y, z] }),
      motions: (joint, c, at, moved) => [
        ...[0, 1, 2].map((j) => sliding(column(moved.R, j))),
        ...[0, 1, 2].map((j) => turning(column(moved.R, j), moved.p)),
      ],
    },
  };
  TYPES.continuous = TYPES.revolute;

  // For each type of joint whose coordinates are not simply increased: what they are after a motion.
  const INTEGRATED = {
    planar: ([x, y, angle], [vx, vy, w]) => {
      const moved = rotate(about([0, 0, 1], angle), displacement([vx, vy, 0], [0, 0, w]));
      return [x + moved[0], y + moved[1], angle + w];
    },
    spherical: (c, v) => unit(multiplied(c, exponential(v))),
    floating: ([x, y, z, ...q], v) => {
      const [linear, angular] = [v.slice(0, 3), v.slice(3)];
      const p = add([x, y, z], rotate(rotation(q), displacement(linear, angular)));
      return [...p, ...unit(multiplied(q, exponential(angular)))];
    },
  };

  // For each kind of constraint of two frames: its residual where B is at `aMb`, and the derivative of that by a motion
  // of B against A, given by the velocity of the origin of B and the angular velocity, both in the axes of A. The
  // derivative is exact where the constraint holds.
  const KINDS = {
    "3d": { residual: (aMb) => aMb.p, rates: (linear) => linear },
    "6d": { residual: log6, rates: (linear, angular) => [...linear, ...angular] },
    hinge: {
      residual: (aMb, constraint) => [...aMb.p, ...along(constraint.across, tilt(aMb.R, constraint))],
      rates: (linear, angular, aMb, constraint) => [...linear, ...along(constraint.across, angular)],
    },
    distance: {
      residual: (aMb, constraint) => [norm(aMb.p) - constraint.length],
      rates: (linear, angular, aMb) => {
        const apart = norm(aMb.p);
        return [apart > 0 ? dot(aMb.p, linear) / apart : linear[0]];
      },
    },
  };

  const along = (across, s) => [dot(across[0], s), dot(across[1], s)];

  /** The shortest rotation vector that takes the axis of A to that of B; rad. */
  function tilt(R, { axes, across }) {
    const [a, b] = [axes[0], rotate(R, axes[1])];
    const normal = cross(a, b);
    const sine = norm(normal);
    const angle = Math.atan2(sine, dot(a, b));
    return sine > 0 ? scaled(angle / sine, normal) : scaled(angle, across[0]);
  }

  /** What the shortest rotation that takes z to the unit vector a makes of x and y; of -z, the half turn about x. */
  function planeAcross(a) {
    if (a[2] < -1 + 1e-9 && Math.hypot(a[0], a[1]) < 1e-9) return [[1, 0, 0], [0, -1, 0]];
    const turn = [-a[1], a[0], 0];
    // 1 + z, which rounding makes 0 near -z, of a unit vector.
    const above = a[2] > 0 ? 1 + a[2] : (a[0] ** 2 + a[1] ** 2) / (1 - a[2]);
    return [[1, 0, 0], [0, 1, 0]].map((each) => {
      const once = cross(turn, each);
      return add(add(each, once), scaled(1 / above, cross(turn, once)));
    });
  }

  class Mechanism {
    /** @param data What `eurdf.viewing.live_robot` writes. */
    constructor(data) {
      this.data = data;
      this.joints = data.joints.map((joint) => ({
        ...joint,
        placement: poseOf(joint.placement),
        offset: poseOf(joint.offset),
      }));
      this.above = new Array(data.bodies.length).fill(-1); // of each body, the index of the joint that moves it
      this.joints.forEach((joint, index) => (this.above[joint.child] = index));
      this._index(data);
      this.constraints = data.constraints.map((each) => {
        const constraint = { ...each };
        if (each.type === "coupling") {
          constraint.velocities = each.joints.map((index) => this.joints[index].velocities[0]);
        } else {
          constraint.a = { body: each.a.body, pose: poseOf(each.a.pose) };
          constraint.b = { body: each.b.body, pose: poseOf(each.b.pose) };
          constraint.chain = this._chain(constraint.a.body, constraint.b.body);
          constraint.velocities = constraint.chain.flatMap(({ joint }) => this.joints[joint].velocities);
          if (each.type === "hinge") constraint.across = planeAcross(each.axes[0]);
        }
        return constraint;
      });
    }

    /** For each velocity: those of its joint; the coordinate that it drives, if it drives one; the limits of that. */
    _index(data) {
      this.movers = data.units.map(() => []);
      this.coordinateOf = data.units.map(() => null);
      this.limits = data.units.map((_, velocity) => ({
        lower: data.lower[velocity] === null ? -Infinity : data.lower[velocity],
        upper: data.upper[velocity] === null ? Infinity : data.upper[velocity],
      }));
      this.joints.forEach((joint, index) => {
        if (joint.mimic) return;
        joint.velocities.forEach((velocity, i) => {
          this.movers[velocity] = joint.velocities;
          if (data.start[index].length === joint.velocities.length)
            this.coordinateOf[velocity] = { joint: index, index: i };
        });
      });
    }

    /** The coordinates of a joint, also of one that mimics another one. */
    coordinates(q, index) {
      const { mimic } = this.joints[index];
      return mimic ? [mimic.multiplier * q[mimic.joint][0] + mimic.offset] : q[index];
    }

    /** The poses of the bodies in the world, and the motion of each joint by its velocities. */
    place(q) {
      const bodies = new Array(this.above.length).fill(IDENTITY);
      bodies[-1] = IDENTITY; // the world
      const motions = this.joints.map((joint, index) => {
        const { transform, motions } = TYPES[joint.type];
        const c = this.coordinates(q, index);
        const at = joint.parent < 0 ? joint.placement : compose(bodies[joint.parent], joint.placement);
        const moved = compose(at, transform(joint, c));
        bodies[joint.child] = compose(moved, joint.offset);
        return motions(joint, c, at, moved);
      });
      return { bodies, motions };
    }

    /** The residual of a constraint, m and rad. */
    residual(constraint, q, placed) {
      if (constraint.type !== "coupling")
        return KINDS[constraint.type].residual(this._between(constraint, placed), constraint);
      const sum = constraint.joints.reduce((sum, joint, i) => sum + constraint.coefficients[i] * q[joint][0], 0);
      return [sum - constraint.offset];
    }

    /** The derivative of that residual by each velocity that moves it: a map from its index to the rows. */
    derivative(constraint, placed) {
      const columns = new Map();
      if (constraint.type === "coupling") {
        constraint.velocities.forEach((velocity, i) => columns.set(velocity, [constraint.coefficients[i]]));
        return columns;
      }
      const oMa = compose(placed.bodies[constraint.a.body], constraint.a.pose);
      const oMb = compose(placed.bodies[constraint.b.body], constraint.b.pose);
      const aMb = relative(oMa, oMb);
      for (const { joint, sign } of constraint.chain) {
        const { velocities, mimic } = this.joints[joint];
        placed.motions[joint].forEach((motion, i) => {
          const factor = sign * (mimic ? mimic.multiplier : 1);
          const linear = rotateBack(oMa.R, scaled(factor, add(motion.linear, cross(motion.angular, oMb.p))));
          const angular = rotateBack(oMa.R, scaled(factor, motion.angular));
          const rates = KINDS[constraint.type].rates(linear, angular, aMb, constraint);
          const before = columns.get(velocities[i]);
          columns.set(velocities[i], before ? before.map((rate, row) => rate + rates[row]) : rates);
        });
      }
      return columns;
    }

    /** The largest row of the residuals of the constraints, m or rad. */
    largestResidual(q) {
      const placed = this.place(q);
      return Math.max(0, ...this.constraints.flatMap((each) => this.residual(each, q, placed).map(Math.abs)));
    }

    /** The configuration after a motion v (nv). */
    integrate(q, v) {
      return this.joints.map((joint, index) => {
        if (joint.mimic || !joint.velocities.length) return q[index];
        const own = joint.velocities.map((velocity) => v[velocity]);
        if (own.every((each) => each === 0)) return q[index];
        const integrated = INTEGRATED[joint.type];
        return integrated ? integrated(q[index], own) : q[index].map((value, i) => value + own[i]);
      });
    }

    /** The points that show a closure, in the world: origin of the body of A, A, B, origin of the body of B. */
    ends(constraint, placed) {
      const [a, b] = [placed.bodies[constraint.a.body], placed.bodies[constraint.b.body]];
      const start = compose(a, constraint.a.pose).p;
      return [constraint.a.body < 0 ? start : a.p, start, compose(b, constraint.b.pose).p, b.p];
    }

    _between({ a, b }, placed) {
      return relative(compose(placed.bodies[a.body], a.pose), compose(placed.bodies[b.body], b.pose));
    }

    /** The joints between two bodies: with sign 1 those that move the second one, with -1 those that move the first. */
    _chain(first, second) {
      const path = (body) => {
        const joints = [];
        for (let joint = this.above[body]; joint >= 0; joint = this._parent(joint)) joints.push(joint);
        return joints;
      };
      const [ofFirst, ofSecond] = [path(first), path(second)];
      return [
        ...ofFirst.filter((joint) => !ofSecond.includes(joint)).map((joint) => ({ joint, sign: -1 })),
        ...ofSecond.filter((joint) => !ofFirst.includes(joint)).map((joint) => ({ joint, sign: 1 })),
      ];
    }

    _parent(joint) {
      const body = this.joints[joint].parent;
      return body < 0 ? -1 : this.above[body];
    }
  }

  globalThis.eurdf.Mechanism = Mechanism;
})();
