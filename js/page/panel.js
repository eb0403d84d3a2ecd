// The panel beside a robot: a slider for each coordinate, configurations, passive joints and what stops a motion.

import { button, element } from "./elements.js";
import { Play } from "./play.js";
import { quantity, stateOfLoops, whyStopped } from "./sentences.js";
import { isReached } from "./session.js";

const DEGREES = "eu-degrees"; // whether the browser remembers to show degrees

export class Panel {
  /** @param root Where to add it; `scene` is a RobotScene, or null where nothing is drawn; `loops`: with a switch for loops. */
  constructor(root, session, { scene, redraw, play = (own) => new Play(own), loops = true }) {
    Object.assign(this, { session, scene, redraw, play: play(session) });
    this.degrees = remembered(DEGREES);
    this.form = element(root, "form", { class: "eu-live-panel", "aria-label": "Robot" });
    this.form.addEventListener("submit", (event) => event.preventDefault());
    this.addButtons(loops);
    this.addSliders();
    this.addPassive();
    this.status = element(this.form, "p", { class: "eu-live-status", role: "status" });
    session.addEventListener("change", () => this.show());
    this.play.addEventListener("change", () => this.showButtons());
    this.show();
  }

  addButtons(loops) {
    const { session, play } = this;
    this.buttons = element(this.form, "div", { class: "eu-live-buttons" });
    this.player = button(this.buttons, "Play", () => play.toggle(), { title: "Space" });
    this.resetter = button(this.buttons, "Reset", () => this.stopped(() => session.reset()), { title: "R" });
    this.undoer = button(this.buttons, "Undo", () => this.stopped(() => session.undo()), { title: "Ctrl+Z" });
    this.redoer = button(this.buttons, "Redo", () => this.stopped(() => session.redo()), { title: "Ctrl+Shift+Z" });
    this.assembler = button(this.buttons, "Assemble", () => this.stopped(() => session.assemble()));
    for (const [name, q] of session.configurations) {
      if (name !== "assembled") this.addConfiguration(name, q);
    }
    if (loops && this.scene && session.robot.closures.length) this.addSwitch("Loops", false, (on) => this.showLoops(on));
    const angles = session.limits.length || session.coordinates.some(({ unit }) => unit === "rad");
    if (angles) this.addSwitch("Degrees", this.degrees, (on) => this.useDegrees(on));
  }

  /** A button that goes to a configuration, in place of another one of this name. */
  addConfiguration(name, q) {
    const go = () =>
      this.stopped(() => {
        this.session.begin();
        this.session.show(q);
      });
    const before = [...this.buttons.children].find((each) => each.dataset.configuration === name);
    const added = button(this.buttons, name, go, { "data-configuration": name });
    before?.replaceWith(added);
  }

  /** Show a sentence where the state of the loops is, until the robot moves. */
  say(sentence) {
    this.status.textContent = sentence;
  }

  addSwitch(text, on, done) {
    const label = element(this.buttons, "label");
    const box = element(label, "input", { type: "checkbox" });
    box.checked = on;
    element(label, "span", {}, text);
    box.addEventListener("change", () => done(box.checked));
  }

  showLoops(on) {
    this.scene.loops.shown = this.scene.translucent = on;
    this.scene.place();
    this.redraw();
  }

  useDegrees(on) {
    this.degrees = on;
    remember(DEGREES, on);
    this.show();
  }

  /** Do something after what is played has stopped. */
  stopped(done) {
    this.play.stop();
    done();
  }

  addSliders() {
    const { session } = this;
    const sliders = element(this.form, "div", { class: "eu-live-sliders" });
    this.sliders = session.coordinates.map((coordinate) => {
      const row = element(sliders, "div", { class: "eu-live-slider" });
      element(row, "span", {}, coordinate.label);
      const output = element(row, "span", { class: "eu-live-value" });
      const { lower: min, upper: max } = coordinate;
      const input = element(row, "input", { type: "range", min, max, step: "any", "aria-label": coordinate.label });
      input.addEventListener("input", () => {
        this.play.stop();
        if (this.inHand !== input) session.begin();
        this.inHand = input;
        session.move(coordinate, Number(input.value));
      });
      input.addEventListener("change", () => {
        this.inHand = null;
        this.show(); // to where the robot is, if it could not follow
      });
      return { coordinate, row, output, input };
    });
  }

  addPassive() {
    const { session } = this;
    const passive = session.limits.filter((each) => each.passive);
    if (!passive.length) return;
    const details = element(this.form, "details", { class: "eu-live-passive" });
    this.summary = element(details, "summary");
    const table = element(details, "table");
    const head = element(element(table, "thead"), "tr");
    for (const title of ["Passive joint", "at", "to its limit"]) element(head, "th", { scope: "col" }, title);
    const body = element(table, "tbody");
    this.passive = passive.map((each) => {
      const row = element(body, "tr");
      element(row, "th", { scope: "row" }, each.joint);
      return { key: keyOf(each), row, at: element(row, "td"), left: element(row, "td") };
    });
    details.addEventListener("toggle", () => this.showPassive());
    this.details = details;
  }

  /** Bring the panel to where the robot is. */
  show() {
    const { session } = this;
    const atLimits = new Set(session.limits.filter(isReached).map(keyOf));
    for (const { coordinate, row, output, input } of this.sliders) {
      const value = session.value(coordinate);
      const at = String(value);
      if (input !== this.inHand && input.value !== at) input.value = at;
      const text = quantity(value, coordinate.unit, this.degrees);
      if (output.textContent !== text) {
        output.textContent = text;
        input.setAttribute("aria-valuetext", text);
      }
      row.classList.toggle("eu-live-at-limit", atLimits.has(keyOf(coordinate)));
    }
    this.showPassive();
    this.showButtons();
    const { stop } = session;
    const why = stop && whyStopped(stop, session.unitOf(stop), this.degrees);
    const sentence = [stateOfLoops(session), why].filter(Boolean).join(" ");
    if (this.status.textContent !== sentence) this.status.textContent = sentence;
    this.status.classList.toggle("eu-live-stopped", Boolean(session.stop) || !session.isClosed);
    this.status.dataset.residual = String(session.residual);
  }

  showPassive() {
    if (!this.passive) return;
    const found = new Map(this.session.limits.map((each) => [keyOf(each), each]));
    const count = [...found.values()].filter((each) => each.passive && isReached(each)).length;
    this.summary.textContent = `Passive joints: ${this.passive.length}${count ? `, ${count} at a limit` : ""}`;
    this.summary.classList.toggle("eu-live-at-limit", count > 0);
    if (!this.details.open) return;
    for (const { key, row, at, left } of this.passive) {
      const { value, distance, unit } = found.get(key);
      at.textContent = quantity(value, unit, this.degrees);
      left.textContent = Number.isFinite(distance) ? quantity(distance, unit, this.degrees) : "no limit";
      row.classList.toggle("eu-live-at-limit", isReached({ distance }));
    }
  }

  showButtons() {
    const { session, play } = this;
    this.player.textContent = play.isPlaying ? "Pause" : "Play";
    this.player.disabled = !this.sliders.length;
    this.undoer.disabled = !session.before.length;
    this.redoer.disabled = !session.after.length;
    this.assembler.hidden = session.isClosed;
  }
}

const keyOf = ({ joint, index }) => `${joint} ${index}`;

function remembered(name) {
  try {
    return localStorage.getItem(name) === "true";
  } catch {
    return false; // a page without storage
  }
}

function remember(name, value) {
  try {
    localStorage.setItem(name, String(value));
  } catch {
    // a page without storage: it lasts until the page is closed
  }
}
