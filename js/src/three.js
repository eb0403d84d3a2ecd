export { closedChainIK } from "./three/closed_chain_ik.js";
export { withClosedLoops } from "./three/closed_loops.js";
export { InvalidRobot, loadExtendedURDF } from "./three/loader.js";
export { loadMesh } from "./three/meshes.js";
export { shapesOf } from "./three/shapes.js";
