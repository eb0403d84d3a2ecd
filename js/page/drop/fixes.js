// Fixes that are certain: a name that a hint proposes, if a trial shows that the diagnostic is gone, that there is no
// new one, and that the actuators still move independently.

import { read } from "../../src/index.js";
import { Mechanism } from "../../src/mechanism.js";
import { analyze } from "../../src/closing.js";

const MOST = 20; // diagnostics that fixes are tried for
const LONGEST = 3000; // ms that trials take

/** Map from a diagnostic to its fix: {summary, file, text}, the whole text of the file with the fix. */
export function fixesOf(diagnostics, texts, files) {
  const fixes = new Map();
  const end = performance.now() + LONGEST;
  for (const diagnostic of diagnostics.slice(0, MOST)) {
    if (performance.now() > end) break;
    const right = candidates(diagnostic, texts).filter(({ file, text }) =>
      mends(diagnostic, diagnostics, texts, files, file, text),
    );
    if (right.length === 1) fixes.set(diagnostic, right[0]);
  }
  return fixes;
}

/** Each name in quotes in the hint, in the place of the word that is wrong. */
function candidates({ file, line, column, hint }, { description, urdf }) {
  const source = [description, urdf].find((each) => each?.name === file);
  if (!source || line === null || !hint) return [];
  const text = typeof source.text === "string" ? source.text : new TextDecoder().decode(source.text);
  const start = offsetOf(text, line, column);
  const word = /^(["']?)([^\s,:[\]{}"'<>=/]+)\1/.exec(text.slice(start));
  if (!word) return [];
  const names = [...hint.matchAll(/'([^']+)'|“([^”]+)”/g)].map((found) => found[1] ?? found[2]);
  return [...new Set(names)]
    .filter((name) => name !== word[2] && /^[\w.-]+$/.test(name))
    .map((name) => {
      const fixed = word[1] + name + word[1];
      return {
        summary: `write ${name}`,
        file,
        text: text.slice(0, start) + fixed + text.slice(start + word[0].length),
      };
    });
}

function offsetOf(text, line, column) {
  let start = 0;
  for (const end of text.matchAll(/\r\n|\r|\n/g)) {
    if (line <= 1) break;
    line -= 1;
    start = end.index + end[0].length;
  }
  return start + [...text.slice(start, start + 4 * column)].slice(0, column - 1).join("").length;
}

function mends(diagnostic, before, texts, files, file, text) {
  const changed = (each) => (each?.name === file ? { name: file, text } : each);
  const { robot, diagnostics } = read({ description: changed(texts.description), urdf: changed(texts.urdf), files });
  const key = ({ code, file: own, line, column }) => `${code} ${own} ${line} ${column}`;
  const keys = new Set(before.filter((each) => each !== diagnostic).map(key));
  if (!diagnostics.every((each) => keys.has(key(each)))) return false;
  if (!robot) return true;
  const mechanism = new Mechanism(robot);
  return !analyze(mechanism, mechanism.named("assembled") ?? mechanism.neutral()).dependentActuators?.length;
}
