// What plays in the viewer: all actuators in turn, and the range of motion of one, here; gravity and trajectories, by the
// server, which sends where the robot is.

import { sweep } from "../src/closing.js";
import { button, element } from "./elements.js";
import { Play } from "./play.js";

const STEPS = 60; // of each way of a range of motion
const FRAME = 1000 / 30; // time from one to the next, ms
const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];

export class Playing extends Play {
  constructor(session, connection) {
    super(session);
    this.connection = connection;
    this.server = { what: null, paused: false };
    this.sweeping = null;
    this.moved = false; // here, so that what the server played before is of no interest
  }

  get isPlaying() {
    return super.isPlaying || Boolean(this.sweeping?.goes) || this.serverPlays;
  }

  get serverPlays() {
    return this.server.what !== null && !this.server.paused;
  }

  /** Pause or go on. */
  toggle() {
    if (this.server.what) this.connection.send("pause", { paused: this.serverPlays });
    else if (this.sweeping) this.go(!this.sweeping.goes);
    else super.toggle();
  }

  /** Stop, since the robot is moved. */
  stop() {
    super.stop();
    if (this.serverPlays) {
      this.moved = true; // until the server says that it is paused
      this.connection.send("pause", { paused: true });
    }
    this.go(false);
  }

  /** What the server says that it plays. */
  told(server) {
    this.server = server;
    if (server.what) this.sweeping = null;
    if (!this.serverPlays) this.moved = false;
    this.dispatchEvent(new Event("change"));
  }

  /** One frame of what the server plays. */
  step() {
    this.connection.send("pause", { paused: false, step: true });
  }

  /** End what plays. */
  end() {
    super.stop();
    this.sweeping = null;
    if (this.server.what) this.connection.send("end");
    this.dispatchEvent(new Event("change"));
  }

  /** Show the range of motion of an actuator, again and again; the result says where it ends. */
  sweep(joint) {
    this.end();
    this.session.begin();
    const { lower, upper } = sweep(this.session.mechanism, this.session.q, joint, { steps: STEPS });
    const [down, up] = [lower.configurations, upper.configurations];
    const frames = [...down, ...down.slice().reverse(), ...up, ...up.slice().reverse()];
    const ends = [lower, upper].map((path) => `${path.end}${path.joint ? ` of “${path.joint}”` : ""} at ${Number(path.reached.toPrecision(4))}`);
    this.sweeping = { frames, goes: false, at: 0, text: `Sweep of “${joint}”: ends at ${ends.join(" and ")}.` };
    this.go(true);
  }

  go(goes) {
    if (!this.sweeping || this.sweeping.goes === goes) return;
    this.sweeping.goes = goes;
    if (goes) requestAnimationFrame((time) => this.sweepFrom(this.sweeping, time));
    this.dispatchEvent(new Event("change"));
  }

  sweepFrom(sweeping, begin) {
    const first = sweeping.at;
    const frame = (time) => {
      if (this.sweeping !== sweeping || !sweeping.goes) return;
      sweeping.at = (first + Math.floor((time - begin) / FRAME)) % sweeping.frames.length;
      this.session.show(sweeping.frames[sweeping.at], "sweep");
      requestAnimationFrame(frame);
    };
    frame(begin);
  }
}

/** The tab of what plays. */
export class PlayTab {
  /** @param parent The panel of the tab; `before`: the tab of another version of the robot, whose choices are kept. */
  constructor(parent, playing, connection, before) {
    Object.assign(this, { playing, connection });
    parent.replaceChildren();
    const { session } = playing;
    const actuators = session.coordinates.filter(({ actuated }) => actuated).map(({ joint }) => joint);
    const joints = actuators.filter((joint) => actuators.filter((each) => each === joint).length === 1);
    if (joints.length) {
      const row = element(parent, "div", { class: "eu-row" });
      this.joint = select(row, "Actuator", joints.map((name) => [name, name]), before?.joint?.value);
      button(row, "Sweep", () => this.trying(() => playing.sweep(this.joint.value)), { title: "its range of motion, with the other actuators held" });
    }
    const fall = element(parent, "div", { class: "eu-row" });
    button(fall, "Gravity", () => this.gravity(), { title: "let it move, with motors that exert no torque" });
    this.losses = toggle(fall, "Damping and friction", before ? before.losses.checked : true, () => this.fallAgain());
    if (session.robot.root === "floating") this.held = toggle(fall, "Hold the base", before?.held?.checked ?? true, () => this.fallAgain());
    this.addTrajectory(element(parent, "div", { class: "eu-row" }));
    this.addControls(parent);
    playing.addEventListener("change", () => this.show());
    this.show();
  }

  addTrajectory(row) {
    const label = element(row, "label", {}, "Trajectory (CSV) ");
    const file = element(label, "input", { type: "file", accept: ".csv,text/csv" });
    file.addEventListener("change", async () => {
      const [chosen] = file.files;
      if (chosen) this.connection.send("follow", { name: chosen.name, text: await chosen.text() });
      file.value = "";
    });
  }

  addControls(parent) {
    const { playing } = this;
    const row = element(parent, "div", { class: "eu-row" });
    this.pauser = button(row, "Pause", () => playing.toggle(), { title: "Space" });
    this.stepper = button(row, "Step", () => playing.step(), { title: "one frame: ." });
    this.ender = button(row, "End", () => playing.end());
    this.transport = element(parent, "div", { class: "eu-row" });
    this.time = element(this.transport, "input", { type: "range", min: 0, step: "any", "aria-label": "Time" });
    this.time.addEventListener("input", () => this.seek());
    this.speed = select(this.transport, "Speed", SPEEDS.map((speed) => [String(speed), `${speed} ×`]), "1");
    this.speed.addEventListener("change", () => this.seek());
    this.text = element(parent, "p", { class: "eu-live-status", role: "status" });
  }

  trying(done) {
    try {
      done();
      this.failed = "";
    } catch (error) {
      this.failed = error.message;
    }
    this.show();
  }

  gravity() {
    this.playing.end();
    this.playing.session.begin();
    this.connection.send("gravity", { dissipation: this.losses.checked, held: this.held?.checked ?? false });
  }

  /** With what is chosen now, if it falls. */
  fallAgain() {
    if (this.playing.serverPlays && this.playing.server.what === "gravity") this.gravity();
  }

  seek() {
    this.connection.send("seek", { time: Number(this.time.value), speed: Number(this.speed.value) });
  }

  show() {
    const { playing } = this;
    const { server, sweeping } = playing;
    const isTrajectory = server.what === "trajectory";
    const plays = Boolean(server.what || sweeping);
    this.pauser.textContent = playing.isPlaying || !plays ? "Pause" : "Continue";
    this.pauser.disabled = this.ender.disabled = !plays;
    this.stepper.disabled = !server.what || playing.serverPlays;
    this.transport.hidden = !isTrajectory;
    if (isTrajectory) {
      this.time.max = server.duration;
      if (!this.time.matches(":active")) this.time.value = server.time;
    }
    this.text.textContent = this.failed || textOf(server) || sweeping?.text || "";
  }
}

function textOf({ what, time, duration, pace }) {
  if (what === "trajectory") return `Trajectory: ${time.toFixed(3)} s of ${Number(duration.toPrecision(6))} s.`;
  if (what !== "gravity") return "";
  const slow = pace < 0.995 ? `, slow motion: ${Number((100 * pace).toPrecision(2))} % of real time` : "";
  return `Gravity: ${time.toFixed(2)} s${slow}.`;
}

/** A list to choose from: [[value, text]]. */
export function select(parent, name, options, chosen) {
  const label = element(parent, "label", {}, `${name} `);
  const list = element(label, "select");
  for (const [value, text] of options) element(list, "option", { value }, text);
  if (options.some(([value]) => value === chosen)) list.value = chosen;
  return list;
}

/** A box to tick. */
export function toggle(parent, text, on, done) {
  const label = element(parent, "label");
  const box = element(label, "input", { type: "checkbox" });
  box.checked = on;
  element(label, "span", {}, text);
  box.addEventListener("change", () => done(box.checked));
  return box;
}
