// A page that takes the files of a robot: it checks them, moves the robot, and gives it back.

import { openLoops } from "../src/closing.js";
import { Checker } from "./drop/checker.js";
import { withConfiguration } from "./drop/configuration_text.js";
import { showFacts } from "./drop/facts.js";
import { chosenFiles, droppedFiles } from "./drop/files.js";
import { decodeLink, encodeLink } from "./drop/link.js";
import { OpenLoops, showOpen } from "./drop/open_loops.js";
import { findResource, nameOf } from "./drop/paths.js";
import { showDiagnostics } from "./drop/report.js";
import { pictureOf, save } from "./drop/saving.js";
import { robotToShow } from "./drop/shown.js";
import { button, element } from "./elements.js";
import { View } from "./view.js";

const MOST_MESH_BYTES = 200_000_000;

const TOO_LARGE = "It is checked, but too large to be moved in a browser: use eurdf view.";

const at = (id) => document.getElementById(id);

class DropPage {
  constructor() {
    this.checker = new Checker();
    this.changed = new Set(); // paths of the files that were changed here
    this.turn = 0; // counts what was opened: an answer about an earlier robot is ignored
    this.addWelcome();
    this.addActions();
    at("chooser")
      .querySelector("select")
      .addEventListener("change", ({ target }) => this.check(this.robots[target.value]));
    addEventListener("dragover", (event) => event.preventDefault());
    addEventListener("dragenter", () => document.body.classList.add("drop-over"));
    addEventListener("dragleave", ({ relatedTarget }) => relatedTarget ?? document.body.classList.remove("drop-over"));
    addEventListener("drop", (event) => {
      event.preventDefault();
      document.body.classList.remove("drop-over");
      this.open(droppedFiles(event.dataTransfer).then((files) => ({ files })));
    });
    addEventListener("hashchange", () => this.openLink());
    this.openLink();
  }

  addWelcome() {
    const folder = this.input({ webkitdirectory: "" });
    const files = this.input({ multiple: "" });
    button(at("choose"), "Choose a folder", () => folder.click());
    button(at("choose"), "Choose files", () => files.click());
    const examples = JSON.parse(at("robots")?.textContent ?? "[]");
    for (const { title, picture, description, urdf } of examples) {
      const open = () => this.open(Promise.resolve({ files: filesOf({ description, urdf }) }));
      const card = button(element(at("examples"), "li"), "", open);
      if (picture) element(card, "img", { src: picture, alt: "", loading: "lazy" });
      element(card, "span", {}, title);
    }
  }

  input(attributes) {
    const input = element(document.body, "input", { type: "file", hidden: "", ...attributes });
    input.addEventListener("change", () => {
      this.open((async () => ({ files: chosenFiles(input.files) }))());
      input.value = ""; // else the same choice again is no change
    });
    return input;
  }

  addActions() {
    const actions = at("actions");
    button(actions, "Open another", () => this.showWelcome());
    this.actions = {
      yaml: button(actions, "Download YAML", () =>
        save(this.description.text, nameOf(this.robot.description), "application/yaml"),
      ),
      link: button(actions, "Copy link", () => this.attempt(() => this.copyLink())),
      picture: button(actions, "Save picture", () => this.attempt(() => this.savePicture())),
    };
    this.showActions();
  }

  /** Show either what opens a robot, or the robot that is open. */
  showWelcome(on = true) {
    document.body.classList.toggle("drop-opened", !on);
    at("welcome").hidden = !on;
    at("robot").hidden = on;
    if (!on) return;
    this.turn += 1;
    this.say("");
    document.title = "Check and move a robot · Extended URDF";
    history.replaceState(null, "", location.pathname + location.search);
  }

  showActions() {
    this.actions.yaml.disabled = !this.description;
    this.actions.yaml.classList.toggle("drop-main", this.changed.has(this.robot?.description));
    this.actions.link.disabled = !this.urdf;
    this.actions.picture.disabled = !this.view?.viewport;
  }

  /** Do something; what goes wrong is shown. */
  async attempt(task) {
    const turn = this.turn;
    this.say("");
    try {
      await task();
    } catch (error) {
      if (turn === this.turn) this.say(sentence(error.message));
    }
  }

  say(message, busy = false) {
    at("message").textContent = message;
    at("message").classList.toggle("drop-busy", busy);
  }

  openLink() {
    if (location.hash === this.link || location.hash.length < 2) return;
    this.open(decodeLink(location.hash).then((texts) => texts && { files: filesOf(texts), q: texts.q }));
  }

  /** Open a promise of {files, q}: the first robot of the files, at a configuration if there is one. */
  open(promise) {
    this.turn += 1;
    return this.attempt(async () => {
      this.say("Reading…", true);
      const { files, q } = (await promise) ?? {};
      if (!files) return this.say("");
      const { robots, packages } = await this.checker.ask("survey", files);
      if (!robots.length) throw new Error(whyNone(files));
      Object.assign(this, { files, robots, packages, changed: new Set() });
      const chooser = at("chooser");
      chooser.hidden = robots.length < 2;
      chooser
        .querySelector("select")
        .replaceChildren(...robots.map(({ description, urdf }, index) => new Option(description ?? urdf, index)));
      if (location.hash && location.hash !== this.link)
        history.replaceState(null, "", location.pathname + location.search);
      await this.checkNow(robots[0], q);
    });
  }

  check(robot, q) {
    this.turn += 1;
    return this.attempt(() => this.checkNow(robot, q));
  }

  /** Check a robot of the files and show it, at q if it is given. */
  async checkNow(robot, q) {
    const turn = this.turn;
    this.say("Checking…", true);
    this.robot = robot;
    this.clear();
    const file = (path) => path && { path, file: this.files.get(path) ?? null };
    const given = { description: file(robot.description), urdf: file(robot.urdf), packages: this.packages };
    const found = await this.checker.ask("check", { ...given, paths: new Set(this.files.keys()) });
    if (turn !== this.turn) return;
    Object.assign(this, { description: found.description, urdf: found.urdf });
    if (found.description && !robot.description) {
      robot.description = found.description.name; // made for the loops of another dialect
      this.write(found.description.text);
    }
    this.showWelcome(false);
    this.showCheck(found, [robot.note, ...found.notes].filter(Boolean));
    this.say("");
    this.showActions();
    if (!found.shows) return;
    this.say("Closing the loops…", true);
    const analysed = found.isLarge ? null : await this.checker.ask("analyse");
    if (turn !== this.turn) return;
    this.say("");
    if (analysed) this.showRobot(found, analysed, q);
    else element(at("notes"), "p", { class: "drop-note" }, TOO_LARGE);
  }

  clear() {
    this.view?.viewport?.renderer.forceContextLoss();
    this.view = this.description = this.urdf = null;
    for (const id of ["name", "verdict", "notes", "facts", "loops", "diagnostics", "view"]) at(id).replaceChildren();
    this.showActions();
  }

  showCheck({ name, diagnostics }, notes) {
    at("name").textContent = name ?? nameOf(this.robot.description ?? this.robot.urdf);
    document.title = `${at("name").textContent} · Extended URDF`;
    const count = (severity) => diagnostics.filter((each) => each.severity === severity).length;
    const [errors, warnings] = [count("error"), count("warning")];
    const verdict = at("verdict");
    verdict.textContent = [errors ? plural(errors, "error") : "Valid", warnings && plural(warnings, "warning")]
      .filter(Boolean)
      .join(", ");
    verdict.dataset.verdict = errors ? "invalid" : "valid";
    for (const note of notes) element(at("notes"), "p", { class: "drop-note" }, note);
    const bySeverity = ["error", "warning"].flatMap((severity) =>
      diagnostics.filter((each) => each.severity === severity),
    );
    showDiagnostics(at("diagnostics"), bySeverity, (fix) => this.fix(fix));
  }

  /** The robot at the configuration of the file, or closed; at q, if it is given. */
  showRobot({ shows, description, urdf }, { q: closed, stated, analysis }, q) {
    const robot = robotToShow(shows, { description, urdf });
    for (const link of robot.links.values())
      link.shapes = link.shapes.filter(({ type, file }) => type !== "mesh" || this.meshFile(file));
    if (shows === "robot") showFacts(at("facts"), robot, analysis);
    const root = element(at("view"), "div", { class: "eu-live" });
    const start = q && isOf(q, closed) ? q : (stated ?? closed);
    this.view = new View(root, robot, { q: start, keep: true, mesh: (uri) => this.mesh(uri) });
    root.view = this.view;
    const { session, viewport } = this.view;
    session.assemble = () => this.attempt(() => this.assemble(session));
    if (viewport) new OpenLoops(viewport, session);
    // Only what the file lacks: an assembled configuration, or one that is closed.
    const isOpen = !stated || openLoops(session.mechanism, stated).length > 0;
    const canWrite = shows === "robot" && description && robot.version !== "1" && robot.closures.length && isOpen;
    const actions = { assemble: () => session.assemble(), write: canWrite ? () => this.writePose() : null };
    const show = () => showOpen(at("loops"), session, actions);
    session.addEventListener("change", show);
    show();
    this.showActions();
  }

  /** Close the loops away from the page: a search can take seconds. */
  async assemble(session) {
    if (this.checker.open) return;
    this.say("Closing the loops…", true);
    const { q, closes } = await this.checker.ask("assembleFrom", session.q);
    this.say(closes ? "" : "No configuration was found that closes all loops; this is the least open one.");
    session.begin();
    session.show(q, "assemble");
  }

  /** The file of the mesh that a URDF names, or undefined. */
  meshFile(uri) {
    return this.files.get(findResource(uri, this.robot.urdf, (path) => this.files.has(path), this.packages));
  }

  /** Its content. */
  async mesh(uri) {
    const file = this.meshFile(uri);
    if (file.size > MOST_MESH_BYTES) throw new Error(`it has more than ${MOST_MESH_BYTES} bytes`);
    return file.arrayBuffer();
  }

  /** Write the pose as the configuration `assembled`, and check the result. */
  writePose() {
    const { q, mechanism } = this.view.session;
    this.write(withConfiguration(this.description.text, "assembled", q, mechanism.neutral()));
    this.check(this.robot, q);
  }

  fix({ file, text }) {
    const { description, urdf } = this.robot;
    this.write(text, file === this.description?.name ? description : urdf);
    this.check(this.robot, this.view?.session.q);
  }

  write(text, path = this.robot.description) {
    this.files.set(path, new File([text], nameOf(path)));
    this.changed.add(path);
  }

  async copyLink() {
    const { description, urdf } = this;
    const q = this.view?.session.q;
    this.link = await encodeLink({ description, urdf, q });
    history.replaceState(null, "", this.link);
    const hasMeshes =
      this.view &&
      [...this.view.session.robot.links.values()].some(({ shapes }) => shapes.some(({ type }) => type === "mesh"));
    const meshes = hasMeshes ? " It does not contain the meshes." : "";
    const length = ` It has ${location.href.length} characters.`;
    try {
      await navigator.clipboard.writeText(location.href);
      this.say(`The link is in the clipboard.${meshes}${length}`);
    } catch {
      this.say(`The address of this page is the link: copy it.${meshes}${length}`);
    }
  }

  async savePicture() {
    save(await pictureOf(this.view.viewport), `${this.view.session.robot.name}.png`, "image/png");
  }
}

/** Two texts as files. */
function filesOf({ description, urdf }) {
  const texts = [description, urdf].filter(Boolean);
  return new Map(texts.map(({ name, text }) => [name, new File([text], nameOf(name))]));
}

/** Whether a configuration, which may be from a link, is one of a robot. */
const isOf = (q, other) =>
  Object.entries(other).every(
    ([joint, own]) => Array.isArray(q[joint]) && q[joint].length === own.length && q[joint].every(Number.isFinite),
  );

function whyNone(files) {
  const names = [...files.keys()].filter((path) => nameOf(path) !== "package.xml");
  const some = (ending) => names.find((path) => path.toLowerCase().endsWith(ending));
  const xacro = some(".xacro");
  if (xacro) return `there is no URDF; expand the xacro first: xacro ${nameOf(xacro)} > robot.urdf`;
  const other = some(".sdf") ?? some(".xml");
  if (other) return `there is no URDF; convert ${nameOf(other)} first: eurdf import ${nameOf(other)} -o robot`;
  if (!files.size) return "nothing was dropped";
  const count = plural(files.size, "file");
  return `there is no URDF and no description among the ${count}; drop the folder that contains them`;
}

const plural = (count, word) => `${count} ${word}${count === 1 ? "" : "s"}`;

const sentence = (text) => `${text[0]?.toUpperCase() ?? ""}${text.slice(1)}${text.endsWith(".") ? "" : "."}`;

new DropPage();
