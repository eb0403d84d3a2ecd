import assert from "node:assert/strict";
import { test } from "node:test";
import { principalMoments } from "../src/mechanism/principal_moments.js";
import { found, inertial, joint } from "./reading.js";

test("principal moments have the invariants of the matrix", () => {
  let state = 7;
  const random = () => ((state = (state * 16807) % 2147483647) / 2147483647) * 2 - 1;
  for (let i = 0; i < 200; i += 1) {
    const [a, b, c, d, e, f] = Array.from({ length: 6 }, random);
    const [x, y, z] = principalMoments([
      [a, d, e],
      [d, b, f],
      [e, f, c],
    ]);
    const near = (one, other) => assert.ok(Math.abs(one - other) < 1e-12, `${one} ${other}`);
    near(x + y + z, a + b + c);
    near(x * y + y * z + z * x, a * b + b * c + c * a - d * d - e * e - f * f);
    near(x * y * z, a * b * c + 2 * d * e * f - a * f * f - b * e * e - c * d * d);
    assert.ok(x <= y && y <= z);
  }
});

/** One link on a joint at the base. */
const body = (inertia, more = '<axis xyz="0 0 1"/>', type = "continuous") =>
  `<robot name="r"><link name="base"/>\n<link name="a">${inertia}</link>\n${joint("j", "base", "a", more, type)}</robot>`;

test("each error of an inertia is reported at its element", () => {
  assert.deepEqual(found(body(inertial(-1, 1))), ["negative-mass -1"]);
  assert.deepEqual(found(body(inertial(1, -1, 2, 2))), ["inertia-not-psd <inertia"]);
  assert.deepEqual(found(body(inertial(1, 1, 1, 2.1))), ["inertia-triangle <inertia"]);
  assert.deepEqual(found(body(inertial(1, 1, 1, 2))), []);
});

test("a leaf needs inertia along the motion of its joint", () => {
  const beside = '<origin xyz="1 0 0"/>';
  assert.deepEqual(found(body("")), ["leaf-without-inertia <link"]);
  assert.deepEqual(found(body(inertial(1, 0))), ["leaf-without-inertia <link"]); // a point on the axis
  assert.deepEqual(found(body(inertial(1, 0, 0, 0, beside))), []);
  assert.deepEqual(found(body(inertial(1, 0, 0, 0, beside), "", "planar")), ["leaf-without-inertia <link"]);
  assert.deepEqual(found(body(inertial(0, 1), "", "floating")), ["leaf-without-inertia <link"]);
  const armature = 'extended_urdf: "2.0"\njoints: {j: {armature: 0.1}}';
  assert.deepEqual(found(body(""), armature), []);
});

test("an error of an inertia hides that its link has none", () => {
  assert.deepEqual(found(body(inertial(-1, 0))), ["negative-mass -1"]);
});
