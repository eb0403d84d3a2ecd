import assert from "node:assert/strict";
import { test } from "node:test";
import { Diagnostics } from "../src/reading/diagnostics.js";
import { readSource } from "../src/reading/source.js";
import { parseYaml } from "../src/reading/yaml.js";

/** The mapping of a text, and each diagnostic as `CODE LINE:COLUMN`. */
function parsed(text) {
  const diagnostics = new Diagnostics();
  const source = readSource({ name: "robot.yaml", text }, diagnostics);
  const top = source && parseYaml(source, diagnostics);
  return { top, found: diagnostics.list().map(({ code, line, column }) => `${code} ${line}:${column}`) };
}

test("a value begins at its anchor, its tag, or its first key", () => {
  const { top, found } = parsed(`a: &x !!str foo
b: &m
  k: 1
c:
  # comment
  - &y 🦾: 1
  -
d: *m
`);
  assert.deepEqual(found, []);
  const at = (node) => Object.values(node.source.position(node.offset));
  const items = top.get("c").content;
  assert.deepEqual(
    [top.get("a"), top.get("b"), top.get("b").get("k"), items[0], items[0].get("🦾"), items[1], top.get("d")].map(at),
    [
      [1, 4],
      [2, 4],
      [3, 6],
      [6, 5],
      [6, 11],
      [7, 4],
      [8, 4],
    ],
  );
});

test("lines end at each of three line ends, and a character beyond U+FFFF is one column", () => {
  assert.deepEqual(parsed("\uFEFFa: 1\rb: 2\r\n🦾🦾: .inf\n").found, ["yaml-not-finite 3:5"]);
});

test("what the format does not allow is all reported, each once", () => {
  const text = `1: a
b: !own {c: .nan, c: 1}
d: [*b, &e [*e]]
`;
  assert.deepEqual(parsed(text).found, [
    "yaml-key-not-string 1:1",
    "yaml-unknown-tag 2:4",
    "yaml-not-finite 2:13",
    "yaml-duplicate-key 2:19",
    "yaml-alias 3:5",
    "yaml-alias 3:13",
  ]);
});

test("a value that an alias repeats is reported where it is written", () => {
  assert.deepEqual(parsed("a: &x [.inf]\nb: *x\nc: *x\n").found, ["yaml-not-finite 1:8"]);
});

test("bytes that are not UTF-8 are reported at the first of them", () => {
  assert.deepEqual(parsed(Uint8Array.of(0x61, 0x3a, 0x0a, 0xc3, 0xa9, 0xe2, 0x82)).found, ["file-not-utf8 2:2"]);
  assert.deepEqual(parsed(Uint8Array.of(0x61, 0x00, 0x3a, 0x00)).found, ["file-not-utf8 1:1"]);
});

test("texts made to exhaust a parser are diagnostics", () => {
  assert.deepEqual(parsed(`a: ${"[".repeat(100_000)}`).found, ["yaml-too-deep 1:67"]);
  assert.deepEqual(parsed(`${"- ".repeat(100_000)}\n`).found, ["yaml-too-deep 1:129"]);
  const doubling = [
    "a0: &a0 [1, 1]",
    ...Array.from({ length: 40 }, (_, i) => `a${i + 1}: &a${i + 1} [*a${i}, *a${i}]`),
  ];
  assert.deepEqual(parsed(doubling.join("\n")).found, ["yaml-alias 15:18"]);
  assert.deepEqual(parsed(`a: [${"1, ".repeat(100_001)}]`).found, ["file-too-large null:null"]);
  assert.deepEqual(parsed("a: \u0007").found, ["yaml-syntax 1:4"]);
});

test("no more than a hundred diagnostics have the same code", () => {
  assert.equal(parsed("a: [" + ".inf, ".repeat(1000) + "]").found.length, 100);
});
