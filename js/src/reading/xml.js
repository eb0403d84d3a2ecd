// XML 1.0 with namespaces and without a document type, EU-URD-001 and -002, on top of the npm package `saxes`, within
// bounds of EU-FIL-002. An element is {name, attributes: Map, children}. Text is left out: a URDF has none.

import { SaxesParser } from "saxes";
import { Invalid, fail } from "./invalid.js";
import { OUTERMOST, namespacesIn } from "./namespaces.js";

const MOST_MARKS = 1_000_000;
const MOST_LEVELS = 256;
const MOST_VALUE_BYTES = 10_000_000;

/** The root element. */
export function parseXml(text) {
  checkMarks(text);
  const parser = new SaxesParser({ xmlns: false, position: false, defaultXMLVersion: "1.0", forceXMLVersion: true });
  const top = { children: [] };
  const open = [top];
  const namespaces = [OUTERMOST];
  parser.on("error", (error) => fail(`urdf: ${error.message}`));
  parser.on("doctype", () => fail("urdf: a document type declaration is not allowed"));
  parser.on("xmldecl", ({ encoding }) => {
    if (encoding !== undefined && encoding.toUpperCase() !== "UTF-8")
      fail(`urdf: the encoding ${encoding} is not UTF-8`);
  });
  parser.on("opentag", ({ name, attributes }) => {
    if (open.length > MOST_LEVELS) fail(`urdf: elements are nested deeper than ${MOST_LEVELS}`);
    const element = { name, attributes: new Map(Object.entries(attributes)), children: [] };
    element.attributes.forEach(checkLength);
    namespaces.push(namespacesIn(element, namespaces.at(-1)));
    open.at(-1).children.push(element);
    open.push(element);
  });
  parser.on("closetag", () => {
    open.pop();
    namespaces.pop();
  });
  parser.on("processinginstruction", ({ target }) => {
    if (target.includes(":")) fail(`urdf: the target ${target} of an instruction has a colon`);
  });
  try {
    parser.write(text).close();
  } catch (error) {
    if (error instanceof Invalid) throw error;
    fail(`urdf: ${error.message}`);
  }
  return top.children[0];
}

function checkMarks(text) {
  let marks = 0;
  for (const character of ["<", "="]) {
    for (let i = text.indexOf(character); i >= 0; i = text.indexOf(character, i + 1)) marks += 1;
  }
  if (marks > MOST_MARKS) fail(`urdf: there are more than ${MOST_MARKS} of the characters < and =`);
}

function checkLength(value, name) {
  if (value.length * 3 <= MOST_VALUE_BYTES) return;
  if (Buffer.byteLength(value) > MOST_VALUE_BYTES)
    fail(`urdf: the value of ${name} has more than ${MOST_VALUE_BYTES} bytes`);
}
