import assert from "node:assert/strict";
import { test } from "node:test";
import { endOf, startServer } from "../src/server.js";

test("a program that is missing is named, and what to do", async () => {
  await assert.rejects(startServer("no/such/eurdf"), /cannot start "no\/such\/eurdf server": there is no such program\. Install eurdf .*eurdf\.path/);
});

test("the last line of a process that ends is known", async () => {
  const { code, message } = await endOf(await startServer(process.execPath)); // node has no file "server" to run
  assert.equal(code, 1);
  assert.match(message, /^Node\.js v/);
});
