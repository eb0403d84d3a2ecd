// Answers to the requests of the suite's protocol, wherever the texts of a robot come from.

import { canonical } from "./canonical.js";
import { evaluate } from "./quantities.js";
import { Mechanism } from "../src/mechanism.js";
import { read } from "../src/reading/robot.js";

const LEVELS = ["accept", "structure", "kinematics", "dynamics", "diagnose"];
const STARTED = {
  outcome: "started",
  protocol: "1.0",
  parser: { name: "extended-urdf", version: "0.1.0", language: "JavaScript" },
  claims: { 1: LEVELS, 2: LEVELS, 2.1: LEVELS },
};

let mechanism = null; // of the last `load`, if it was accepted

const answers = {
  start: () => STARTED,
  load: (texts) => {
    mechanism = null;
    const { robot, diagnostics } = read(texts);
    const issues = diagnostics.map(issueOf);
    if (!robot) return { outcome: "rejected", issues };
    const answered = { outcome: "accepted", robot: canonical(robot), issues };
    mechanism = new Mechanism(robot);
    return answered;
  },
  evaluate: ({ configurations, frames, quantities }) => {
    if (!mechanism) throw new Error("the last load did not accept a robot");
    return { outcome: "evaluated", values: configurations.map((each) => evaluate(mechanism, each, frames, quantities)) };
  },
  stop: () => ({ outcome: "stopped" }),
};

const issueOf = ({ code, severity, file, line, column, message, hint }) => ({
  code,
  severity,
  file,
  line,
  column,
  message: hint ? `${message}; ${hint}` : message,
});

/**
 * The line with the answer to a request.
 *
 * @param textsOf What `read` takes, of the two paths in a request to load.
 */
export function answer(request, textsOf) {
  let found;
  try {
    found = answers[request.command](request.command === "load" ? textsOf(request) : request);
  } catch (error) {
    found = { outcome: "errored", message: String(error.stack) };
  }
  return JSON.stringify({ id: request.id, ...found });
}
