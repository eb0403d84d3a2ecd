import assert from "node:assert/strict";
import { test } from "node:test";
import { inertial, joint, reading } from "./reading.js";

const BODY = inertial(1, 1);
const link = (name) => `<link name="${name}">${BODY}</link>`;
/** Two bars of length 1 on one pin; their ends meet if both angles are equal. */
const BARS = `<robot name="r">${["base", "a", "b"].map(link).join("")}${["a", "b"].map((n) => joint(n, "base", n)).join("")}</robot>`;

const described = (length, more = "") => `extended_urdf: "2.0"
closures:
  - {name: pin, type: 3d, frames: [{link: a, xyz: [1, 0, 0]}, {link: b, xyz: [0, ${length}, 0]}]}
${more}`;

const codes = (...given) =>
  reading(BARS, ...given).diagnostics.map((each) => `${each.code} ${each.line}:${each.column}`);

test("loops that close at some configuration are right", () => {
  assert.deepEqual(codes(described(1)), []);
});

test("loops that no configuration closes leave a robot, with the opening", () => {
  const { robot, diagnostics } = reading(BARS, described(1.5));
  assert.ok(robot);
  const [{ code, line, column, message }] = diagnostics;
  assert.deepEqual([code, line, column], ["closure-cannot-close", 3, 5]);
  assert.match(message, /'pin' is open by 0.5 m/);
});

test("the configuration assembled must close the loops", () => {
  const at = (a) => described(1, `configurations:\n  assembled: {a: ${a}}`);
  assert.deepEqual(codes(at(Math.PI / 2)), []);
  assert.deepEqual(codes(at(1.57)), ["assembled-open 5:3"]);
});
