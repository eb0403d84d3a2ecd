import assert from "node:assert/strict";
import { test } from "node:test";
import { urdfOf } from "../src/index.js";
import { joint, reading, urdf } from "./reading.js";

const TREE = urdf(["base", "crank", "rod", "tip"]);

/** Each diagnostic as `CODE LINE:COLUMN`. */
function places(description, tree = TREE) {
  const { diagnostics } = reading(tree, description);
  return diagnostics.map(({ code, line, column }) => `${code} ${line}:${column}`);
}

test("errors of form are all reported, and names are not looked up then", () => {
  const text = `extended_urdf: "2.1"
rooot: fixed
closures:
  - {name: pin, type: 4d, frames: [tip]}
  - {name: "", frames: [nowhere, tip], length: 1}
joints:
  to_rod: {damping: -1, limits: {lower: "0"}}
  to_tip: universal
configurations: [assembled]
`;
  assert.deepEqual(places(text), [
    "unknown-key 2:1",
    "wrong-value 4:23",
    "wrong-length 4:35",
    "missing-key 5:5",
    "wrong-value 5:12",
    "out-of-range 7:21",
    "wrong-type 7:41",
    "wrong-value 8:11",
    "wrong-type 9:17",
  ]);
});

test("wrong names and meanings are all reported, one for each item", () => {
  const text = `extended_urdf: "2.1"
closures:
  - {name: pin, type: 3d, frames: [nowhere, {link: lost}]}
  - {name: same, type: 3d, frames: [tip, to_tip]}
  - {name: same, type: 6d, frames: [tip, base]}
joints:
  to_rod: {damping: [1, 2], limits: {lower: 0}}
  to_crank: {type: universal, axes: [[0, 0, 1], [0, 0, 2]]}
actuators: [to_tip, {joint: to_tip, gear_ratio: 2}, motor, {joint: to_rod, control: [2, 1]}]
configurations:
  ready: {to_tip: [0, 1], to_base: 0, to_rod: [0, 0]}
`;
  assert.deepEqual(places(text), [
    "unknown-frame 3:36",
    "unknown-frame 3:52",
    "closure-same-frame 4:42",
    "duplicate-closure-name 5:12",
    "joint-property 7:21",
    "joint-axes-parallel 8:37",
    "actuator-duplicate 9:29",
    "unknown-actuator 9:53",
    "actuator-control-reversed 9:85",
    "configuration-length 11:19",
    "configuration-joint 11:27",
  ]);
});

test("what follows from an error is not reported", () => {
  const chain = ["x", "y", "z"].map((name, i) => {
    const axis = `<axis xyz="${[0, 1, 2].map((k) => Number(k === i))}"/>`.replaceAll(",", " ");
    return joint(`r${name}`, ["base", "a", "b"][i], ["a", "b", "ball"][i], axis, i === 2 ? "prismatic" : "continuous");
  });
  const tree = `<robot name="r"><link name="base"/><link name="a"/><link name="b"/>
<link name="ball"/>${chain.join("").replaceAll("</joint>", '<limit effort="1" velocity="1"/></joint>')}</robot>`;
  const text = `extended_urdf: "2.0"
joints:
  hip: {type: spherical, merges: [rx, ry, rz]}
closures:
  - {name: pin, type: 3d, frames: [hip, a]}
actuators: [hip]
configurations:
  ready: {hip: [0, 0, 0, 1], rx: 1}
`;
  assert.deepEqual(places(text, tree), ["merge-not-chain 3:34"]);
});

test("version 1 has its errors at the items of its lists", () => {
  const text = `closed_loop: [[tip, nowhere], [tip, to_tip], [tip, base]]
type: [3d, 3d, 6D]
name_mot: [to_rod, to_crank_X]
joint_name: [to_rod, to_rod, to_crank]
joint_type: [FIXED, SPHERICAL, UJOINT_XY]
gait: {x-own: [1, null]}
name_motor: [to_tip]
`;
  assert.deepEqual(places(text), [
    "unknown-frame 1:21",
    "closure-same-frame 1:37",
    "duplicate-replacement 4:22",
    "near-miss-key 7:1",
  ]);
});

test("a description without a version or with an unknown one is not read further", () => {
  assert.deepEqual(places('closures: 3\nextended_urd: "2.0"\n'), ["missing-key 2:1"]);
  assert.deepEqual(places('closures: 3\nextended_urdf: "2.2"\n'), ["unsupported-version 2:16"]);
});

test("a hint names what was meant", () => {
  const text = 'extended_urdf: "2.0"\nclosurs: []\nactuators: [to_tpi]\n';
  assert.deepEqual(
    reading(TREE, text).diagnostics.map(({ hint }) => hint),
    ["did you mean 'closures'?"],
  );
  const [{ message, hint }] = reading(TREE, text.replace("closurs", "closures")).diagnostics;
  assert.equal(message, "'to_tpi' is no joint of the robot");
  assert.equal(hint, "did you mean 'to_tip'?");
});

test("the URDF that a description names can be looked up", () => {
  assert.equal(urdfOf({ name: "robot.yaml", text: 'extended_urdf: "2.0"\nurdf: arm/arm.urdf\n' }), "arm/arm.urdf");
  assert.equal(urdfOf({ name: "robot.yaml", text: "urdf: [1\n" }), "robot.urdf");
});
