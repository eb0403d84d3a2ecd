// Bundles for browsers. `npm run build` writes the entries of the package to dist/, for pages without a bundler, and the scripts of the
// page of robots to where `eurdf` reads them; `node build.js FOLDER` writes them to dist/ and page/ in a folder.

import { existsSync } from "node:fs";
import { mkdir, readFile, rm, writeFile } from "node:fs/promises";
import { basename, dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";
import { minify } from "terser";
import { licencesOf } from "./licences.js";

const HERE = dirname(fileURLToPath(import.meta.url));
const [FOLDER] = process.argv.slice(2);
const DIST = join(FOLDER ?? HERE, "dist");
const PAGE = FOLDER ? join(FOLDER, "page") : join(HERE, "..", "reference", "eurdf", "viewing", "page");

/** The files of a folder that exist, as entries of a bundle. */
const entries = (folder, names) => names.map((name) => join(HERE, folder, name)).filter(existsSync);

/** The licences of a bundle in a browser. */
async function licences(inputs) {
  const workers = inputs.filter((file) => /(^|\/)worker\.js$/.test(file)); // in a page as the texts of their own bundles
  const { metafile } = await build({ entryPoints: workers, outdir: HERE, absWorkingDir: HERE, bundle: true, write: false, metafile: true });
  return licencesOf([...inputs, ...Object.keys(metafile.inputs)], HERE);
}

/** Modules of packages that the reader never calls: it writes no YAML and resolves scalars itself; its XML is 1.0 and has no namespaces. */
const NEVER_CALLED = new RegExp(
  [
    String.raw`/yaml/browser/dist/(stringify/|schema/(core|json|yaml-1\.1)/|doc/(createNode|applyReviver)|nodes/(addPairToJSMap|toJS)|visit|parse/cst-visit)`,
    String.raw`/xmlchars/(xml/1\.1|xmlns)/`,
  ].join("|"),
);
const ONLY_WHAT_IS_USED = {
  name: "only what is used",
  setup({ onLoad }) {
    onLoad({ filter: NEVER_CALLED }, async ({ path }) => {
      const exported = (await readFile(path, "utf8")).matchAll(/^export \{(.*)\}/gm);
      const names = [...exported].flatMap(([, each]) => each.match(/\w+/g));
      return { contents: names.map((name) => `export const ${name} = undefined;`).join("\n") || "module.exports = {};" };
    });
  },
};

/** A file worker.js as the text of its bundle: a page starts a worker from text also where it may load no other file. */
const WORKERS = {
  name: "workers",
  setup({ onLoad, initialOptions }) {
    onLoad({ filter: /[\\/]worker\.js$/ }, async ({ path }) => {
      const { outputFiles } = await build({ ...initialOptions, entryPoints: [path], metafile: false, plugins: [] });
      return { contents: outputFiles[0].text, loader: "text" };
    });
  },
};

/** The files {path, text, inputs} of a bundle for a folder, which is emptied. */
async function bundle(entryPoints, outdir, options) {
  const { outputFiles, metafile } = await build({
    entryPoints,
    outdir,
    absWorkingDir: HERE,
    bundle: true,
    minify: true,
    legalComments: "none",
    metafile: true,
    platform: "browser",
    target: "es2022",
    write: false,
    ...options,
  });
  await rm(outdir, { recursive: true, force: true });
  await mkdir(outdir, { recursive: true });
  const outputs = new Map(Object.entries(metafile.outputs).map(([path, { inputs }]) => [basename(path), Object.keys(inputs)]));
  return outputFiles.map(({ path, text }) => ({ path, text, inputs: outputs.get(basename(path)) }));
}

const entriesOfDist = [
  { in: join(HERE, "src", "bundled.js"), out: "extended-urdf" },
  { in: join(HERE, "src", "three.js"), out: "three" },
  { in: join(HERE, "adapter", "answers.js"), out: "answers" }, // to the suite, for a parser in a browser
];
const dist = await bundle(entriesOfDist, DIST, {
  format: "esm",
  splitting: true,
  external: ["three", "three/*"],
  plugins: [ONLY_WHAT_IS_USED],
});
for (const { path, text } of dist) await writeFile(path, (await minify(text, { module: true, ecma: 2020 })).code);
await writeFile(join(DIST, "licenses.txt"), await licences(dist.flatMap(({ inputs }) => inputs)));

// Scripts that are no modules also run in a page that is opened as a file. Each is put into pages, and so contains its licences.
const pages = entries("page", ["page.js", "page.css", "live.js", "live.css", "drop.js", "drop.css"]);
for (const { path, text, inputs } of await bundle(pages, PAGE, { format: "iife", plugins: [WORKERS] })) {
  const comment = await licences(inputs);
  await writeFile(path, comment ? `${text}/*!\n${comment.replaceAll("*/", "* /")}*/\n` : text);
}
