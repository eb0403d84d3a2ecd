// What takes time, away from the page: which robots there are, their check, their closed configuration and mobility.

import { closuresOfDialects, read } from "../../src/index.js";
import { MOST_BYTES } from "../../src/reading/source.js";
import { Mechanism } from "../../src/mechanism.js";
import { analyze, assemble } from "../../src/closing.js";
import { fixesOf } from "./fixes.js";
import { linesAt } from "./lines.js";
import { findResource, folderOf, nameOf, packageNameOf } from "./paths.js";
import { robotsIn } from "./robots.js";
import { robotToShow, whatToShow } from "./shown.js";

const MOST_SHOWN = 1_000_000; // bytes of the two files of a robot that the page reads again and shows
const MOST_VELOCITIES = 300; // that a page moves
const MOST_LINKS = 2000; // that it draws
const LONGEST = 1000; // characters of a sentence that are shown

const TASKS = { survey, check, analyse, assembleFrom };

onmessage = async ({ data: { task, given } }) => {
  try {
    postMessage({ result: await TASKS[task](given) });
  } catch (error) {
    postMessage({ error: error.message });
  }
};

/** The robots among files, and the names of the packages: those of each package.xml, by its folder. */
async function survey(files) {
  const packages = new Map();
  for (const [path, file] of files) {
    if (nameOf(path) !== "package.xml") continue;
    const name = packageNameOf(await file.slice(0, 65536).text());
    if (name) packages.set(folderOf(path), name);
  }
  return { robots: await robotsIn(files), packages };
}

/** What is wrong with a robot of the files, and what can be shown of it. */
async function check({ description, urdf, paths, packages }) {
  const texts = { description: description && (await contentOf(description)), urdf: await contentOf(urdf) };
  const notes = [];
  if (!texts.description && texts.urdf.text) {
    const { description: text, losses } = closuresOfDialects(textOf(texts.urdf), nameOf(urdf.path));
    texts.description = { name: `${folderOf(urdf.path)}robot.yaml`, text };
    notes.push(...losses);
  }
  const files = (uri) => findResource(uri, urdf.path, (path) => paths.has(path), packages) !== null;
  const isLarge = (description?.file?.size ?? 0) + (urdf.file?.size ?? 0) > MOST_SHOWN;
  const shows = whatToShow(texts);
  shown = shows && robotToShow(shows, texts);
  const found = read({ ...texts, files });
  if (shows === "tree") notes.push("This is the tree of the URDF alone, because the description has errors.");
  const byName = new Map(
    [texts.description, texts.urdf].filter((file) => file?.text).map((file) => [file.name, textOf(file)]),
  );
  const fixes = isLarge ? new Map() : fixesOf(found.diagnostics, texts, files);
  const diagnostics = found.diagnostics.map((each) => ({
    ...each,
    message: cut(each.message),
    hint: each.hint && cut(each.hint),
    lines: linesAt(byName.get(each.file), each.line, each.column),
    fix: fixes.get(each) ?? null,
  }));
  const plain = (file) => file?.text && { name: file.name, text: textOf(file) };
  const name = shown && cut(shown.name);
  return {
    name,
    description: plain(texts.description),
    urdf: plain(texts.urdf),
    diagnostics,
    notes: notes.map(cut),
    shows,
    isLarge,
  };
}

let shown = null; // the robot of the last check, if it can be shown
let mechanism = null;

/** A closed configuration, or the least open one; that of the file; the analysis. Null if it is too large to move. */
function analyse() {
  mechanism = new Mechanism(shown);
  if (mechanism.nv > MOST_VELOCITIES || shown.links.size > MOST_LINKS) return null;
  const stated = mechanism.named("assembled") ?? null;
  const { q } = assemble(mechanism, stated ?? undefined);
  return { q, stated, analysis: analyze(mechanism, q) };
}

/** A closed configuration near q, within the position limits if possible. */
function assembleFrom(q) {
  if (!mechanism) throw new Error("the search was ended before; open the robot again");
  const within = assemble(mechanism, q, { limits: true });
  return within.closes ? within : assemble(mechanism, q);
}

const cut = (text) => (text.length > LONGEST ? `${text.slice(0, LONGEST)}…` : text);

/** {name, text: bytes}; a file that is not there has null. */
async function contentOf({ path, file }) {
  // One byte more than a reader accepts, so that it says so.
  return { name: path, text: file && new Uint8Array(await file.slice(0, MOST_BYTES + 1).arrayBuffer()) };
}

/** The text as a person sees it, whatever is wrong with it. */
const textOf = ({ text }) => (typeof text === "string" ? text : new TextDecoder().decode(text));
