export { analyze } from "./closing/analyze.js";
export { assemble, openLoops } from "./closing/assemble.js";
export { drag } from "./closing/drag.js";
export { Drive } from "./closing/drive.js";
export { limits } from "./closing/limits.js";
export { sliders } from "./closing/sliders.js";
export { sweep } from "./closing/sweep.js";
