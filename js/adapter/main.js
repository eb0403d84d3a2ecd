// The parser behind the protocol: one request a line on standard input, one answer a line on standard output.
// --parser="cmd:node main.js"

import { canonical } from "./canonical.js";
import { Invalid } from "../src/reading/invalid.js";
import { evaluate } from "./quantities.js";
import { readRobot } from "../src/reading/robot.js";

const LEVELS = ["accept", "structure", "kinematics", "dynamics"];
const STARTED = {
  outcome: "started",
  protocol: "1.0",
  parser: { name: "extended-urdf", version: "0.1.0", language: "JavaScript" },
  claims: { 1: LEVELS, 2: LEVELS, 2.1: LEVELS },
};

let robot; // of the last `load`, if it was accepted

const answers = {
  start: () => STARTED,
  load: ({ description, urdf }) => {
    robot = undefined;
    robot = readRobot(description, urdf);
    return { outcome: "accepted", robot: canonical(robot), issues: [] };
  },
  evaluate: (request) => {
    if (!robot) throw new Error("the last load did not accept a robot");
    const values = request.configurations.map((each) => evaluate(robot, each, request.frames, request.quantities));
    return { outcome: "evaluated", values };
  },
  stop: () => ({ outcome: "stopped" }),
};

function answer(request) {
  try {
    return answers[request.command](request);
  } catch (error) {
    if (error instanceof Invalid) return { outcome: "rejected", issues: [{ message: error.message }] };
    return { outcome: "errored", message: String(error.stack) };
  }
}

/** Lines end at a line feed alone, whatever other separators a name contains. */
async function* lines(stream) {
  stream.setEncoding("utf8");
  let pieces = [];
  for await (const chunk of stream) {
    const [first, ...others] = chunk.split("\n");
    pieces.push(first);
    for (const other of others) {
      yield pieces.join("");
      pieces = [other];
    }
  }
}

for await (const line of lines(process.stdin)) {
  const request = JSON.parse(line);
  process.stdout.write(`${JSON.stringify({ id: request.id, ...answer(request) })}\n`);
  if (request.command === "stop") break;
}
