// The entries that need no three.js, as one for pages without a bundler: each needs what reads a robot.

export * from "./closing.js";
export * from "./index.js";
export * from "./mechanism.js";
