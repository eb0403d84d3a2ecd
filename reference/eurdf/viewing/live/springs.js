// Where springs bring a robot while its actuators are held, within the position limits of its passive joints.
"use strict";

(function () {
  const { svd, rank, leastSolution } = globalThis.eurdf.algebra;

  const BEYOND = 1e-9; // tolerance of a limit, rad or m
  const MOST_STEPS = 60;
  const LONGEST = 0.3; // bound of the motion of a joint in one step (rad, or characteristic lengths)
  const LAST = 1e-10; // a step below this (rad, or characteristic lengths) is the last one
  const CLOSED = 1e-12; // bound of each row of the residual at the end, m or rad

  /**
   * The closed configuration near q at which the springs store the least energy.
   *
   * It does what eurdf.viewing.spring_rest does: each step minimizes ½ Σ k (c + ċ)² under K v = -r, with the
   * coordinates that would leave their limits at them.
   *
   * @param loops All constraints, with the velocities that are not held.
   * @param springs {velocity, stiffness, ratio, shift} of each.
   * @param q Where to start.
   * @returns {q, pressed}: the configuration, null if none was found; the velocities whose coordinates are at limits.
   */
  function atRest(loops, springs, q) {
    const acting = springs.filter(({ velocity }) => loops.velocities.includes(velocity));
    const limits = limitsFrom(loops, q);
    let pressed = new Map();
    for (let count = 0; count < MOST_STEPS; count++) {
      let step;
      [step, pressed] = stepWithin(loops, acting, q, limits);
      const size = Math.max(0, ...step.map(Math.abs));
      q = loops.moved(q, size > LONGEST ? step.map((each) => (each * LONGEST) / size) : step);
      if (size <= LAST) break;
    }
    const reached = [...pressed].every(([velocity, goal]) => {
      return Math.abs(coordinate(loops.mechanism, q, velocity) - goal) <= BEYOND;
    });
    const closed = Math.max(0, ...loops.residual(q).map(Math.abs)) <= CLOSED;
    return { q: reached && closed ? q : null, pressed: [...pressed.keys()] };
  }

  const coordinate = ({ coordinateOf }, q, velocity) => q[coordinateOf[velocity].joint][coordinateOf[velocity].index];

  /** The limits of the coordinates; one that starts beyond its limit may stay there. */
  function limitsFrom({ mechanism, velocities }, q) {
    const bounded = velocities.filter((velocity) => mechanism.coordinateOf[velocity]);
    return bounded.map((velocity) => {
      const [{ lower, upper }, at] = [mechanism.limits[velocity], coordinate(mechanism, q, velocity)];
      return { velocity, lower: Math.min(lower, at), upper: Math.max(upper, at) };
    });
  }

  /** A step, and the coordinates that it brings to their limits: a map from their velocities to the limits. */
  function stepWithin(loops, springs, q, limits) {
    const { mechanism, velocities, units } = loops;
    const index = new Map(velocities.map((velocity, i) => [velocity, i]));
    const [K, r] = [loops.columns(q), loops.residual(q)];
    const [pressed, released] = [new Map(), new Set()];
    const ahead = (velocity, step) => {
      const i = index.get(velocity);
      return coordinate(mechanism, q, velocity) + units[i] * step[i];
    };
    for (;;) {
      const goals = [...pressed];
      // With rows of zeros, so that the free motions are among the vectors of the decomposition.
      const rows = K.map((column, i) => [
        ...column,
        ...goals.map(([velocity]) => (velocity === velocities[i] ? 1 : 0)),
        ...velocities.map(() => 0),
      ]);
      const wanted = [
        ...r.map((row, i) => -loops.scale[i] * row),
        ...goals.map(([velocity, goal]) => {
          return (goal - coordinate(mechanism, q, velocity)) / units[index.get(velocity)];
        }),
        ...velocities.map(() => 0),
      ];
      const of = svd(rows);
      const found = rank(of.values);
      const step = leastSolution(of, found, wanted, velocities.length);
      const missed = wanted.map((row, k) => Math.abs(row - rows.reduce((sum, each, i) => sum + each[k] * step[i], 0)));
      if (pressed.size > 1 && Math.max(...missed) > BEYOND) {
        // They cannot all be at their limits: the first one has left its limit.
        const [first] = pressed.keys();
        pressed.delete(first);
        released.add(first);
        continue;
      }
      const free = of.right.slice(found);
      const force = (s) => Math.sqrt(s.stiffness) * s.ratio * units[index.get(s.velocity)];
      const along = svd(free.map((each) => Float64Array.from(springs, (s) => force(s) * each[index.get(s.velocity)])));
      const left = springs.map((s) => -Math.sqrt(s.stiffness) * (s.ratio * ahead(s.velocity, step) + s.shift));
      const z = leastSolution(along, rank(along.values), left, free.length);
      free.forEach((each, k) => each.forEach((value, i) => (step[i] += z[k] * value)));
      let first = null;
      for (const { velocity, lower, upper } of limits) {
        if (pressed.has(velocity) || released.has(velocity)) continue;
        const [before, after] = [coordinate(mechanism, q, velocity), ahead(velocity, step)];
        const [limit, over] = after > upper ? [upper, after - upper] : [lower, lower - after];
        const part = over > BEYOND ? over / Math.abs(after - before) : 0;
        if (part > 0 && (!first || part > first.part)) first = { velocity, limit, part };
      }
      if (!first) return [step, pressed];
      pressed.set(first.velocity, first.limit);
    }
  }

  globalThis.eurdf.atRest = atRest;
})();
