// A robot at a configuration: what moves it, why a motion stopped, and the way back.

import { Mechanism } from "../src/mechanism.js";
import { Drive, analyze, assemble, drag, limits, sliders } from "../src/closing.js";
import { characteristicLength } from "../src/closing/scale.js";
import { CLOSED } from "../src/closing/tolerances.js";
import { JOINT_TYPES } from "../src/mechanism/joint_types.js";

const AT_LIMIT = 1e-4; // a coordinate nearer to its limit is at it, rad or m
const REACHED = 1e-3; // a part that a drag leaves nearer to its target has reached it, in characteristic lengths
const REMEMBERED = 200; // configurations to go back to

/**
 * Says what happens by the event "change", whose detail is {by, stop}: what changed the configuration, and why the
 * motion ended before its goal, if it did.
 */
export class Session extends EventTarget {
  /**
   * @param robot What `read` gives.
   * @param q Where to start, closed if it is open; by default `assembled`, or a closed configuration that is found.
   * @param options.keep Whether to start at q as it is.
   */
  constructor(robot, q, { keep = false } = {}) {
    super();
    this.robot = robot;
    this.mechanism = new Mechanism(robot);
    this.first = keep ? q : assemble(this.mechanism, q).q;
    this.drive = new Drive(this.mechanism, this.first);
    this.q = this.first;
    this.configurations = new Map([...robot.configurations].map(([name, own]) => [name, Object.fromEntries(own)]));
    /** What the user moves; for the properties see `sliders`. */
    this.coordinates = inOrder(sliders(this.mechanism, this.first), robot.actuators);
    this.analysis = analyze(this.mechanism, this.first);
    this.length = characteristicLength(this.mechanism); // m
    this.types = new Map(robot.joints.map(({ name, type }) => [name, type]));
    this.stop = null;
    this.keepsRotation = false; // of a part that is dragged
    this.before = []; // configurations to undo to
    this.after = []; // and to redo to
    this.from = null; // where a gesture of the user began, until it changes something
    this.measure();
  }

  /** The coordinate, rad or m. */
  value({ joint, index }) {
    return this.drive.value(joint, index);
  }

  /** Whether all loops are closed. */
  get isClosed() {
    return this.residual <= CLOSED;
  }

  /** The joints at a position limit, by name. */
  get atLimits() {
    return new Set(this.limits.filter(isReached).map(({ joint }) => joint));
  }

  /** A gesture of the user begins: `undo` returns to this configuration, from all that changes until the next call. */
  begin() {
    this.from = this.q;
  }

  /** Move a coordinate; the loops stay closed. */
  move(coordinate, value) {
    const { q, stop } = this.drive.move(coordinate.joint, coordinate.index, value);
    this.q = q;
    this.changed("move", stop);
    return stop;
  }

  /**
   * Bring a point of a link (in its frame, m) as near to a target (in the world, m) as loops and limits allow. A
   * floating root stays where it is, unless the link is part of its body. If parts keep their orientation, the link has
   * this rotation.
   */
  drag(link, point, target, rotation) {
    const held = this.robot.root === "floating" && !this.isOfRoot(link) ? ["root_joint"] : [];
    const goal = { link, point, target, held, rotation: this.keepsRotation ? rotation : undefined };
    const found = drag(this.mechanism, this.q, goal);
    this.q = this.drive.q = found.q;
    const [joint] = found.atLimits;
    const isBehind = found.error > REACHED * this.length;
    const reason = joint ? "held at limit" : "out of reach";
    this.changed("drag", isBehind ? { reason, joint, error: found.error } : null);
    return found;
  }

  /** Whether only fixed joints are between a link and the root link. */
  isOfRoot(link) {
    const above = this.robot.joints.find(({ child }) => child === link);
    return !above || (above.type === "fixed" && this.isOfRoot(above.parent));
  }

  /** Go to a configuration, closed or not. */
  show(q, by = "show") {
    this.q = this.drive.q = q;
    this.changed(by, null);
  }

  reset() {
    this.begin();
    this.show(this.first, "reset");
  }

  /** Close the loops near the configuration, within the position limits if possible. */
  assemble() {
    this.begin();
    const within = assemble(this.mechanism, this.q, { limits: true });
    const found = within.closes ? within : assemble(this.mechanism, this.q);
    this.show(found.q, "assemble");
    return found;
  }

  undo() {
    this.step(this.before, this.after, "undo");
  }

  redo() {
    this.step(this.after, this.before, "redo");
  }

  step(from, to, by) {
    if (!from.length) return;
    this.from = null;
    to.push(this.q);
    this.show(from.pop(), by);
  }

  changed(by, stop) {
    if (this.from) {
      this.before = [...this.before.slice(1 - REMEMBERED), this.from];
      this.after = [];
      this.from = null;
    }
    this.stop = stop;
    this.measure();
    this.dispatchEvent(new CustomEvent("change", { detail: { by, stop } }));
  }

  /** What is known of the configuration: poses, residuals, distances to limits. */
  measure() {
    this.kinematics = this.mechanism.at(this.q);
    this.residuals = this.kinematics.residuals();
    this.residual = Math.max(0, ...Object.values(this.residuals).flat().map(Math.abs));
    this.limits = limits(this.mechanism, this.q).map((each) => ({ ...each, unit: this.unitOf(each) }));
  }

  /** The unit of a coordinate of a joint; without an index, of its only one. */
  unitOf({ joint, index }) {
    const kinds = JOINT_TYPES[this.types.get(joint)]?.coordinates ?? [];
    const kind = index === undefined && kinds.length > 1 ? undefined : kinds[index ?? 0];
    return kind && (kind === "length" ? "m" : "rad");
  }
}

/** Whether a coordinate is at its limit. */
export const isReached = ({ distance }) => distance <= AT_LIMIT;

/** Coordinates in the order of the actuators in the file. */
function inOrder(coordinates, actuators) {
  const places = new Map(actuators.map(({ joint }, place) => [joint, place]));
  return [...coordinates].sort((a, b) => (places.get(a.joint) ?? 0) - (places.get(b.joint) ?? 0));
}
