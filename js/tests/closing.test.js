import assert from "node:assert/strict";
import { test } from "node:test";

import { Drive, analyze, assemble, drag, limits, openLoops, sliders, sweep } from "../src/closing.js";
import { Mechanism } from "../src/mechanism.js";
import { joint, reading, urdf } from "./reading.js";

const LIMITED = '<axis xyz="0 1 0"/><limit lower="-0.5" upper="0.5" effort="1" velocity="1"/>';

/** A link on a joint about y, which carries the point (1, 0, 0). */
const pendulum = (type, more) => {
  const { robot } = reading(urdf(["base"], `<link name="arm"/>${joint("turn", "base", "arm", more, type)}`));
  return new Mechanism(robot);
};

/** Four links of a parallelogram with sides of 1 and 2 m, about y. */
const parallelogram = (actuators = "[a]") => {
  const at = (x, z) => `<origin xyz="${x} 0 ${z}"/><axis xyz="0 1 0"/>`;
  const links = `${["left", "top", "right"].map((name) => `<link name="${name}"/>`).join("")}`;
  const joints =
    joint("a", "base", "left", at(0, 0)) + joint("b", "left", "top", at(0, 1)) + joint("c", "base", "right", at(2, 0));
  const description = `extended_urdf: "2.1"
urdf: robot.urdf
closures:
  - {name: pin, type: 3d, frames: [{link: top, xyz: [2, 0, 0]}, {link: right, xyz: [0, 0, 1]}]}
actuators: ${actuators}
`;
  return new Mechanism(reading(urdf(["base"], links + joints), description).robot);
};

const isNear = (a, b, tolerance = 1e-9) => assert.ok(Math.abs(a - b) <= tolerance, `${a} is not ${b}`);

test("opposite sides of a parallelogram turn alike, and the top keeps its direction", () => {
  const drive = new Drive(parallelogram(), {});
  const { q, stop } = drive.move("a", 0, 0.7);
  assert.equal(stop, null);
  isNear(q.a[0], 0.7);
  isNear(q.b[0], -0.7);
  isNear(q.c[0], 0.7);
});

test("an open parallelogram closes, and says what was open", () => {
  const mechanism = parallelogram();
  const [open] = openLoops(mechanism, { a: [0.3] });
  assert.equal(open.name, "pin");
  isNear(open.position, Math.hypot(Math.sin(0.3) * 1 + 2 * Math.cos(0.3) - 2, Math.cos(0.3) - 2 * Math.sin(0.3) - 1));
  const found = assemble(mechanism, { a: [0.3] });
  assert.deepEqual([found.closes, found.open], [true, []]);
  assert.ok(found.residual < 1e-12);
  isNear(found.q.a[0], found.q.c[0]);
});

test("two actuators of one degree of freedom depend on one another", () => {
  const { nv, nc, rank, mobility, uncontrolled, dependentActuators } = analyze(parallelogram("[a, c]"), {});
  assert.deepEqual({ nv, nc, rank, mobility, uncontrolled }, { nv: 3, nc: 3, rank: 2, mobility: 1, uncontrolled: 0 });
  assert.deepEqual(dependentActuators, [["a", "c"]]);
  assert.deepEqual(
    sliders(parallelogram("[a, c]"), {}).map(({ follow }) => follow),
    [["c"], ["a"]],
  );
});

test("a dragged point follows, and stops at a limit", () => {
  const goal = { link: "arm", point: [1, 0, 0] };
  const near = drag(pendulum("revolute", LIMITED), {}, { ...goal, target: [Math.cos(0.3), 0, -Math.sin(0.3)] });
  isNear(near.q.turn[0], 0.3);
  isNear(near.error, 0);
  assert.deepEqual(near.atLimits, []);
  const far = drag(pendulum("revolute", LIMITED), {}, { ...goal, target: [0, 0, -1] });
  isNear(far.q.turn[0], 0.5);
  isNear(far.error, 2 * Math.sin((Math.PI / 2 - 0.5) / 2));
  assert.deepEqual(far.atLimits, ["turn"]);
});

test("a dragged link turns as it is told", () => {
  const [c, s] = [Math.cos(0.4), Math.sin(0.4)];
  const goal = {
    link: "arm",
    point: [0, 0, 0],
    target: [0, 0, 0],
    rotation: [
      [c, 0, s],
      [0, 1, 0],
      [-s, 0, c],
    ],
  };
  isNear(drag(pendulum("continuous", '<axis xyz="0 1 0"/>'), {}, goal).q.turn[0], 0.4);
});

test("joints that are held do not move", () => {
  const goal = { link: "top", point: [0, 0, 0], target: [0.5, 0, 0.8], held: ["a"] };
  assert.equal(drag(parallelogram(), {}, goal).q.a[0], 0);
});

test("the distance to a limit is negative beyond it", () => {
  const [found] = limits(pendulum("revolute", LIMITED), { turn: [0.6] });
  isNear(found.distance, -0.1);
  assert.equal(found.passive, true);
});

test("what is not a configuration, or cannot be moved, is named", () => {
  const mechanism = parallelogram();
  const says = (action, message) => assert.throws(action, { name: "RangeError", message });
  says(() => mechanism.at({ d: [0] }), "'d' is not a joint with coordinates of its own");
  says(() => mechanism.at({ a: [0, 1] }), "joint 'a' is at [0,1]: give 1 finite number");
  says(() => mechanism.at({ a: [NaN] }), "joint 'a' is at [NaN]: give 1 finite number");
  says(() => new Drive(mechanism, {}).move("a", 1, 0), "'a' has no coordinate 1");
  says(() => new Drive(mechanism, {}).move("a", 0, Infinity), "'a' cannot move to Infinity");
  says(() => drag(mechanism, {}, { link: "d", point: [0, 0, 0], target: [0, 0, 0] }), "there is no link 'd'");
  says(() => sweep(mechanism, {}, "b"), "'b' is not an actuated joint with one velocity");
});

test("M of a chain is that of the sums over its links", () => {
  const mechanism = new Mechanism(reading(urdf(["base", "one", "two", "three"])).robot);
  const { columns, matrix } = mechanism.at({ to_two: [0.3] }).massMatrix();
  assert.deepEqual(
    columns.map(([name]) => name),
    ["to_one", "to_two", "to_three"],
  );
  matrix.forEach((row, i) => row.forEach((each, j) => isNear(each, 3 - Math.max(i, j))));
});
