export { Kinematics } from "./mechanism/kinematics.js";
export { Mechanism } from "./mechanism/mechanism.js";
