// The language server as a process.

import { spawn } from "node:child_process";

export const CANNOT_RUN = 2; // exit code of eurdf; what it wrote says why

/** Start it: a promise of the process, which rejects with `Error` and what to do if there is no such program. */
export function startServer(program) {
  const server = spawn(program, ["server"], { stdio: "pipe" });
  return new Promise((done, failed) => {
    server.once("spawn", () => done(server));
    server.once("error", ({ code, message }) => {
      const reason = code === "ENOENT" ? "there is no such program" : message;
      failed(new Error(`cannot start "${program} server": ${reason}. Install eurdf with its extra "editor", and set eurdf.path to its program`));
    });
  });
}

/** What the process wrote last before it ended: {code, message}. */
export function endOf(server) {
  let written = "";
  server.stderr.on("data", (some) => (written = (written + some).slice(-4000)));
  return new Promise((done) => {
    server.once("close", (code) => done({ code, message: written.trim().split("\n").at(-1) }));
  });
}
