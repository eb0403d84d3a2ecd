// What a robot is made of, and how it can move.

import { element } from "../elements.js";

const MOST_NAMES = 6;

/** @param list A `dl`, which is filled. @param analysis What `analyze` returns. */
export function showFacts(list, robot, { nv, rank, mobility, uncontrolled, dependentActuators }) {
  const motors = robot.actuators.map(({ joint }) => joint);
  const loops = [...robot.closures, ...robot.couplings].map(({ name }) => name);
  const dependent = [...new Set((dependentActuators ?? []).flat())];
  const facts = [
    ["Motors", motors.length, some(motors)],
    ["Loops", loops.length, some(loops)],
  ];
  // Where loops are open, these are not known.
  if (mobility !== null) {
    facts.unshift(["Mobility", mobility, `${nv} velocities of the tree, less ${rank} independent constraints`]);
    const free = uncontrolled ? "motions that no motor holds" : "the motors hold every joint";
    if (motors.length) facts.push(["Free", uncontrolled, free]);
    if (dependent.length)
      facts.push(["Dependent", dependent.length, `motors that cannot move independently: ${some(dependent)}`]);
  }
  list.replaceChildren();
  for (const [name, value, detail] of facts) {
    const row = element(list, "div");
    element(row, "dt", {}, name);
    element(row, "dd", {}, String(value));
    element(row, "dd", { class: "drop-detail" }, detail);
  }
}

function some(names) {
  const more = names.length - MOST_NAMES;
  return more > 0 ? `${names.slice(0, MOST_NAMES).join(", ")} and ${more} more` : names.join(", ");
}
