// The motion of one coordinate with the loops closed: the passive joints follow on the same branch.
//
// It does what eurdf.kinematics.branch and eurdf.viewing.session do, with the same bounds.
"use strict";

(function () {
  const { inner, svd, rank, leastSolution } = globalThis.eurdf.algebra;

  // A step is short enough if the correction that closes the loops after it is at most this fraction of it, ...
  const MOST_CORRECTION = 0.1;
  // ... and if K_p changes by less than the sum of its smallest singular values before and after the step.
  const MOST_CORRECTIONS = 12;
  const CLOSED = 1e-13; // bound of each row of the residual after the corrections, m or rad, ...
  const ROUNDING = 1e-14; // ... unless a correction is smaller than this (rad, or characteristic lengths)
  const OPEN = 1e-6; // a larger row of the residual is that of open loops, m or rad
  const BEYOND = 1e-9; // tolerance of a limit, rad or m
  const DEAD = 0.01; // a smallest singular value of K_p below this part of the largest one met is that of a dead point
  const SHORTEST_STEP = 2 ** -22; // of the range of a slider
  const TO_LIMIT = 8; // corrections of a last step to the limit of a passive joint
  const REST_STEPS = 40; // of a slider over its range, of a robot with springs
  const SHORTEST_REST_STEP = 2 ** -12; // of these steps

  /** The velocities and constraints of the loops that a velocity moves while others are held. */
  function groupOf(mechanism, velocity, held) {
    const [velocities, constraints] = [new Set([velocity]), new Set()];
    for (let grown = true; grown; ) {
      grown = false;
      for (const constraint of mechanism.constraints) {
        const moving = constraint.velocities.filter((each) => !held.has(each));
        if (constraints.has(constraint) || !moving.some((each) => velocities.has(each))) continue;
        // A joint with several velocities is one mover.
        moving.forEach((each) => mechanism.movers[each].forEach((of) => velocities.add(of)));
        constraints.add(constraint);
        grown = true;
      }
    }
    const ascending = (a, b) => a - b;
    return { velocities: [...velocities].sort(ascending), constraints: [...constraints] };
  }

  /** Some constraints, and the velocities that may meet them; all are dimensionless but for the residual. */
  class Loops {
    constructor(mechanism, velocities, constraints) {
      Object.assign(this, { mechanism, velocities, constraints });
      this.units = velocities.map((each) => mechanism.data.units[each]);
      this.scale = constraints.flatMap((each) => each.scale);
    }

    /** The residual, m and rad. */
    residual(q) {
      const placed = this.mechanism.place(q);
      return this.constraints.flatMap((each) => this.mechanism.residual(each, q, placed));
    }

    /** The columns of K. */
    columns(q) {
      const placed = this.mechanism.place(q);
      const K = this.velocities.map(() => new Float64Array(this.scale.length));
      let first = 0;
      for (const constraint of this.constraints) {
        for (const [velocity, rates] of this.mechanism.derivative(constraint, placed)) {
          const column = this.velocities.indexOf(velocity);
          if (column >= 0)
            rates.forEach((rate, row) => {
              K[column][first + row] = this.scale[first + row] * this.units[column] * rate;
            });
        }
        first += constraint.scale.length;
      }
      return K;
    }

    /** The configuration after a step. */
    moved(q, step) {
      const v = new Float64Array(this.mechanism.data.units.length);
      step.forEach((each, index) => (v[this.velocities[index]] = this.units[index] * each));
      return this.mechanism.integrate(q, v);
    }
  }

  /** Steps of one velocity along the branch of closed configurations, while others are held. */
  class Branch extends Loops {
    constructor(mechanism, velocity, held) {
      const { velocities, constraints } = groupOf(mechanism, velocity, held);
      super(mechanism, velocities, constraints);
      this.driven = velocities.indexOf(velocity);
    }

    /** A closed configuration, and K there, dimensionless. */
    at(q, correction = 0) {
      const K = this.columns(q);
      const passive = svd(K.filter((_, index) => index !== this.driven));
      const found = rank(passive.values);
      return { q, correction, K, passive, rank: found, smallest: found ? passive.values[found - 1] : Infinity };
    }

    /** The configuration after the coordinate has moved by h, rad or m; null if the step is too long. */
    step(here, h) {
      const driven = h / this.units[this.driven];
      const rows = Float64Array.from(here.K[this.driven], (rate) => -rate * driven);
      const step = this._following(here, rows);
      step[this.driven] = driven;
      let q = this.moved(here.q, step);
      const correction = new Float64Array(step.length);
      for (let count = 0; ; count++) {
        if (count === MOST_CORRECTIONS) return null;
        const r = this.residual(q);
        if (Math.max(0, ...r.map(Math.abs)) <= CLOSED) break;
        const more = this._following(
          here,
          r.map((row, index) => -this.scale[index] * row),
        );
        q = this.moved(q, more);
        more.forEach((each, index) => (correction[index] += each));
        if (Math.max(...more.map(Math.abs)) <= ROUNDING) break;
      }
      const part = Math.sqrt(inner(correction, correction) / inner(step, step));
      if (!(part <= MOST_CORRECTION)) return null;
      const there = this.at(q, part);
      let change = 0;
      there.K.forEach((column, index) => {
        if (index !== this.driven) column.forEach((rate, row) => (change += (rate - here.K[index][row]) ** 2));
      });
      return Math.sqrt(change) <= here.smallest + there.smallest ? there : null;
    }

    /** The passive joint that first reaches its limit between two configurations, and after what part of the step. */
    passiveLimit(here, there) {
      let first = null;
      this.velocities.forEach((velocity, index) => {
        const coordinate = this.mechanism.coordinateOf[velocity];
        if (index === this.driven || !coordinate) return;
        const { lower, upper } = this.mechanism.limits[velocity];
        const [before, after] = [here, there].map(({ q }) => q[coordinate.joint][coordinate.index]);
        const over = Math.max(after - Math.max(upper, before), Math.min(lower, before) - after);
        // Half the tolerance is left, so that a search for the limit ends within it.
        const part = over > BEYOND ? (over - 0.5 * BEYOND) / Math.abs(after - before) : 0;
        if (part > 0 && (!first || part > 1 - first.part)) first = { velocity, part: 1 - part };
      });
      return first;
    }

    _following(here, rows) {
      const passive = leastSolution(here.passive, here.rank, rows, this.velocities.length - 1);
      const step = new Float64Array(this.velocities.length);
      let next = 0;
      for (let index = 0; index < step.length; index++) if (index !== this.driven) step[index] = passive[next++];
      return step;
    }
  }

  /** A robot at a configuration. */
  class Motion {
    /** @param data What `eurdf.viewing.live_robot` writes. */
    constructor(data) {
      this.data = data;
      this.mechanism = new globalThis.eurdf.Mechanism(data);
      this.sliders = data.sliders;
      this.branches = new Map();
      this.largest = new Map();
      this.q = data.start;
    }

    /** The largest row of the residual, m or rad. */
    get residual() {
      return this.mechanism.largestResidual(this.q);
    }

    /** The coordinate of a slider, rad or m; the angle of a continuous joint is from -π to π. */
    value(index) {
      const { joint, index: of } = this.mechanism.coordinateOf[this.sliders[index].velocity];
      const value = this.q[joint][of];
      const turns = this.mechanism.joints[joint].type === "continuous";
      return turns ? Math.atan2(Math.sin(value), Math.cos(value)) : value;
    }

    /**
     * Move a coordinate; the passive joints follow on the same branch.
     *
     * @param index Of the slider.
     * @param value Where to move it, rad or m.
     * @returns Why it stopped before: {reason, joint, value}; or null.
     */
    move(index, value) {
      const slider = this.sliders[index];
      const goal = Math.min(Math.max(value, slider.lower), slider.upper);
      const stop = goal === value ? null : { reason: "limit", joint: slider.joint, value: goal };
      const distance = goal - this.value(index);
      if (this.residual > OPEN) {
        const v = new Float64Array(this.data.units.length);
        v[slider.velocity] = distance;
        this.q = this.mechanism.integrate(this.q, v);
        return stop;
      }
      const sprung = this.data.springs.length && this.data.held.length;
      const followed = sprung ? this._followAtRest(index, distance) : this._follow(index, distance);
      this.q = followed.q;
      return followed.stop || stop;
    }

    _follow(index, distance) {
      const slider = this.sliders[index];
      const branch = this._branch(index);
      const begin = this.value(index);
      let here = branch.at(this.q);
      let largest = Math.max(this.largest.get(index) || 0, here.smallest);
      const shortest = SHORTEST_STEP * (slider.upper - slider.lower);
      let [left, part, stop] = [distance, distance, null];
      while (left !== 0) {
        const there = branch.step(here, part);
        if (!there && Math.abs(part) > shortest) {
          part *= 0.5;
          continue;
        }
        if (there && branch.passiveLimit(here, there)) {
          [here, stop] = this._toLimit(branch, here, part);
          break;
        }
        const leaves = there && there.smallest >= here.smallest;
        if (!there || there.rank !== here.rank || !(leaves || there.smallest >= DEAD * largest)) {
          const reason = left === distance && slider.dependent ? "blocked" : "dead point";
          stop = { reason, joint: slider.joint, value: begin + distance - left };
          break;
        }
        [here, left] = [there, left - part];
        largest = Math.max(largest, here.smallest);
        part = Math.sign(part) * Math.min(Math.abs(2 * part), Math.abs(left));
      }
      this.largest.set(index, Number.isFinite(largest) ? largest : 0);
      return { q: here.q, stop };
    }

    /** The last configuration before a passive joint exceeds its limit, on a step that does. */
    _toLimit(branch, here, part) {
      let velocity = -1;
      for (let count = 0; count < TO_LIMIT; count++) {
        const there = branch.step(here, part);
        const met = there && branch.passiveLimit(here, there);
        if (!met) break;
        velocity = met.velocity;
        const nearer = part * met.part ? branch.step(here, part * met.part) : null;
        if (nearer && !branch.passiveLimit(here, nearer)) {
          here = nearer;
          part *= 1 - met.part;
        } else part *= met.part;
      }
      return [here, this._atLimit(velocity, here.q)];
    }

    /** As `_follow`, for a robot whose springs decide what the actuators do not: it is at rest after each step. */
    _followAtRest(index, distance) {
      const slider = this.sliders[index];
      const { velocities, constraints } = this._branch(index);
      const passive = velocities.filter((velocity) => velocity !== slider.velocity);
      const loops = new Loops(this.mechanism, passive, constraints);
      const longest = (slider.upper - slider.lower) / REST_STEPS;
      const begin = this.value(index);
      let [q, left, pressed] = [this.q, distance, []];
      let part = Math.sign(distance) * Math.min(Math.abs(distance), longest);
      while (left !== 0) {
        const v = new Float64Array(this.data.units.length);
        v[slider.velocity] = part;
        const there = globalThis.eurdf.atRest(loops, this.data.springs, this.mechanism.integrate(q, v));
        if (there.q) {
          [q, left, pressed] = [there.q, left - part, there.pressed];
          part = Math.sign(distance) * Math.min(2 * Math.abs(part), Math.abs(left), longest);
        } else if (Math.abs(part) > SHORTEST_REST_STEP * longest) part *= 0.5;
        else {
          const velocity = there.pressed.find((each) => !pressed.includes(each));
          const dead = { reason: "dead point", joint: slider.joint, value: begin + distance - left };
          return { q, stop: velocity === undefined ? dead : this._atLimit(velocity, q) };
        }
      }
      return { q, stop: null };
    }

    _atLimit(velocity, q) {
      const { joint, index } = this.mechanism.coordinateOf[velocity];
      const { lower, upper } = this.mechanism.limits[velocity];
      const at = q[joint][index];
      const value = Math.abs(at - lower) < Math.abs(at - upper) ? lower : upper;
      return { reason: "passive limit", joint: this.mechanism.joints[joint].name, value };
    }

    _branch(index) {
      if (!this.branches.has(index)) {
        const slider = this.sliders[index];
        const held = new Set(this.data.held);
        [slider.velocity, ...slider.follow].forEach((velocity) => held.delete(velocity));
        this.branches.set(index, new Branch(this.mechanism, slider.velocity, held));
      }
      return this.branches.get(index);
    }
  }

  globalThis.eurdf.Motion = Motion;
})();
