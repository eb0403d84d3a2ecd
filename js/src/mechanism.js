export { centerOfMass, mass, massMatrix } from "./mechanism/dynamics.js";
export { Kinematics } from "./mechanism/kinematics.js";
export { jacobian, residuals } from "./mechanism/residuals.js";
