// A robot on a page: its picture, which moves by hand, and the panel beside it.

import { element } from "./elements.js";
import { Grabbing } from "./grabbing.js";
import { Panel } from "./panel.js";
import { RobotScene } from "./scene.js";
import { Session } from "./session.js";
import { Viewport } from "./viewport.js";

const SAID = 3; // meshes that are not drawn and are named

export class View {
  /**
   * @param root The element to fill.
   * @param robot What `read` gives.
   * @param options.q Where to start; `options.keep`: as it is, also if a loop is open.
   * @param options.mesh The content of a mesh file by its name: (file) => Promise<ArrayBuffer>.
   * @param options.embedded Whether the page scrolls past the view.
   * @param options.place Where the panel is added; `root` by default.
   * @param options.panel More options of the panel.
   */
  constructor(root, robot, { q, keep, mesh, embedded = false, place = root, panel = {} } = {}) {
    Object.assign(this, { root, place, options: panel });
    const frame = element(root, "div", { class: "eu-live-view" });
    const canvas = element(frame, "canvas", { tabindex: "0", role: "application" });
    try {
      this.viewport = new Viewport(canvas, { embedded });
      this.canvas = canvas;
      // The style says how dark the page is: by the browser's preference, or by the theme that the user chose.
      matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.useTheme());
      new MutationObserver(() => this.useTheme()).observe(document.body, { attributeFilter: ["data-theme"] });
    } catch (error) {
      canvas.remove();
      element(frame, "p", {}, `The robot is not drawn: ${error.message}.`);
    }
    this.show(robot, { q, keep, mesh });
    this.viewport?.lookAt(this.scene.box);
    root.addEventListener("keydown", (event) => this.key(event));
  }

  /** Show a robot in place of another one, with the camera where it is; for the arguments see the constructor. */
  show(robot, { q, keep, mesh } = {}) {
    this.session = new Session(robot, q, { keep });
    if (this.viewport) this.draw(mesh);
    this.panel?.form.remove();
    this.panel = new Panel(this.place, this.session, { scene: this.scene, redraw: () => this.viewport.draw(true), ...this.options });
  }

  draw(mesh) {
    const { viewport, session } = this;
    this.canvas.setAttribute("aria-label", `The robot ${session.robot.name}, in three dimensions. Arrow keys turn it, + and - zoom.`);
    const before = this.scene;
    const scene = new RobotScene(session, mesh);
    this.scene = scene;
    if (before) {
      viewport.scene.remove(before);
      before.dispose();
    }
    viewport.scene.add(scene);
    this.grabbing ??= new Grabbing(viewport, scene);
    this.grabbing.scene = scene;
    session.addEventListener("change", () => {
      scene.place();
      viewport.draw(true);
    });
    scene.loaded.then((failed) => scene === this.scene && this.meshesLoaded(failed, !before));
    this.useTheme();
  }

  meshesLoaded(failed, isFirst) {
    this.scene.measure();
    if (isFirst) this.viewport.lookAt(this.scene.box);
    this.scene.place();
    this.viewport.draw(true);
    const sentences = [...new Set(failed.map(({ file, message }) => `The mesh ${file} is not drawn: ${message}.`))];
    const more = sentences.splice(SAID).length;
    if (more) sentences.push(`${more} more ${more === 1 ? "mesh is" : "meshes are"} not drawn.`);
    for (const sentence of sentences) element(this.panel.form, "p", { class: "eu-live-problem" }, sentence);
  }

  useTheme() {
    this.scene.dark = Number(getComputedStyle(this.viewport.canvas).getPropertyValue("--eu-live-dark"));
    this.scene.paint();
    this.viewport.draw();
  }

  /** Keys for the whole view. */
  key(event) {
    if (event.target.matches("input:not([type=range], [type=checkbox]), select, textarea")) return;
    const { panel, session } = this;
    const command = event.ctrlKey || event.metaKey;
    const key = event.key.toLowerCase();
    const isRange = event.target.type === "range";
    if (command && key === "z") panel.stopped(() => (event.shiftKey ? session.redo() : session.undo()));
    else if (command && key === "y") panel.stopped(() => session.redo());
    else if (command || event.altKey) return;
    else if (key === "r") panel.stopped(() => session.reset());
    else if (key === " " && (isRange || event.target === this.viewport?.canvas)) panel.play.toggle();
    else return;
    event.preventDefault();
  }
}
