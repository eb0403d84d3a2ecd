export { readRobot } from "./reading/robot.js";
