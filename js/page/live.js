// The page of the viewer, which `eurdf view` serves: the first robot with its controls, other robots beside it.

import { read } from "../src/index.js";
import { Connection } from "./connection.js";
import { element } from "./elements.js";
import { LimitsTab, RobotTab, showGraph } from "./facts.js";
import { MoveTab } from "./move_tab.js";
import { PlayTab, Playing } from "./playing.js";
import { RobotScene } from "./scene.js";
import { Session } from "./session.js";
import { ShowTab } from "./show_tab.js";
import { Tabs } from "./tabs.js";
import { View } from "./view.js";

const SOON = 15; // time within which the server is told where the robot is, ms

class LivePage {
  constructor() {
    document.body.className = "eu-alone";
    const main = element(document.body, "main");
    this.title = element(main, "h1");
    this.root = element(main, "div", { class: "eu-live" });
    this.message = element(main, "p", { class: "eu-message", role: "status" });
    this.ended = element(document.body, "p", { class: "eu-ended", role: "alert", hidden: "" });
    this.robots = new Map(); // the other robots: {scene, session}, by number
    this.connection = new Connection(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/socket`);
    this.listen();
  }

  listen() {
    const { connection } = this;
    connection.addEventListener("open", () => {
      this.ended.hidden = true;
      for (const { scene } of this.robots.values()) this.view.viewport.scene.remove(scene); // those of the server follow
      this.robots.clear();
    });
    connection.addEventListener("end", () => {
      this.ended.textContent = "The viewer has ended; run `eurdf view …` again.";
      this.ended.hidden = false;
    });
    connection.on("model", (model) => (model.robot === 0 ? this.useFirst(model) : this.useOther(model)));
    connection.on("show", ({ robot, q }) => this.show(robot, q));
    connection.on("playing", (playing) => this.playing?.told(playing));
    connection.on("say", ({ text, error }) => this.say(text, error));
    connection.on("badfiles", ({ text, diagnostics }) => {
      this.say(text, true);
      this.robotTab.report(diagnostics);
    });
    connection.on("exists", (message) => this.moveTab.exists(message));
    connection.on("saved", (message) => {
      this.moveTab.saved(message);
      this.say(message.text);
    });
    connection.on("analyzed", (analyzed) => {
      this.robotTab?.analyzed(analyzed);
      this.limitsTab?.analyzed(analyzed);
    });
  }

  /** The robot with the controls, or another version of it. */
  useFirst({ version, urdf, description, meshes, q, configurations, facts }) {
    const robot = this.read(urdf, description);
    if (!robot) return;
    document.title = this.title.textContent = robot.name;
    this.version = version;
    const mesh = fetched(meshes);
    const panel = {
      loops: false,
      play: (session) => {
        for (const [name, own] of Object.entries(configurations)) session.configurations.set(name, own);
        return (this.playing = new Playing(session, this.connection));
      },
    };
    if (this.view) this.replace(robot, { q, mesh });
    else {
      this.side = document.createElement("div");
      this.side.className = "eu-side";
      this.tabs = new Tabs(this.side, "Controls");
      this.panels = Object.fromEntries(["Move", "Play", "Show", "Robot", "Limits", "Graph"].map((name) => [name, this.tabs.add(name)]));
      this.view = new View(this.root, robot, { q, mesh, place: this.panels.Move, panel });
      this.root.append(this.side);
      this.root.addEventListener("keydown", (event) => this.key(event));
    }
    this.view.session.show(q, "server");
    this.fill(mesh, facts);
    this.view.session.addEventListener("change", ({ detail }) => detail.by === "server" || this.tell());
  }

  /** Show another version of the robot; the list of passive joints stays open, and a slider in focus. */
  replace(robot, options) {
    const { view } = this;
    const { details, sliders } = view.panel;
    const label = sliders.find(({ input }) => input === document.activeElement)?.coordinate.label;
    view.show(robot, options);
    if (view.panel.details) view.panel.details.open = details?.open ?? false;
    view.panel.sliders.find(({ coordinate }) => coordinate.label === label)?.input.focus();
  }

  fill(mesh, facts) {
    const { view, panels, connection, playing } = this;
    this.moveTab = new MoveTab(view.panel, connection, { saves: facts.saves, before: this.moveTab });
    this.playTab = new PlayTab(panels.Play, playing, connection, this.playTab);
    this.showTab = view.scene && new ShowTab(panels.Show, view, { mesh, dependent: facts.dependent.flat(), before: this.showTab });
    this.robotTab = new RobotTab(panels.Robot, facts);
    this.limitsTab = new LimitsTab(panels.Limits);
    showGraph(panels.Graph, facts.graph);
  }

  /** A robot without controls. */
  useOther({ robot: number, urdf, description, meshes, xyz, q }) {
    const robot = this.read(urdf, description);
    const { viewport } = this.view;
    if (!robot || !viewport) return;
    const session = new Session(robot, q);
    session.show(q, "server");
    const scene = new RobotScene(session, fetched(meshes));
    scene.position.set(...xyz);
    viewport.scene.remove(this.robots.get(number)?.scene);
    viewport.scene.add(scene);
    this.robots.set(number, { session, scene });
    scene.loaded.then(() => viewport.draw(true));
    viewport.draw(true);
  }

  /** A robot from its files; what is wrong with them is shown. */
  read(urdf, description) {
    const file = (name, text) => (text === null ? null : { name, text });
    const { robot, diagnostics } = read({ urdf: file("robot.urdf", urdf), description: file("robot.yaml", description) });
    if (!robot) this.say(`The robot cannot be read: ${diagnostics.find(({ severity }) => severity === "error").message}`, true);
    return robot;
  }

  /** Where the server has a robot. */
  show(number, q) {
    if (number === 0 && !this.playing.moved) this.view.session.show(q, "server");
    const other = this.robots.get(number);
    if (!other) return;
    other.session.show(q, "server");
    other.scene.place();
    this.view.viewport.draw(true);
  }

  /** Tell the server soon where the robot is. */
  tell() {
    this.waiting ??= setTimeout(() => {
      this.waiting = undefined;
      this.connection.send("moved", { version: this.version, q: this.view.session.q });
    }, SOON);
  }

  say(text, isError = false) {
    this.message.textContent = text;
    this.message.classList.toggle("eu-live-problem", isError);
  }

  key(event) {
    if (event.key === "." && event.target === this.view.canvas) this.playing.step();
  }
}

/** Meshes by their names in the URDF, from their addresses. */
function fetched(addresses) {
  return async (name) => {
    if (!Object.hasOwn(addresses, name)) throw new Error("there is no such file");
    const answer = await fetch(addresses[name]);
    if (!answer.ok) throw new Error(`the server has no such file (${answer.status})`);
    return answer.arrayBuffer();
  };
}

globalThis.page = new LivePage();
