// The motion of one coordinate with the loops closed: the passive joints follow on the same branch.

import { analysisOf } from "./analyze.js";
import { Branch } from "./branch.js";
import { Loops } from "./loops.js";
import { coordinatesOf, hasPose, motionsBetween } from "./poses_of_joints.js";
import { problemOf } from "./problem.js";
import { rangeOf } from "./sliders.js";
import { atRest } from "./spring_rest.js";
import { CLOSED, DEAD } from "./tolerances.js";

const SHORTEST_STEP = 2 ** -22; // of the range of a coordinate
const TO_LIMIT = 8; // corrections of a last step to the limit of a passive joint
const REST_STEPS = 40; // over the range of a coordinate, of a robot with springs
const SHORTEST_REST_STEP = 2 ** -12; // of these steps
const POSE_STEP = 1 / 40; // longest step of a coordinate of a pose, as a part of its range

/** A robot at a configuration, moved one coordinate at a time. */
export class Drive {
  constructor(mechanism, q) {
    this.mechanism = mechanism;
    this.problem = problemOf(mechanism);
    this.q = q;
    this.branches = new Map();
    this.largest = new Map();
  }

  get q() {
    return this.problem.tree.write(this.x);
  }

  set q(q) {
    this.x = this.problem.tree.read(q);
  }

  /** What depends on the actuators that the loops make dependent: found at the first motion. */
  get dependent() {
    this.analysis ??= analysisOf(this.problem, this.x);
    return this.analysis.dependentActuators;
  }

  /** A coordinate, rad or m: the angle of a continuous joint from -π to π; of a rotation, of its rotation vector. */
  value(joint, index = 0) {
    return coordinatesOf(this.problem.joint(joint), this.x)[index];
  }

  /**
   * Move a coordinate; the passive joints follow on the same branch. If the loops are open, it moves alone.
   *
   * @param index Among the coordinates of the joint; of planar, spherical and floating joints, among those of its pose:
   *   positions in the joint's frame (m), and the angle, or the rotation vector (rad).
   * @returns {q, stop}: where it gets, and why it stopped before, or null: {reason, joint, value}.
   */
  move(joint, index, value) {
    if (!Number.isFinite(value)) throw new RangeError(`'${joint}' cannot move to ${value}`);
    const own = this.problem.joint(joint);
    if (!(index in coordinatesOf(own, this.x))) throw new RangeError(`'${joint}' has no coordinate ${index}`);
    const range = rangeOf(this.problem, this.x, own, index);
    const at = this.value(joint, index);
    const goal = Math.min(Math.max(value, range.least), range.most);
    const stop = goal === value ? null : { reason: range.isLimit ? "limit" : "half turn", joint, value: goal };
    const slider = { joint, size: range.upper - range.lower };
    const stopped = hasPose(own)
      ? this.movePose(slider, own, index, at, goal)
      : this.moveVelocity(slider, own.column + index, at, goal - at);
    return { q: this.q, stop: stopped ?? stop };
  }

  movePose(slider, joint, index, at, goal) {
    let most = POSE_STEP * slider.size;
    const pose = coordinatesOf(joint, this.x);
    let stop = null;
    while (at !== goal) {
      const left = goal - at;
      const there = Math.abs(left) <= most ? goal : at + Math.sign(left) * most;
      const before = this.x;
      pose[index] = there;
      let stopped = null;
      for (const [number, amount] of motionsBetween(joint.type, coordinatesOf(joint, this.x), pose)) {
        stopped = this.moveVelocity(slider, joint.column + number, at, amount);
        if (stopped) break;
      }
      if (!stopped) {
        at = there;
        continue;
      }
      this.x = before;
      stop = stopped;
      most = 0.5 * Math.min(most, Math.abs(left));
      if (most < SHORTEST_STEP * slider.size) break;
    }
    return stop && stop.joint === slider.joint ? { ...stop, value: at } : stop;
  }

  /** Moves one velocity by a distance, rad or m, from `begin` on. Returns why it stopped, or null. */
  moveVelocity(slider, velocity, begin, distance) {
    if (!distance) return null;
    const { problem } = this;
    if (problem.largestResidual(this.x) > CLOSED) {
      this.x = problem.moved(this.x, velocity, distance);
      return null;
    }
    const sprung = problem.springs.length && problem.actuated.size;
    return sprung
      ? this.followAtRest(slider, velocity, begin, distance)
      : this.follow(slider, velocity, begin, distance);
  }

  follow(slider, velocity, begin, distance) {
    const branch = this.branch(slider.joint, velocity);
    let here = branch.at(this.x);
    let largest = Math.max(this.largest.get(velocity) ?? 0, here.smallest);
    const shortest = SHORTEST_STEP * slider.size;
    let [left, part, stop] = [distance, distance, null];
    while (left !== 0) {
      const there = branch.step(here, part);
      if (!there && Math.abs(part) > shortest) {
        part *= 0.5;
        continue;
      }
      if (there && branch.passiveLimit(here, there)) {
        [here, stop] = this.toLimit(branch, here, part);
        break;
      }
      const leaves = there && there.smallest >= here.smallest;
      if (!there || there.rank !== here.rank || !(leaves || there.smallest >= DEAD * largest)) {
        const blocked = left === distance && this.dependent.some((names) => names.includes(slider.joint));
        stop = { reason: blocked ? "blocked" : "dead point", joint: slider.joint, value: begin + distance - left };
        break;
      }
      [here, left] = [there, left - part];
      largest = Math.max(largest, here.smallest);
      part = Math.sign(part) * Math.min(Math.abs(2 * part), Math.abs(left));
    }
    this.largest.set(velocity, Number.isFinite(largest) ? largest : 0);
    this.x = here.x;
    return stop;
  }

  /** The last point before a passive joint exceeds its limit, on a step that does. */
  toLimit(branch, here, part) {
    let velocity = -1;
    for (let count = 0; count < TO_LIMIT; count += 1) {
      const there = part ? branch.step(here, part) : null; // it is at its limit already
      const met = there && branch.passiveLimit(here, there);
      if (!met) break;
      velocity = met.velocity;
      const nearer = part * met.part ? branch.step(here, part * met.part) : null;
      if (nearer && !branch.passiveLimit(here, nearer)) {
        here = nearer;
        part *= 1 - met.part;
      } else part *= met.part;
    }
    return [here, this.atLimit(velocity, here.x)];
  }

  /** As `follow`, for a robot whose springs decide what the actuators do not: it is at rest after each step. */
  followAtRest(slider, velocity, begin, distance) {
    const { problem } = this;
    const { loops: driven, passive } = this.branch(slider.joint, velocity);
    const loops = new Loops(problem, driven.constraints, passive);
    const longest = slider.size / REST_STEPS;
    let [x, left, pressed] = [this.x, distance, []];
    let part = Math.sign(distance) * Math.min(Math.abs(distance), longest);
    let stop = null;
    while (left !== 0) {
      const there = atRest(loops, problem.moved(x, velocity, part));
      if (there.x) {
        [x, left, pressed] = [there.x, left - part, there.pressed];
        part = Math.sign(distance) * Math.min(2 * Math.abs(part), Math.abs(left), longest);
      } else if (Math.abs(part) > SHORTEST_REST_STEP * longest) part *= 0.5;
      else {
        const met = there.pressed.find((each) => !pressed.includes(each));
        const dead = { reason: "dead point", joint: slider.joint, value: begin + distance - left };
        stop = met === undefined ? dead : this.atLimit(met, x);
        break;
      }
    }
    this.x = x;
    return stop;
  }

  atLimit(velocity, x) {
    const { coordinate, lower, upper, joints } = this.problem;
    const at = x[coordinate[velocity]];
    const isLower = Math.abs(at - lower[velocity]) < Math.abs(at - upper[velocity]);
    return { reason: "passive limit", joint: joints[velocity].name, value: (isLower ? lower : upper)[velocity] };
  }

  branch(joint, velocity) {
    if (!this.branches.has(velocity)) {
      const held = new Set(this.problem.actuated);
      held.delete(velocity);
      const follow = this.dependent.filter((names) => names.includes(joint)).flat();
      for (const name of follow)
        if (name !== joint) this.problem.velocitiesOf(name).forEach((each) => held.delete(each));
      this.branches.set(velocity, new Branch(this.problem, velocity, held));
    }
    return this.branches.get(velocity);
  }
}
