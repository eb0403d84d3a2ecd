// The licences of the packages in a bundle, which have to be where its code is.

import { readdir, readFile } from "node:fs/promises";
import { join } from "node:path";

/** Their texts, for the inputs of a bundle as esbuild names them: relative to a folder. */
export async function licencesOf(inputs, folder) {
  const packages = inputs.map((file) => /^(?:.*\/)?node_modules\/(?:@[^/]+\/)?[^/]+/.exec(file)?.[0]).filter(Boolean);
  const texts = [...new Set(packages)].sort().map(async (path) => {
    const { name, version, license } = JSON.parse(await readFile(join(folder, path, "package.json"), "utf8"));
    const file = (await readdir(join(folder, path))).find((each) => /^licen[cs]e/i.test(each));
    const text = file ? await readFile(join(folder, path, file), "utf8") : `License: ${license}\n`;
    return `${name} ${version}\n\n${text.trim()}\n`;
  });
  return (await Promise.all(texts)).join("\n---\n\n");
}
