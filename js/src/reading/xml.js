// XML 1.0 with namespaces and without a document type, EU-URD-001 and -002, on top of the npm package `saxes`, within
// bounds of EU-FIL-002. An element is {name, attributes: Map, children, source, offset, offsets: Map}: it is the place
// of its `<`, and `offsets` are those of the values of its attributes. Text is left out: a URDF has none.

import { SaxesParser } from "saxes";
import { OUTERMOST, namespacesIn } from "./namespaces.js";

const MOST_MARKS = 1_000_000;
const MOST_LEVELS = 256;
const MOST_VALUE_BYTES = 10_000_000;

// Shared, because a file may have a million elements.
const NO_ATTRIBUTES = new Map();
const NO_CHILDREN = [];

/** Stops the parser. */
class Stop extends Error {}

/** The place of the value of an attribute. */
export const valueOf = ({ source, offsets }, name) => source.at(offsets.get(name));

/** The root element, or null after an error. */
export function parseXml(source, diagnostics) {
  const { text } = source;
  const stop = (code, place, message, hint) => {
    diagnostics.report(code, place, message, hint);
    throw new Stop();
  };
  const parser = new SaxesParser({ xmlns: false, position: false, defaultXMLVersion: "1.0", forceXMLVersion: true });
  const top = { children: [] };
  const open = [top];
  const namespaces = [OUTERMOST];
  let passed = 0; // where the last comment or instruction ended
  let offset; // of the tag that is read
  let offsets;
  const reached = () => source.at(Math.max(0, Math.min(parser.position, text.length) - 1));
  const wrong = (message) => stop("xml-syntax", reached(), `the text is not XML: ${message.replace(/\.$/, "")}`);
  const pass = () => {
    passed = parser.position;
  };
  parser.on("error", ({ message }) => {
    const last = open.at(-1);
    if (last === top || parser.position < text.length) wrong(message);
    stop("xml-syntax", last, `<${last.name}> is never closed`, `write </${last.name}> where it ends`);
  });
  parser.on("doctype", () => {
    const place = source.at(text.indexOf("<!DOCTYPE", passed));
    stop("xml-doctype", place, "the file has a document type declaration", "remove it");
  });
  parser.on("comment", pass);
  parser.on("xmldecl", ({ encoding }) => {
    pass();
    if (encoding === undefined || encoding.toUpperCase() === "UTF-8") return;
    const place = source.at(text.slice(0, passed).search(/(?<=encoding\s*=\s*["'])/));
    stop(
      "file-not-utf8",
      place,
      `the encoding is ${encoding}, not UTF-8`,
      "save the file as UTF-8, and name that here",
    );
  });
  parser.on("opentagstart", () => {
    offset = text.lastIndexOf("<", parser.position - 1);
    offsets = NO_ATTRIBUTES;
  });
  parser.on("attribute", ({ name }) => {
    const end = parser.position - 1; // the closing quote
    if (offsets === NO_ATTRIBUTES) offsets = new Map();
    offsets.set(name, text.lastIndexOf(text[end], end - 1) + 1);
  });
  parser.on("opentag", ({ name, attributes }) => {
    const stated = offsets === NO_ATTRIBUTES ? NO_ATTRIBUTES : new Map(Object.entries(attributes));
    const element = { name, attributes: stated, children: NO_CHILDREN, source, offset, offsets };
    if (open.length > MOST_LEVELS) stop("file-too-large", element, `elements are nested deeper than ${MOST_LEVELS}`);
    for (const [key, value] of element.attributes) {
      if (!isTooLong(value)) continue;
      stop("file-too-large", source.whole, `the value of ${key} has more than ${MOST_VALUE_BYTES} bytes`);
    }
    namespaces.push(namespacesIn(element, namespaces.at(-1), wrong));
    const around = open.at(-1);
    if (around.children === NO_CHILDREN) around.children = [element];
    else around.children.push(element);
    open.push(element);
  });
  parser.on("closetag", () => {
    open.pop();
    namespaces.pop();
  });
  parser.on("processinginstruction", ({ target }) => {
    pass();
    if (target.includes(":")) wrong(`the target ${target} of an instruction has a colon`);
  });
  try {
    if (marksIn(text) > MOST_MARKS) {
      stop("file-too-large", source.whole, `there are more than ${MOST_MARKS} of the characters < and =`);
    }
    parser.write(text).close();
  } catch (error) {
    if (error instanceof Stop) return null;
    throw error;
  }
  return top.children[0];
}

function marksIn(text) {
  let marks = 0;
  for (const character of ["<", "="]) {
    for (let i = text.indexOf(character); i >= 0; i = text.indexOf(character, i + 1)) marks += 1;
  }
  return marks;
}

function isTooLong(value) {
  return value.length * 3 > MOST_VALUE_BYTES && new TextEncoder().encode(value).length > MOST_VALUE_BYTES;
}
