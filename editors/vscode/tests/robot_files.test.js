import assert from "node:assert/strict";
import { readFile, readdir } from "node:fs/promises";
import { dirname, join } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { contentOf, isOfRobot, robotOf } from "../src/robot_files.js";

const ROBOTS = join(dirname(fileURLToPath(import.meta.url)), "..", "..", "..", "robots");

const disk = {
  text: (path) => readFile(path, "utf8"),
  bytes: (path) => readFile(path),
  list: (folder) => readdir(folder).catch(() => []),
};

/** Files in memory: {path: text}. */
const memory = (texts) => ({
  text: async (path) => texts[path] ?? Promise.reject(new Error("none")),
  bytes: async (path) => Buffer.from(texts[path] ?? (await Promise.reject(new Error("none")))),
  list: async (folder) => Object.keys(texts).filter((path) => path.startsWith(folder)).map((path) => path.slice(folder.length).split("/")[0]),
});

const mesh = (file) => `<visual><geometry><mesh filename="${file}"/></geometry></visual>`;
const urdf = (...meshes) => `<robot name="r"><link name="base">${meshes.map(mesh).join("")}</link></robot>`;

test("a description starts the server, and no other YAML file", async () => {
  const asked = (path, text) => isOfRobot({ path, text }, memory({}));
  assert.ok(await asked("/w/any.yaml", '# a robot\nextended_urdf: "2.0"\n'));
  assert.ok(await asked("/w/any.yml", "closed_loop: []\n"));
  assert.ok(!(await asked("/w/robot.yaml", "services: {}\n# no extended_urdf: here\n")));
  assert.ok(!(await asked("/w/robot.txt", 'extended_urdf: "2.0"\n')));
});

test("a URDF or xacro starts it beside a description", async () => {
  for (const name of ["robot.yaml", "arm.eurdf.yaml", "robot.yml"]) {
    const files = memory({ [`/w/${name}`]: "" });
    assert.ok(await isOfRobot({ path: "/w/arm.urdf", text: "" }, files));
    assert.ok(await isOfRobot({ path: "/w/arm.urdf.xacro", text: "" }, files));
    assert.ok(!(await isOfRobot({ path: "/other/arm.urdf", text: "" }, files)));
  }
  assert.ok(!(await isOfRobot({ path: "/w/arm.urdf", text: "" }, memory({ "/w/compose.yaml": "" }))));
});

test("a URDF belongs to the description that names it, first of all robot.yaml", async () => {
  const texts = {
    "/w/a.eurdf.yaml": 'extended_urdf: "2.0"\nurdf: x.urdf\n',
    "/w/robot.yaml": 'extended_urdf: "2.0"\nurdf: ./sub/../x.urdf\n',
    "/w/b.eurdf.yaml": 'extended_urdf: "2.0"\nurdf: "what is?#1 é.urdf"\n',
  };
  const of = (path) => robotOf(path, memory(texts));
  assert.deepEqual(await of("/w/x.urdf"), { description: "/w/robot.yaml", urdf: "/w/x.urdf" });
  assert.deepEqual(await of("/w/what is?#1 é.urdf"), { description: "/w/b.eurdf.yaml", urdf: "/w/what is?#1 é.urdf" });
  assert.deepEqual(await of("/w/y.urdf"), { description: null, urdf: "/w/y.urdf" });
  assert.deepEqual(await of("/w/a.eurdf.yaml"), { description: "/w/a.eurdf.yaml", urdf: "/w/x.urdf" });
});

test("each robot of the collection is found from both of its files, with the meshes that it has", async () => {
  const names = (await readdir(ROBOTS, { withFileTypes: true })).filter((each) => each.isDirectory()).map(({ name }) => name);
  let robots = 0;
  for (const name of names) {
    const path = join(ROBOTS, name, "robot.yaml");
    const text = await readFile(path, "utf8").catch(() => null);
    if (text === null) continue;
    const robot = await robotOf(path, disk);
    const content = await contentOf(robot, `${ROBOTS}/`, disk);
    assert.equal(content.description.text, text);
    assert.deepEqual(await robotOf(robot.urdf, disk), robot);
    const named = new Set([...content.urdf.text.replaceAll(/<!--[^]*?-->/g, "").matchAll(/<mesh[^>]*filename="([^"]*)"/g)].map(([, file]) => file));
    assert.deepEqual(new Set(Object.keys(content.meshes)), named, name);
    robots += 1;
  }
  assert.ok(robots > 30);
});

test("meshes are found in packages and beside the URDF, and only in the folder", async () => {
  const names = ["package://p/a.stl", "sub/b.stl", "package://q/c.stl", "../../outside.stl", "/outside.stl", "file:///outside.stl", "missing.stl"];
  const files = memory({
    "/w/p/package.xml": "<package><name>q</name></package>",
    "/w/p/urdf/r.urdf": urdf(...names),
    "/w/p/a.stl": "a",
    "/w/p/urdf/sub/b.stl": "b",
    "/w/p/c.stl": "c",
    "/outside.stl": "secret",
  });
  const { meshes } = await contentOf({ description: null, urdf: "/w/p/urdf/r.urdf" }, "/w/", files);
  assert.deepEqual(Object.entries(meshes).map(([name, data]) => [name, atob(data)]), [
    ["package://p/a.stl", "a"],
    ["sub/b.stl", "b"],
    ["package://q/c.stl", "c"],
  ]);
});

test("a file of glTF brings the files that it names, and what the page has is not read again", async () => {
  const files = memory({
    "/w/r.urdf": urdf("m/x.gltf", "m/broken.gltf"),
    "/w/m/x.gltf": '{"buffers": [{"uri": "x%20y.bin"}, {"uri": "data:,"}], "images": [{"uri": "../t.png"}]}',
    "/w/m/x y.bin": "1",
    "/w/t.png": "2",
    "/w/m/broken.gltf": "{",
  });
  const known = new Set();
  const robot = { description: null, urdf: "/w/r.urdf" };
  assert.deepEqual(Object.keys((await contentOf(robot, "/w/", files, known)).meshes).sort(), ["m/../t.png", "m/broken.gltf", "m/x y.bin", "m/x.gltf"]);
  assert.deepEqual((await contentOf(robot, "/w/", files, known)).meshes, {});
});

test("a preview says which file is missing, and that it expands no xacro", async () => {
  const files = memory({ "/w/robot.yaml": "" });
  await assert.rejects(contentOf({ description: "/w/robot.yaml", urdf: "/w/no.urdf" }, "/w/", files), /there is no file \/w\/no.urdf/);
  await assert.rejects(contentOf({ description: null, urdf: "/w/a.xacro" }, "/w/", files), /does not expand a.xacro/);
});
