// Bundles for browsers: `node build.js [FOLDER]` writes them to dist/, or into a folder.

import { build } from "esbuild";

await build({
  entryPoints: { "extended-urdf": "src/index.js" },
  outdir: process.argv[2] ?? "dist",
  bundle: true,
  format: "esm",
  platform: "browser",
  minify: true,
  external: ["node:*"],
});
