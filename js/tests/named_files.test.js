import assert from "node:assert/strict";
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, test } from "node:test";
import { pathToFileURL } from "node:url";
import { namedFiles } from "../adapter/named_files.js";

const root = mkdtempSync(join(tmpdir(), "eurdf-"));
after(() => rmSync(root, { recursive: true }));
mkdirSync(join(root, "arm", "urdf"), { recursive: true });
mkdirSync(join(root, "hand"));
for (const name of ["arm/package.xml", "arm/link.stl", "arm/urdf/arm.urdf", "hand/palm.stl"]) {
  writeFileSync(join(root, name), "");
}

test("files are found by their path and by their package, and nowhere else", () => {
  delete process.env.ROS_PACKAGE_PATH;
  const exists = namedFiles(join(root, "arm", "urdf", "arm.urdf"));
  const names = ["../link.stl", "package://arm/link.stl", pathToFileURL(join(root, "hand", "palm.stl")).href];
  assert.deepEqual(names.map(exists), [true, true, true]);
  const none = [
    "",
    ".",
    "link.stl",
    "package://hand/palm.stl",
    "package://",
    "https://a.b/link.stl",
    "a\0b",
    "a".repeat(9999),
  ];
  assert.deepEqual(none.filter(exists), []);
  process.env.ROS_PACKAGE_PATH = root;
  assert.ok(namedFiles(join(root, "arm", "urdf", "arm.urdf"))("package://hand/palm.stl"));
});
