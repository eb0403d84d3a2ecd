// The files that a person drops or chooses: a Map from path, relative to what was dropped, to File.

const MOST_FILES = 10_000;
const MOST_LEVELS = 32;

/** The files of a drop, with those in its folders. Throws `Error` if there are too many. */
export async function droppedFiles({ items, files }) {
  // Entries are gone after the first wait.
  const entries = [...items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
  if (!entries.length) return chosenFiles(files);
  const found = new Map();
  for (const entry of entries) await gather(entry, "", found, 0);
  return found;
}

/** The files of an `<input type=file>`, with or without `webkitdirectory`. */
export function chosenFiles(files) {
  const found = new Map();
  for (const file of files) add(found, file.webkitRelativePath || file.name, file);
  return found;
}

async function gather(entry, folder, found, level) {
  if (entry.name.startsWith(".")) return; // .git and others, which no robot names
  const path = `${folder}${entry.name}`;
  if (entry.isFile) {
    add(found, path, await new Promise((done, failed) => entry.file(done, failed)));
    return;
  }
  if (level === MOST_LEVELS)
    throw new Error(`folders are nested deeper than ${MOST_LEVELS}; drop the folder of one robot`);
  const reader = entry.createReader();
  for (;;) {
    // A call returns some of the entries; the last one returns none.
    const some = await new Promise((done, failed) => reader.readEntries(done, failed));
    if (!some.length) return;
    for (const each of some) await gather(each, `${path}/`, found, level + 1);
  }
}

function add(found, path, file) {
  if (found.size === MOST_FILES)
    throw new Error(`there are more than ${MOST_FILES} files; drop the folder of one robot`);
  found.set(path, file);
}
