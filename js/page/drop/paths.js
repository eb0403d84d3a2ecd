// Paths within the dropped files, with "/" between names and without a "/" at the beginning.

/** The folder of a file, with a "/" at its end; "" at the top. */
export const folderOf = (path) => path.slice(0, path.lastIndexOf("/") + 1);

export const nameOf = (path) => path.slice(path.lastIndexOf("/") + 1);

/** A path relative to a folder; null if it leads out of what was dropped. */
export function resolve(folder, path) {
  if (path.startsWith("/")) return null;
  const names = [];
  for (const name of `${folder}${path}`.split("/")) {
    if (name === "..") {
      if (!names.length) return null;
      names.pop();
    } else if (name !== "" && name !== ".") names.push(name);
  }
  return names.join("/");
}

/** The name in the text of a package.xml, or undefined. */
export const packageNameOf = (text) => /<name>\s*([^<>\s]+)\s*<\/name>/.exec(text)?.[1];

/**
 * The path of the file that a URI in a URDF means, or null. `package://name/rest` is looked for in the folders from
 * that of the URDF upwards: each may hold the package, or be it.
 *
 * @param has Whether there is a file with a path.
 * @param packages Map from a folder to the name in its package.xml.
 */
export function findResource(uri, urdf, has, packages) {
  const exists = (path) => (path !== null && has(path) ? path : null);
  const [, scheme, rest] = /^([^:/]*):\/\/(.*)$/s.exec(uri) ?? [];
  if (scheme === undefined) return exists(resolve(folderOf(urdf), uri));
  if (scheme !== "package" && scheme !== "model") return null;
  const slash = rest.indexOf("/");
  if (slash < 0) return null;
  const [name, path] = [rest.slice(0, slash), rest.slice(slash).replace(/^\/+/, "")];
  for (let folder = folderOf(urdf); ; folder = folderOf(folder.slice(0, -1))) {
    const inside = exists(resolve(folder, `${name}/${path}`));
    if (inside !== null) return inside;
    const isPackage = !name || nameOf(folder.slice(0, -1)) === name || packages.get(folder) === name;
    const own = isPackage ? exists(resolve(folder, path)) : null;
    if (own !== null || folder === "") return own;
  }
}
