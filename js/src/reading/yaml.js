// YAML 1.2 with the core schema, EU-YML-001 to -012, on top of the npm package `yaml`, which accepts more.
// A mapping is a Map, a list an Array, a scalar a string, number, boolean or null.

import { Composer, Parser, isAlias, isMap, isScalar, isSeq } from "yaml";
import { fail } from "./invalid.js";

const MOST_NODES = 100_000;
const MOST_TAGS = 64;
const MOST_LEVELS = 64;

const CORE = "tag:yaml.org,2002:";
const NULL = /^(null|Null|NULL|~|)$/;
const BOOLEAN = /^(true|True|TRUE|false|False|FALSE)$/;
const INTEGER = /^([-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+)$/;
const FLOAT = /^[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?$/;
const NOT_FINITE = /^([-+]?(\.inf|\.Inf|\.INF)|\.nan|\.NaN|\.NAN)$/;

// Characters that YAML allows nowhere, and those that it allows inside quotes alone.
const FORBIDDEN = /[\0-\x08\x0B\x0C\x0E-\x1F]/;
const ONLY_QUOTED = /[\x7F-\x84\x86-\x9F\uFEFF\uFFFE\uFFFF]/;

/** The one mapping of a description. */
export function parseYaml(text) {
  if (FORBIDDEN.test(text)) fail("yaml: the text contains a control character");
  text = text.replaceAll(/\r\n?/g, "\n"); // `yaml` does not end a line at a lone carriage return
  const tokens = [...new Parser().parse(text)];
  checkDirectives(tokens);
  checkEnd(tokens);
  tokens.forEach(checkDepth);
  const documents = [...new Composer({ schema: "failsafe", uniqueKeys: false, logLevel: "silent" }).compose(tokens)];
  if (documents.length > 1) fail("yaml: the file contains more than one document");
  const [document] = documents;
  if (!document || isEmpty(document.contents)) fail("yaml: the file is empty; a description is a mapping");
  if (document.errors.length) fail(`yaml: ${document.errors[0].message}`);
  const value = new Reader(text).read(document.contents);
  if (!(value instanceof Map)) fail("yaml: a description is a mapping");
  return value;
}

function isEmpty(node) {
  return node === null || (isScalar(node) && node.type === "PLAIN" && node.source === "" && !node.tag);
}

function checkDirectives(tokens) {
  const directives = tokens.filter((token) => token.type === "directive").map((token) => token.source);
  const versions = directives.filter((line) => /^%YAML(\s|$)/.test(line));
  if (versions.length > 1) fail("yaml: there is more than one %YAML directive");
  if (versions.some((line) => !/^%YAML[ \t]+1\.2([ \t]+#.*|[ \t]*)$/.test(line)))
    fail("yaml: the version of YAML is 1.2");
  const tags = directives.filter((line) => /^%TAG(\s|$)/.test(line));
  if (tags.length > MOST_TAGS) fail(`yaml: there are more than ${MOST_TAGS} %TAG directives`);
  const handles = tags.map((line) => line.split(/[ \t]+/)[1]);
  if (new Set(handles).size !== handles.length) fail("yaml: two %TAG directives name the same handle");
}

/** What follows `...`, except comments, begins another document, EU-YML-003. */
function checkEnd(tokens) {
  const end = tokens.findIndex((token) => token.type === "doc-end");
  if (end < 0) return;
  const silent = ["doc-end", "comment", "newline", "space"];
  if (tokens.slice(end).some((token) => !silent.includes(token.type))) fail("yaml: something follows the line ...");
}

/** Without recursion, because the composer recurses: it overflows the stack on deep nesting. */
function checkDepth(document) {
  const open = [[document, 0]];
  while (open.length) {
    const [token, depth] = open.pop();
    if (!token || typeof token !== "object") continue;
    const below = token.items ? depth + 1 : depth;
    if (below > MOST_LEVELS) tooDeep();
    if (token.value && typeof token.value === "object") open.push([token.value, below]);
    for (const item of token.items ?? []) open.push([item.key, below], [item.value, below]);
  }
}

function tooDeep() {
  fail(`yaml: mappings and lists are nested deeper than ${MOST_LEVELS} levels`);
}

class Reader {
  constructor(text) {
    this.text = text;
    this.anchors = new Map(); // name → {value, size, height}, or null inside its own node
    this.nodes = 0;
    this.copies = 0;
    this.quoted = [];
  }

  /** The value of the top-level node. */
  read(node) {
    const { value } = this.visit(node, 1);
    let start = 0;
    for (const [from, to] of [...this.quoted, [this.text.length, this.text.length]]) {
      if (ONLY_QUOTED.test(this.text.slice(start, from))) fail("yaml: the text contains a character that YAML forbids");
      start = to;
    }
    return value;
  }

  /** `{value, size, height}` of a node on a level: nodes and levels with aliases expanded. */
  visit(node, level) {
    this.nodes += 1;
    if (this.nodes > MOST_NODES) fail(`yaml: a description has at most ${MOST_NODES} nodes`);
    if (node === null || node === undefined) return { value: null, size: 1, height: 0 };
    if (isAlias(node)) return this.copy(node, level);
    if (node.anchor) this.anchors.set(node.anchor, null);
    const seen = isScalar(node) ? { value: this.scalar(node), size: 1, height: 0 } : this.collection(node, level);
    // Unless an inner node has taken the name.
    if (node.anchor && this.owner(node)) this.anchors.set(node.anchor, seen);
    return seen;
  }

  /** Whether the anchor of a node that has been read still marks that node. */
  owner(node) {
    return this.anchors.get(node.anchor) === null;
  }

  copy(alias, level) {
    const marked = this.anchors.get(alias.source);
    if (marked === undefined) fail(`yaml: *${alias.source} has no anchor before it`);
    if (marked === null) fail(`yaml: *${alias.source} is inside the node that it repeats`);
    this.copies += marked.size;
    if (this.copies > MOST_NODES) fail(`yaml: the copies of aliases have more than ${MOST_NODES} nodes`);
    if (level - 1 + marked.height > MOST_LEVELS) tooDeep();
    return marked;
  }

  collection(node, level) {
    if (level > MOST_LEVELS) tooDeep();
    const tag = isMap(node) ? "map" : "seq";
    if (node.tag && node.tag !== CORE + tag && node.tag !== "!")
      fail(`yaml: the tag ${node.tag} does not fit a ${tag}`);
    const inside = { size: 1, height: 0 };
    const add = (child) => {
      const seen = this.visit(child, level + 1);
      inside.size += seen.size;
      inside.height = Math.max(inside.height, seen.height);
      return seen.value;
    };
    const value = isSeq(node) ? node.items.map(add) : this.mapping(node, add);
    return { value, size: inside.size, height: inside.height + 1 };
  }

  mapping(node, add) {
    const value = new Map();
    for (const pair of node.items) {
      const key = add(pair.key);
      if (typeof key !== "string") fail(`yaml: the key ${JSON.stringify(key)} is not a string; put it in quotes`);
      if (value.has(key)) fail(`yaml: the key '${key}' occurs twice in a mapping`);
      value.set(key, add(pair.value));
    }
    return value;
  }

  scalar(node) {
    const text = node.source ?? "";
    const quoted = node.type === "QUOTE_DOUBLE" || node.type === "QUOTE_SINGLE";
    if (quoted) this.quoted.push(node.range.slice(0, 2));
    if (node.type === "QUOTE_DOUBLE") checkEscapes(this.text.slice(...node.range));
    if (node.tag === undefined) return node.type === "PLAIN" ? plain(text) : text;
    return tagged(text, node.tag);
  }
}

function checkEscapes(source) {
  for (const [escape] of source.matchAll(/\\(u[0-9a-fA-F]{4}|U[0-9a-fA-F]{8}|[^])/g)) {
    const code = parseInt(escape.slice(2), 16);
    if (escape.length > 2 && code >= 0xd800 && code <= 0xdfff) fail(`yaml: ${escape} is a surrogate, not a character`);
  }
}

function plain(text) {
  if (NULL.test(text)) return null;
  if (BOOLEAN.test(text)) return text.toLowerCase() === "true";
  if (INTEGER.test(text) || FLOAT.test(text) || NOT_FINITE.test(text)) return finite(text);
  return text;
}

function finite(text) {
  const number = NOT_FINITE.test(text) ? NaN : Number(text);
  if (!Number.isFinite(number)) fail(`yaml: the number ${text} is not finite`);
  return number;
}

function tagged(text, tag) {
  if (tag === "!" || tag === `${CORE}str`) return text;
  if (tag === `${CORE}null` && NULL.test(text)) return null;
  if (tag === `${CORE}bool` && BOOLEAN.test(text)) return text.toLowerCase() === "true";
  if (tag === `${CORE}int` && INTEGER.test(text)) return finite(text);
  if (tag === `${CORE}float` && (FLOAT.test(text) || NOT_FINITE.test(text))) return finite(text);
  fail(`yaml: the tag ${tag} is not one of the core schema, or does not fit '${text}'`);
}
