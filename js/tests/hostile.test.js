import assert from "node:assert/strict";
import { test } from "node:test";
import { found, reading, urdf } from "./reading.js";

const NAMES = ["__proto__", "constructor", "prototype", "hasOwnProperty", "toString", "valueOf", "<img src=x>"];

test("names of object properties are names like any other", () => {
  const links = NAMES.map((name) => name.replaceAll("<", "&lt;"));
  const text = `extended_urdf: "2.1"
x-__proto__: {__proto__: 1}
closures:
  - {name: __proto__, type: 3d, frames: [__proto__, valueOf]}
joints:
  to_constructor: {damping: 2}
configurations:
  __proto__: {to_constructor: 0.5}
metadata: {__proto__: {polluted: true}}
`;
  const { robot, diagnostics } = reading(urdf(links), text);
  assert.deepEqual(
    diagnostics.filter(({ code }) => code !== "closure-cannot-close"),
    [],
  );
  assert.deepEqual([...robot.links.keys()], NAMES);
  assert.deepEqual(robot.configurations.get("__proto__"), new Map([["to_constructor", [0.5]]]));
  assert.equal({}.polluted, undefined);
});

test("names of object properties are no keys and no elements", () => {
  const text = 'extended_urdf: "2.0"\nconstructor: {}\n__proto__: {}\njoints: {to_b: {valueOf: 1}}\n';
  const codes = reading(urdf(["a", "b"]), text).diagnostics.map(({ code }) => code);
  assert.deepEqual(codes, ["unknown-key", "unknown-key", "unknown-key"]);
  assert.deepEqual(found(urdf(["a"], "<constructor/><__proto__/>", 'toString="1"')), []);
});

test("elements that are too deep or too many are diagnostics", () => {
  assert.deepEqual(found("<robot>".repeat(100_000)), ["file-too-large <robot"]);
  const { robot, diagnostics } = reading(`<robot name="r"><link name="a"/>${"<x/>".repeat(1_000_001)}</robot>`);
  assert.deepEqual([robot, diagnostics.map(({ code }) => code)], [null, ["file-too-large"]]);
});

test("a missing file is a diagnostic", () => {
  assert.deepEqual(
    reading(null, 'extended_urdf: "2.0"\n').diagnostics.map(({ code, line }) => [code, line]),
    [["urdf-not-found", 1]],
  );
  assert.deepEqual(
    reading(null).diagnostics.map(({ code, file, line }) => [code, file, line]),
    [["file-unreadable", "robot.urdf", null]],
  );
});
