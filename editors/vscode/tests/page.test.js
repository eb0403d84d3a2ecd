import assert from "node:assert/strict";
import { test } from "node:test";
import { previewPage } from "../src/page.js";

test("no text of a robot is markup, and only what has the nonce runs", () => {
  const content = { urdf: { name: "r.urdf", text: "</script><script>alert(1)</script><!-- <style>" }, description: null, meshes: {} };
  const html = previewPage(content, { script: "run()", style: "p {}", nonce: "n0" });
  const tags = [...html.matchAll(/<(script|style)\b[^>]*>/g)].map(([tag]) => tag);
  assert.equal(tags.length, 4);
  for (const tag of tags) assert.ok(tag.includes('nonce="n0"'), tag);
  const [, policy] = /Content-Security-Policy" content="([^"]*)"/.exec(html);
  assert.equal(policy.split("; ")[0], "default-src 'none'");
  assert.ok(!/unsafe|https?:|\*/.test(policy), policy);
  const [, data] = /<script type="application\/json"[^>]*>([^<]*)<\/script>/.exec(html);
  assert.deepEqual(JSON.parse(data), content);
});
