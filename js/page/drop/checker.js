// What asks the worker. What takes too long ends, and the page goes on.

import source from "./worker.js"; // the bundled script, as text

const SECONDS = 20;

export class Checker {
  /** The result of a task in worker.js; throws `Error` with what went wrong. A new question ends an open one. */
  ask(task, given) {
    if (this.open) this.stop("another robot was opened");
    this.worker ??= started();
    return new Promise((done, failed) => {
      const timer = setTimeout(
        () => this.stop(`it takes more than ${SECONDS} s; use eurdf on the command line`),
        SECONDS * 1000,
      );
      this.open = { failed, timer };
      const end = (how, what) => {
        clearTimeout(timer);
        this.open = null;
        how(what);
      };
      this.worker.onmessage = ({ data: { result, error } }) =>
        error === undefined ? end(done, result) : end(failed, new Error(error));
      this.worker.onerror = (event) => {
        event.preventDefault();
        this.stop(event.message || "the browser does not start a worker");
      };
      this.worker.postMessage({ task, given });
    });
  }

  /** End what is being done, whose promise fails with a reason. */
  stop(reason) {
    this.worker?.terminate();
    this.worker = null;
    if (!this.open) return;
    clearTimeout(this.open.timer);
    const { failed } = this.open;
    this.open = null;
    failed(new Error(reason));
  }
}

function started() {
  const address = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
  const worker = new Worker(address);
  URL.revokeObjectURL(address);
  return worker;
}
