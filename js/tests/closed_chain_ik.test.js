// Robots as closed-chain-ik has them: its solver reaches a target that is in reach, and the loops of the robot are closed there.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
// Its entry for all of it does not fit the present three.js.
import * as ik from "../node_modules/closed-chain-ik/src/core/index.js";
import { Drive, assemble } from "../src/closing.js";
import { read } from "../src/index.js";
import { Mechanism } from "../src/mechanism.js";
import { closedChainIK } from "../src/three/closed_chain_ik.js";

function loaded(name, change = (text) => text) {
  const [description, urdf] = ["robot.yaml", "robot.urdf"].map((file) => {
    return { name: file, text: readFileSync(new URL(`../../robots/${name}/${file}`, import.meta.url), "utf8") };
  });
  const mechanism = new Mechanism(read({ description: { ...description, text: change(description.text) }, urdf }).robot);
  return { mechanism, q: assemble(mechanism).q };
}

const opening = (mechanism, q) => Math.max(...Object.values(mechanism.at(q).residuals()).flat().map(Math.abs));

/** How far the links of closed-chain-ik are from those of the mechanism, m and 1. */
function apart({ links }, kinematics) {
  const differences = [...links].flatMap(([name, { matrixWorld }]) => {
    const { R, p } = kinematics.pose(name);
    return [0, 1, 2].flatMap((i) => [p[i] - matrixWorld[12 + i], ...[0, 1, 2].map((j) => R[i][j] - matrixWorld[4 * j + i])]);
  });
  return Math.max(...differences.map(Math.abs));
}

// With 3d and 6d closures; hinges and distances (sarrus, double_wishbone).
for (const name of ["digit_leg", "five_bar", "stewart_platform", "sarrus", "double_wishbone"]) {
  test(`closed-chain-ik keeps the loops of ${name} closed`, () => {
    const { mechanism, q } = loaded(name);
    const made = closedChainIK({ mechanism, q }, ik);
    assert.deepEqual(made.losses, []);
    made.root.updateMatrixWorld(true);
    assert.ok(apart(made, mechanism.at(q)) < 2e-6); // it computes with 24 bits

    const drive = new Drive(mechanism, q);
    const motor = mechanism.robot.actuators[0].joint;
    drive.move(motor, 0, drive.value(motor) + 0.05);
    const [before, after] = [mechanism.at(q), mechanism.at(drive.q)];
    const moved = (link) => Math.hypot(...before.pose(link).p.map((each, i) => each - after.pose(link).p[i]));
    const link = [...made.links.keys()].reduce((a, b) => (moved(b) > moved(a) ? b : a));
    const goal = new ik.Goal();
    goal.setFreeDoF(ik.DOF.EX, ik.DOF.EY, ik.DOF.EZ);
    goal.setPosition(...after.pose(link).p);
    goal.makeClosure(made.links.get(link));
    const solver = new ik.Solver([made.root, goal]);
    Object.assign(solver, { maxIterations: 100, stallThreshold: 0, restPoseFactor: 0, dampingFactor: 0.01, divergeThreshold: 1 });
    Object.assign(solver, { translationConvergeThreshold: 1e-5, rotationConvergeThreshold: 1e-5 });
    for (let i = 0; i < 3; i += 1) solver.solve();

    const found = made.configuration();
    assert.ok(moved(link) > 1e-3);
    assert.ok(opening(mechanism, found) < 1e-4);
    const reached = mechanism.at(found).pose(link).p.map((each, i) => each - after.pose(link).p[i]);
    assert.ok(Math.hypot(...reached) < 1e-4);
    made.root.updateMatrixWorld(true);
    assert.ok(apart(made, mechanism.at(found)) < 1e-5);
  });
}

// Universal, spherical, helical and mimic joints; a floating root.
for (const name of ["delta", "screw_press", "reachy_mini"]) {
  test(`closed-chain-ik has the joints of ${name} where they are`, () => {
    const { mechanism, q } = loaded(name, (text) => text.replace(/"2\.[01]"/, "$&\nroot: floating"));
    const there = { ...q, root_joint: [0.1, -0.2, 0.3, 0, 0.6, 0, 0.8] };
    const made = closedChainIK({ mechanism, q: there }, ik);
    made.root.updateMatrixWorld(true);
    assert.ok(apart(made, mechanism.at(there)) < 2e-6);
    assert.ok(apart(made, mechanism.at(made.configuration())) < 2e-6);
  });
}

test("what closed-chain-ik cannot hold is listed", () => {
  const { losses } = closedChainIK(loaded("tello"), ik);
  assert.equal(losses.length, 4);
  assert.match(losses[0], /^coupling 'left_knee_sum' is not held/);
  assert.match(closedChainIK(loaded("screw_press"), ik).losses[0], /slides and turns, each by itself/);
});
