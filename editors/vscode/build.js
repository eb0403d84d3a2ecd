// The extension as it is packaged: `npm run build` writes dist/ and the licence. The page of robots is that of js/page.

import { copyFile, mkdir, mkdtemp, rm, writeFile } from "node:fs/promises";
import { execFile } from "node:child_process";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { promisify } from "node:util";
import { build } from "esbuild";
import { licencesOf } from "../../js/licences.js";

const HERE = dirname(fileURLToPath(import.meta.url));
const ROOT = join(HERE, "..", "..");
const DIST = join(HERE, "dist");

await rm(DIST, { recursive: true, force: true });
await mkdir(DIST);
const { metafile } = await build({
  entryPoints: [join(HERE, "src", "extension.js")],
  outfile: join(DIST, "extension.cjs"),
  absWorkingDir: HERE,
  bundle: true,
  minify: true,
  metafile: true,
  legalComments: "none",
  platform: "node",
  format: "cjs",
  target: "node18",
  external: ["vscode"],
});
await writeFile(join(DIST, "licenses.txt"), await licencesOf(Object.keys(metafile.inputs), HERE));
const built = await mkdtemp(join(DIST, "js-"));
await promisify(execFile)("node", [join(ROOT, "js", "build.js"), built]);
for (const name of ["page.js", "page.css"]) await copyFile(join(built, "page", name), join(DIST, name));
await rm(built, { recursive: true });
await copyFile(join(ROOT, "LICENSE"), join(HERE, "LICENSE"));
