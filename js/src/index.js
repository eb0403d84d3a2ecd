export { closuresOfDialects } from "./reading/dialects.js";
export { read, urdfOf } from "./reading/robot.js";
