// YAML 1.2 with the core schema, EU-YML-001 to -012, on top of the npm package `yaml`, which accepts more.

import { Composer, Parser, isAlias, isMap, isScalar, isSeq } from "yaml";
import { Source } from "./source.js";

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

const OPTIONS = {
  schema: "failsafe",
  resolveKnownTags: false,
  uniqueKeys: false,
  keepSourceTokens: true,
  logLevel: "silent",
};

/** A value and its place. */
export class Node {
  /** `content`: a Map from keys to {key: Node, value: Node}, an Array of nodes, or a scalar. */
  constructor(source, offset, content) {
    this.source = source;
    this.offset = offset;
    this.content = content;
  }

  get isMapping() {
    return this.content instanceof Map;
  }

  get isList() {
    return Array.isArray(this.content);
  }

  has(key) {
    return this.content.has(key);
  }

  /** The value of a key, or the item with an index; undefined if there is none. */
  get(key) {
    return this.isList ? this.content[key] : this.content.get(key)?.value;
  }

  /** The place of a key. */
  key(key) {
    return this.content.get(key).key;
  }

  /** The value without places: a Map, an Array, or a scalar. */
  plain() {
    if (this.isList) return this.content.map((item) => item.plain());
    return this.isMapping ? new Map([...this.content].map(([key, { value }]) => [key, value.plain()])) : this.content;
  }
}

/** Thrown where the text cannot be read further, after it was reported. */
class Unreadable extends Error {}

/** The one mapping of a description, or null if the text has an error. */
export function parseYaml({ name, text }, diagnostics) {
  // `yaml` does not end a line at a lone carriage return. Lines and columns stay the same.
  const source = new Source(name, text.replaceAll(/\r\n?/g, "\n"));
  try {
    const top = new Reader(source, diagnostics).readAll();
    return diagnostics.has("yaml") ? null : top;
  } catch (error) {
    if (error instanceof Unreadable) return null;
    throw error;
  }
}

function isEmpty(node) {
  return node === null || (isScalar(node) && node.type === "PLAIN" && node.source === "" && !node.tag);
}

/** The offset of an anchor or tag among tokens, or undefined. */
const offsetOfProperties = (tokens) => tokens?.find(({ type }) => type === "anchor" || type === "tag")?.offset;

class Reader {
  constructor(source, diagnostics) {
    this.source = source;
    this.diagnostics = diagnostics;
    this.anchors = new Map(); // name → {node, size, height}, or null inside its own node
    this.nodes = 0;
    this.copies = 0;
    this.quoted = [];
  }

  report(code, offset, message, hint) {
    this.diagnostics.report(code, offset === null ? this.source.whole : this.source.at(offset), message, hint);
  }

  stop(code, offset, message, hint) {
    this.report(code, offset, message, hint);
    throw new Unreadable();
  }

  readAll() {
    const { text } = this.source;
    const control = text.search(FORBIDDEN);
    if (control >= 0) this.stop("yaml-syntax", control, "the text contains a control character", "remove it");
    const tokens = [...new Parser().parse(text)];
    this.checkDirectives(tokens);
    this.checkDocuments(tokens);
    this.checkDepth(tokens);
    const [document] = new Composer(OPTIONS).compose(tokens);
    if (!document || isEmpty(document.contents)) {
      this.stop("yaml-empty", null, "the description is empty", 'the smallest one is extended_urdf: "2.0"');
    }
    const [error] = document.errors;
    if (error) this.stop("yaml-syntax", error.pos[0], `the text is not YAML: ${error.message}`);
    const { start } = tokens.find(({ type }) => type === "document");
    const { node } = this.visit(document.contents, 1, start);
    this.checkCharacters();
    if (!node.isMapping) {
      this.stop("yaml-empty", node.offset, "the description is not a mapping", "write keys and values: KEY: VALUE");
    }
    return node;
  }

  checkDirectives(tokens) {
    const directives = tokens.filter(({ type }) => type === "directive");
    const versions = directives.filter(({ source }) => /^%YAML(\s|$)/.test(source));
    const [wrong] = versions.filter(({ source }) => !/^%YAML[ \t]+1\.2([ \t]+#.*|[ \t]*)$/.test(source));
    if (wrong) this.stop("yaml-version", wrong.offset, `${wrong.source} is not version 1.2 of YAML`, "remove the line");
    if (versions.length > 1)
      this.stop("yaml-syntax", versions[1].offset, "there is a second %YAML directive", "remove it");
    const tags = directives.filter(({ source }) => /^%TAG(\s|$)/.test(source));
    if (tags.length > MOST_TAGS) this.stop("file-too-large", null, `there are more than ${MOST_TAGS} %TAG directives`);
    const handles = tags.map(({ source }) => source.split(/[ \t]+/)[1]);
    const again = handles.findIndex((handle, i) => handles.indexOf(handle) < i);
    if (again >= 0) this.stop("yaml-syntax", tags[again].offset, `a second %TAG directive names ${handles[again]}`);
  }

  /** EU-YML-003: what follows `...`, except comments, begins another document. */
  checkDocuments(tokens) {
    const [, second] = tokens.filter(({ type }) => type === "document");
    const end = tokens.findIndex(({ type }) => type === "doc-end");
    const silent = ["doc-end", "comment", "newline", "space"];
    const after = end < 0 ? undefined : tokens.slice(end).find(({ type }) => !silent.includes(type));
    const offset = Math.min(...[second, after].filter(Boolean).map((token) => token.offset));
    if (offset === Infinity) return;
    const message = "a second document begins here; a description is one document";
    this.stop("yaml-several-documents", offset, message, "write one robot a file");
  }

  /** Without recursion, because the composer recurses: it overflows the stack on deep nesting. */
  checkDepth(tokens) {
    let first = Infinity;
    const open = tokens.map((token) => [token, 0]);
    while (open.length) {
      const [token, depth, properties] = open.pop();
      if (!token || typeof token !== "object") continue;
      const below = token.items ? depth + 1 : depth;
      if (below > MOST_LEVELS) first = Math.min(first, properties ?? token.offset);
      else {
        if (token.value && typeof token.value === "object") open.push([token.value, below]);
        for (const { start, key, sep, value } of token.items ?? []) {
          open.push([key, below, offsetOfProperties(start)], [value, below, offsetOfProperties(sep ?? start)]);
        }
      }
    }
    if (first < Infinity) this.tooDeep(first);
  }

  tooDeep(offset) {
    this.stop("yaml-too-deep", offset, `mappings and lists are nested deeper than ${MOST_LEVELS} levels here`);
  }

  /** Characters that are allowed inside quotes alone. */
  checkCharacters() {
    const { text } = this.source;
    let start = 0;
    for (const [from, to] of [...this.quoted, [text.length, text.length]]) {
      const found = text.slice(start, from).search(ONLY_QUOTED);
      if (found >= 0) {
        const code = text
          .charCodeAt(start + found)
          .toString(16)
          .toUpperCase()
          .padStart(4, "0");
        this.stop("yaml-syntax", start + found, `the character U+${code} is not allowed here`, "remove it");
      }
      start = to;
    }
  }

  /** Where a node begins, with the anchor and the tag among the `tokens` before it. */
  startOf(node, tokens) {
    const own = node.anchor || node.tag ? offsetOfProperties(tokens) : undefined;
    if (own !== undefined) return own;
    if (isEmpty(node)) {
      const before = tokens?.findLast(({ type }) => type === "map-value-ind" || type === "seq-item-ind");
      if (before) return before.offset + 1;
    }
    const first = isMap(node) && this.source.text[node.range[0]] !== "{" ? node.items[0] : undefined;
    return first?.key ? this.startOf(first.key, first.srcToken?.start) : node.range[0];
  }

  /** `{node, size, height}` of a node of `yaml` on a level: nodes and levels with aliases expanded. */
  visit(node, level, tokens) {
    this.nodes += 1;
    if (this.nodes > MOST_NODES) this.stop("file-too-large", null, `the description has more than ${MOST_NODES} nodes`);
    if (node === null || node === undefined) return { node: new Node(this.source, null, null), size: 1, height: 0 };
    const offset = this.startOf(node, tokens);
    if (isAlias(node)) return this.copy(node, level, offset);
    if (node.anchor) this.anchors.set(node.anchor, null);
    const seen = isScalar(node)
      ? { content: this.scalar(node, offset), size: 1, height: 0 }
      : this.collection(node, level, offset);
    seen.node = new Node(this.source, offset, seen.content);
    // Unless an inner node has taken the name.
    if (node.anchor && this.anchors.get(node.anchor) === null) this.anchors.set(node.anchor, seen);
    return seen;
  }

  copy({ source: name }, level, offset) {
    const marked = this.anchors.get(name);
    const problem = marked === undefined ? "has no anchor before it" : "is inside the node that it repeats";
    if (!marked) {
      this.report("yaml-alias", offset, `*${name} ${problem}`, "put a text that begins with * in quotes");
      return { node: new Node(this.source, offset, null), size: 1, height: 0 };
    }
    this.copies += marked.size;
    if (this.copies > MOST_NODES) {
      this.stop("yaml-alias", offset, `the copies of aliases have more than ${MOST_NODES} nodes with *${name}`);
    }
    if (level - 1 + marked.height > MOST_LEVELS) this.tooDeep(offset);
    return { ...marked, node: new Node(this.source, offset, marked.node.content) };
  }

  collection(node, level, offset) {
    if (level > MOST_LEVELS) this.tooDeep(offset);
    const tag = isMap(node) ? "map" : "seq";
    if (node.tag && node.tag !== CORE + tag && node.tag !== "!") this.unknownTag(node.tag, offset, `a ${tag}`);
    const inside = { size: 1, height: 0 };
    const add = (child, tokens) => {
      const seen = this.visit(child, level + 1, tokens);
      inside.size += seen.size;
      inside.height = Math.max(inside.height, seen.height);
      return seen.node;
    };
    const item = (child, i) => add(child, node.srcToken?.items[i]?.start);
    const content = isSeq(node) ? node.items.map(item) : this.mapping(node, add);
    return { content, size: inside.size, height: inside.height + 1 };
  }

  mapping(node, add) {
    const content = new Map();
    for (const pair of node.items) {
      const key = add(pair.key, pair.srcToken?.start);
      key.offset ??= node.range[0];
      const value = add(pair.value, pair.srcToken?.sep);
      value.offset ??= key.offset;
      const name = key.content;
      if (typeof name !== "string") {
        const shown = key.isList || key.isMapping ? "a list or mapping" : String(name);
        this.report("yaml-key-not-string", key.offset, `the key is ${shown}, not a string`, "put it in quotes");
      } else if (content.has(name)) {
        const hint = "merge the two values under one key";
        this.report("yaml-duplicate-key", key.offset, `the key '${name}' occurs twice in a mapping`, hint);
      } else content.set(name, { key, value });
    }
    return content;
  }

  scalar(node, offset) {
    const text = node.source ?? "";
    const quoted = node.type === "QUOTE_DOUBLE" || node.type === "QUOTE_SINGLE";
    if (quoted) this.quoted.push(node.range.slice(0, 2));
    if (node.type === "QUOTE_DOUBLE") this.checkEscapes(...node.range);
    if (node.tag === undefined) return node.type === "PLAIN" ? this.plain(text, offset) : text;
    return this.tagged(text, node.tag, offset);
  }

  checkEscapes(from, to) {
    const escapes = this.source.text.slice(from, to).matchAll(/\\(u[0-9a-fA-F]{4}|U[0-9a-fA-F]{8}|[^])/g);
    for (const { 0: escape, index } of escapes) {
      const code = parseInt(escape.slice(2), 16);
      if (escape.length > 2 && code >= 0xd800 && code <= 0xdfff) {
        this.stop(
          "yaml-syntax",
          from + index,
          `${escape} is a surrogate, not a character`,
          "write the character itself",
        );
      }
    }
  }

  plain(text, offset) {
    if (NULL.test(text)) return null;
    if (BOOLEAN.test(text)) return text.toLowerCase() === "true";
    return INTEGER.test(text) || FLOAT.test(text) || NOT_FINITE.test(text) ? this.finite(text, offset) : text;
  }

  finite(text, offset) {
    const number = NOT_FINITE.test(text) ? NaN : Number(text);
    if (!Number.isFinite(number)) {
      const hint = "leave a limit out, or write a number that is never reached";
      this.report("yaml-not-finite", offset, `the number ${text.slice(0, 40)} is not finite`, hint);
    }
    return number;
  }

  tagged(text, tag, offset) {
    if (tag === "!" || tag === `${CORE}str`) return text;
    if (tag === `${CORE}null` && NULL.test(text)) return null;
    if (tag === `${CORE}bool` && BOOLEAN.test(text)) return text.toLowerCase() === "true";
    if (tag === `${CORE}int` && INTEGER.test(text)) return this.finite(text, offset);
    if (tag === `${CORE}float` && (FLOAT.test(text) || NOT_FINITE.test(text))) return this.finite(text, offset);
    this.unknownTag(tag, offset, `'${text}'`);
    return text;
  }

  unknownTag(tag, offset, what) {
    const hint = "write the value itself; put a text that begins with ! in quotes";
    this.report("yaml-unknown-tag", offset, `the tag ${tag} is not of the core schema, or does not fit ${what}`, hint);
  }
}
