// A robot on a page: sliders that move its actuators with the loops closed, and a picture that can be turned.
"use strict";

(function () {
  const CLOSURE = [0.55, 0.24, 0.78];
  const OPEN = [0.9, 0.1, 0.1];
  const TRANSLUCENT = 0.25; // opacity of shapes behind which loops are shown
  const LINE = 0.003; // radius of a line, in sizes of the robot
  const DOT = 0.008;
  const SPEED = 0.25; // of what is played, in ranges of a slider per second

  /** Make an element with text, which is never markup. */
  function element(parent, tag, attributes = {}, text = "") {
    const made = parent.appendChild(document.createElement(tag));
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    made.textContent = text;
    return made;
  }

  function sentence({ reason, joint, value }) {
    const at = Number(value.toPrecision(4));
    return {
      limit: `“${joint}” is at its position limit ${at}.`,
      "passive limit": `Passive joint “${joint}” is at its position limit ${at}.`,
      "dead point": `Dead point: at ${at}, “${joint}” no longer determines the passive joints.`,
      blocked: `The loops block “${joint}”: it cannot move with the other actuators held.`,
    }[reason];
  }

  class Page {
    /** @param root An element with a script element that contains what `eurdf.viewing.live_robot` writes. */
    constructor(root) {
      const data = JSON.parse(root.querySelector("script[type='application/json']").textContent);
      this.data = data;
      this.motion = new globalThis.eurdf.Motion(data);
      this.closures = this.motion.mechanism.constraints.filter((each) => each.type !== "coupling");
      const view = element(root, "div", { class: "eu-live-view" });
      const canvas = element(view, "canvas", { tabindex: "0", role: "application" });
      const label = `The robot ${data.name}, in three dimensions. Arrow keys turn it, + and - zoom.`;
      canvas.setAttribute("aria-label", label);
      const panel = element(root, "form", { class: "eu-live-panel", "aria-label": "Actuators" });
      panel.addEventListener("submit", (event) => event.preventDefault());
      this.buttons = element(panel, "div", { class: "eu-live-buttons" });
      this.sliders = element(panel, "div", { class: "eu-live-sliders" });
      this.inputs = data.sliders.map((slider, index) => this._slider(slider, index));
      this.status = element(panel, "p", { class: "eu-live-status", role: "status" });
      this._controls();
      try {
        this.drawing = new globalThis.eurdf.Drawing(canvas, data.shapes, data);
        this._look(canvas);
        new ResizeObserver(() => this._soon()).observe(canvas);
        // The style says how dark the page is: by the browser's preference, or by the theme that the user chose.
        matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this._soon());
        new MutationObserver(() => this._soon()).observe(document.body, { attributeFilter: ["data-theme"] });
      } catch (error) {
        canvas.remove();
        element(view, "p", {}, `The robot is not drawn: ${error.message}.`);
      }
      this.show(null);
    }

    /** Bring the page to where the robot is, with the reason for which a motion ended, if it did. */
    show(stop, inHand = -1) {
      this.inputs.forEach(({ input, output, slider }, index) => {
        const value = this.motion.value(index);
        if (index !== inHand) input.value = String(value);
        const degrees = slider.unit === "rad" ? ` (${((value * 180) / Math.PI).toFixed(1)}°)` : "";
        output.textContent = `${value.toFixed(3)} ${slider.unit}${degrees}`;
        input.setAttribute("aria-valuetext", output.textContent);
      });
      const { residual } = this.motion;
      const loops = this.data.constraints.length
        ? residual > 1e-6
          ? `The loops are open: residual ${residual.toExponential(1)}.`
          : `The loops are closed: residual ${residual.toExponential(1)}.`
        : "No loops.";
      this.status.textContent = stop ? `${loops} ${sentence(stop)}` : loops;
      this.status.dataset.residual = String(residual);
      this._soon();
    }

    _slider(slider, index) {
      const row = element(this.sliders, "div", { class: "eu-live-slider" });
      element(row, "span", {}, slider.label);
      const output = element(row, "span", { class: "eu-live-value" });
      const input = element(row, "input", { type: "range", min: slider.lower, max: slider.upper, step: "any" });
      input.setAttribute("aria-label", slider.label);
      input.addEventListener("input", () => {
        this._play(false);
        this.show(this.motion.move(index, Number(input.value)), index);
      });
      input.addEventListener("change", () => {
        // To where the robot is, if it could not follow.
        const at = String(this.motion.value(index));
        if (input.value !== at) input.value = at;
      });
      return { input, output, slider };
    }

    _controls() {
      const button = (text, done) => {
        const made = element(this.buttons, "button", { type: "button" }, text);
        made.addEventListener("click", () => done(made));
        return made;
      };
      this.player = button("Play", () => this._play(!this.playing));
      button("Reset", () => this._goTo(this.data.start));
      for (const [name, q] of Object.entries(this.data.configurations))
        if (name !== "assembled") button(name, () => this._goTo(q));
      if (this.closures.length) {
        const label = element(this.buttons, "label");
        const box = element(label, "input", { type: "checkbox" });
        element(label, "span", {}, "Loops");
        box.addEventListener("change", () => {
          this.marked = box.checked;
          this._soon();
        });
      }
    }

    _goTo(q) {
      this._play(false);
      this.motion.q = q;
      this.show(null);
    }

    /** Move one actuator after the other through its range, until something stops it, and back. */
    _play(on) {
      if (on === Boolean(this.playing) || !this.inputs.length) return;
      this.player.textContent = on ? "Pause" : "Play";
      this.playing = on ? { index: 0, direction: 1, turns: 0, from: this.motion.value(0), before: null } : null;
      if (on) requestAnimationFrame((time) => this._frame(time));
    }

    _frame(time) {
      const { playing } = this;
      if (!playing) return;
      const { lower, upper } = this.data.sliders[playing.index];
      const elapsed = playing.before === null ? 0 : Math.min(time - playing.before, 50) / 1000;
      playing.before = time;
      const at = this.motion.value(playing.index);
      let goal = at + playing.direction * SPEED * (upper - lower) * elapsed;
      const back = playing.turns === 2 && goal >= playing.from;
      if (back) goal = playing.from;
      const stop = this.motion.move(playing.index, goal);
      if (back || (stop && playing.turns === 2)) {
        const index = (playing.index + 1) % this.inputs.length;
        Object.assign(playing, { index, direction: 1, turns: 0, from: this.motion.value(index) });
      } else if (stop) {
        playing.direction *= -1;
        playing.turns += 1;
      }
      this.show(stop);
      requestAnimationFrame((next) => this._frame(next));
    }

    /** Draw before the next frame of the screen. */
    _soon() {
      if (!this.drawing || this.waiting) return;
      this.waiting = true;
      requestAnimationFrame(() => {
        this.waiting = false;
        this._draw();
      });
    }

    _draw() {
      const { mechanism, q } = this.motion;
      const placed = mechanism.place(q);
      const { size } = this.data;
      const marks = { lines: [], dots: [] };
      const line = (from, to, color) => marks.lines.push({ from, to, color, radius: LINE * size });
      for (const constraint of this.marked ? this.closures : []) {
        const [ofA, a, b, ofB] = mechanism.ends(constraint, placed);
        line(ofA, a, CLOSURE);
        line(a, b, constraint.type === "distance" ? CLOSURE : OPEN);
        line(b, ofB, CLOSURE);
        for (const at of [a, b]) marks.dots.push({ at, color: CLOSURE, radius: DOT * size });
      }
      if (!this.data.shapes.length)
        for (const { parent, child } of mechanism.joints)
          if (parent >= 0) line(placed.bodies[parent].p, placed.bodies[child].p, [0.4, 0.4, 0.4]);
      this.drawing.draw(placed.bodies, this.marked ? TRANSLUCENT : 1, marks);
    }

    /** Turn, move and zoom with mouse, fingers and keys. */
    _look(canvas) {
      const { drawing } = this;
      const pointers = new Map();
      const height = () => canvas.clientHeight || 1;
      canvas.addEventListener("pointerdown", (event) => {
        pointers.set(event.pointerId, event);
        canvas.setPointerCapture(event.pointerId);
      });
      for (const end of ["pointerup", "pointercancel"])
        canvas.addEventListener(end, (event) => pointers.delete(event.pointerId));
      canvas.addEventListener("pointermove", (event) => {
        const before = pointers.get(event.pointerId);
        if (!before) return;
        const [x, y] = [event.clientX - before.clientX, event.clientY - before.clientY];
        if (pointers.size > 1) {
          const other = [...pointers.entries()].find(([id]) => id !== event.pointerId)[1];
          const apart = (of) => Math.hypot(of.clientX - other.clientX, of.clientY - other.clientY) || 1;
          drawing.zoom(apart(before) / apart(event));
          drawing.shift(x / height() / 2, y / height() / 2);
        } else if (event.shiftKey || event.buttons & 2) drawing.shift(x / height(), y / height());
        else drawing.turn((-3 * x) / height(), (3 * y) / height());
        pointers.set(event.pointerId, event);
        this._soon();
      });
      canvas.addEventListener("contextmenu", (event) => event.preventDefault());
      canvas.addEventListener(
        "wheel",
        (event) => {
          if (document.activeElement !== canvas) return; // else one could not scroll past it
          event.preventDefault();
          drawing.zoom(Math.exp(0.001 * event.deltaY));
          this._soon();
        },
        { passive: false },
      );
      const keys = {
        ArrowLeft: () => drawing.turn(0.1, 0), ArrowRight: () => drawing.turn(-0.1, 0),
        ArrowUp: () => drawing.turn(0, 0.1), ArrowDown: () => drawing.turn(0, -0.1),
        "+": () => drawing.zoom(0.9), "-": () => drawing.zoom(1 / 0.9),
      };
      canvas.addEventListener("keydown", (event) => {
        if (!keys[event.key]) return;
        event.preventDefault();
        keys[event.key]();
        this._soon();
      });
    }
  }

  const start = () => {
    for (const root of document.querySelectorAll(".eu-live")) root.page = new Page(root);
  };
  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", start);
  else start();
})();
