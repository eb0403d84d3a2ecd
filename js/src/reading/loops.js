// Loops that are open at `assembled`, or that do not close: EU-CLO-005, -006 and -016.

import { assemble } from "../closing/assemble.js";
import { Decomposition } from "../closing/linear_algebra.js";
import { CLOSED } from "../closing/tolerances.js"; // of a coupling, times its largest coefficient
import { Mechanism } from "../mechanism/mechanism.js";

const STARTS = [0, 0.1, -0.1]; // velocities that lead from the neutral to where a search starts
const STEPS = 100;
const LONGEST = 0.5; // of a step
const SINGULAR = 1e-7; // of the largest singular value
const MOST_WORK = 1e6; // rows times velocities squared

/** `description`: its nodes are the places of diagnostics. */
export function checkLoops(robot, description, diagnostics) {
  if (!robot.closures.length && !robot.couplings.length) return;
  const mechanism = new Mechanism(robot);
  const assembled = mechanism.named("assembled");
  if (assembled) {
    const open = openings(mechanism.at(assembled));
    if (!open.length) return;
    const place = description.node.get("configurations").key("assembled");
    const message = `at assembled, ${open.map(({ text }) => text).join(", ")}`;
    const hint = "compute the configuration with a solver, such as eurdf assemble --write --force";
    diagnostics.report("assembled-open", place, message, hint);
    return;
  }
  const [widest] = openings(mechanism.at(assemble(mechanism).q));
  if (!widest || leastSearch(mechanism)) return;
  const message = `no configuration was found that closes the loops: ${widest.text}`;
  const hint = "check its frames, their units, and that no joint of the loop is locked";
  diagnostics.report("closure-cannot-close", widest.item.node, message, hint);
}

/** What is open at a configuration, the widest first: {item, ratio, text}, an opening in bounds. */
function openings(kinematics) {
  const residuals = kinematics.residuals();
  const { closures, couplings } = kinematics.mechanism.robot;
  const closed = closures.map((item) => {
    const residual = residuals[item.name];
    const [position, angle] = [residual.slice(0, 3), residual.slice(3)].map((part) => Math.hypot(...part));
    const parts = [
      ...(position > CLOSED ? [`${shown(position)} m`] : []),
      ...(angle > CLOSED ? [`${shown(angle)} rad`] : []),
    ];
    const text = `closure '${item.name}' is open by ${parts.join(" and ")}`;
    return { item, ratio: Math.max(position, angle) / CLOSED, text };
  });
  const coupled = couplings.map((item) => {
    const [residual] = residuals[item.name];
    const text = `coupling '${item.name}' is open by ${shown(Math.abs(residual))}`;
    return { item, ratio: Math.abs(residual) / largest(item) / CLOSED, text };
  });
  return [...closed, ...coupled].filter(({ ratio }) => !(ratio <= 1)).sort((a, b) => b.ratio - a.ratio);
}

const shown = (number) => Number(number.toPrecision(3));
const largest = ({ joints }) => Math.max(...[...joints.values()].map(Math.abs));

/** Whether the least search of the chapter on closures closes the loops. In large robots, `assemble` alone decides. */
function leastSearch(mechanism) {
  const { robot, nv } = mechanism;
  const scales = new Map(robot.couplings.map((coupling) => [coupling.name, 1 / largest(coupling)]));
  const inRows = (byName) =>
    [...robot.closures, ...robot.couplings].flatMap(({ name }) =>
      byName[name].map((row) =>
        scales.has(name) ? [row].flat().map((each) => each * scales.get(name)) : [row].flat(),
      ),
    );
  for (const velocity of STARTS) {
    let q = mechanism.integrate(mechanism.neutral(), Array(nv).fill(velocity));
    for (let step = 0; step <= STEPS; step += 1) {
      const kinematics = mechanism.at(q);
      if (!openings(kinematics).length) return true;
      const rows = inRows(kinematics.jacobian().rows);
      if (rows.length * nv * nv > MOST_WORK) return false;
      const of = new Decomposition(rows, nv, { singularValues: true });
      of.rank = of.values.filter((value) => value > SINGULAR * of.values[0]).length;
      const found = of.solve(inRows(kinematics.residuals()).flat());
      const length = Math.hypot(...found);
      q = mechanism.integrate(
        q,
        found.map((each) => -each * Math.min(1, LONGEST / length || 1)),
      );
    }
  }
  return false;
}
