// A robot of urdf-loader by its two files.

import { read, urdfOf } from "../reading/robot.js";
import { withClosedLoops } from "./closed_loops.js";

/** Why a robot is not loaded; `diagnostics`: as `read` gives them. */
export class InvalidRobot extends Error {
  constructor(diagnostics) {
    const errors = diagnostics.filter(({ severity }) => severity === "error");
    super(errors.map(({ file, line, column, message }) => `${[file, line, column].filter(Boolean).join(":")}: ${message}`).join("\n"));
    this.name = "InvalidRobot";
    this.diagnostics = diagnostics;
  }
}

/**
 * Loads a robot by its description, which names its URDF, or by its URDF.
 *
 * @param url Of a description (.yaml or .yml), or of a URDF.
 * @param options.loader A URDFLoader of the package urdf-loader; its options hold: packages, loadMeshCb, fetchOptions, …
 * @param options.description The URL of the description of a URDF; without it, a URDF has no loops.
 * @returns A promise of the URDFRobot of the loader, with what `withClosedLoops` adds, and `diagnostics`. It rejects with
 *   `InvalidRobot`, or with an `Error` if a file cannot be fetched.
 */
export async function loadExtendedURDF(url, { loader, description } = {}) {
  if (!loader) throw new TypeError("the option loader is missing; give it a URDFLoader of the package urdf-loader");
  const fromDescription = description === undefined && /\.ya?ml$/i.test(pathOf(url));
  const texts = { description: null };
  if (description ?? fromDescription) texts.description = await fetched(description ?? url, loader);
  const urdf = fromDescription ? new URL(urdfOf(texts.description), absolute(url)).href : url;
  texts.urdf = await fetched(urdf, loader);
  const { robot, diagnostics } = read(texts);
  if (!robot) throw new InvalidRobot(diagnostics);
  const { workingPath } = loader;
  loader.workingPath ||= new URL(".", absolute(urdf)).href;
  try {
    return Object.assign(withClosedLoops(loader.parse(textOf(texts.urdf)), robot), { diagnostics });
  } finally {
    loader.workingPath = workingPath;
  }
}

const absolute = (url) => new URL(url, globalThis.location?.href);
const pathOf = (url) => absolute(url).pathname;
const textOf = ({ text }) => new TextDecoder().decode(text);

async function fetched(url, { fetchOptions }) {
  const response = await fetch(url, fetchOptions);
  if (!response.ok) throw new Error(`'${url}' cannot be fetched: status ${response.status}`);
  const name = decodeURIComponent(pathOf(url).split("/").at(-1));
  return { name, text: new Uint8Array(await response.arrayBuffer()) };
}
