import assert from "node:assert/strict";
import { test } from "node:test";
import { found, joint, reading, urdf } from "./reading.js";

test("a bare URDF is a robot", () => {
  const { robot, diagnostics } = reading(`<robot name="r"><link name="a"/></robot>`);
  assert.deepEqual(diagnostics, []);
  assert.deepEqual([robot.name, robot.rootLink, robot.closures], ["r", "a", []]);
});

test("every error of the elements is reported, each once", () => {
  const text = `<robot name="r">
  <link name="a"><inertial><mass value="1,5"/></inertial></link>
  <link><visual><geometry><box size="1 0 1"/></geometry></visual></link>
  <joint name="" type="hinge"><parent link="a"/><child link="a"/><limit effort="-1" velocity="1e16"/></joint>
</robot>`;
  assert.deepEqual(found(text), [
    "urdf-missing-element <inertial",
    "urdf-bad-number 1,5",
    "urdf-missing-attribute <link",
    "urdf-geometry <box",
    "urdf-empty-name ",
    "urdf-joint-type hinge",
    "urdf-negative-limit -1",
  ]);
});

test("columns count characters, and a byte order mark is none", () => {
  const text = `\uFEFF<robot name="r">\r\n\t<!--😀é--><a/><link/>\r<link/></robot>`;
  const places = reading(text).diagnostics.map(({ line, column }) => [line, column]);
  assert.deepEqual(places, [
    [2, 15],
    [3, 1],
  ]);
});

test("the place of a value is behind its quote, whatever its text is", () => {
  const text = `<robot name="r"><link name="a"/>\n<material name = 'x="'><color rgba=\n'&#49; 2 a>'/></material></robot>`;
  assert.deepEqual(found(text), ["urdf-bad-number &#49;"]);
});

test("errors of names hide the shape of the tree, and two parents hide two roots", () => {
  assert.deepEqual(found(urdf(["a", "b"], joint("x", "b", "c") + `<link name="b"/>`)), [
    "urdf-unknown-link c",
    "urdf-duplicate-link b",
  ]);
  const text = urdf(["a", "b", "c"], `<link name="d"/>\n${joint("x", "c", "b")}`);
  assert.deepEqual(found(text), ["urdf-two-parents b"]);
});

test("names are judged beside errors of other elements, unless a link has none", () => {
  const wrong = joint("x", "a", "nowhere", "<axis/>");
  assert.deepEqual(found(urdf(["a"], wrong)), ["urdf-unknown-link nowhere", "urdf-missing-attribute <axis/"]);
  assert.deepEqual(found(urdf(["a"], `<link/>${joint("x", "a", "b")}`)), ["urdf-missing-attribute <link/"]);
});

test("each cycle and a second root are reported", () => {
  const loops = ["p", "q"].map((x) => `<link name="${x}"/>\n${joint(`j${x}`, x, x)}`);
  const text = urdf(["a", "b"], [...loops, `<link name="lost"/>`].join("\n"));
  assert.deepEqual(found(text), ["urdf-cycle <joint", "urdf-cycle <joint", "urdf-two-roots lost"]);
});

test("warnings are reported beside errors", () => {
  const text = urdf(["a"], `<drake:loop xmlns:drake="d"/>\n<lnik/>\n<link/>`);
  assert.deepEqual(found(text), [
    "urdf-closure-ignored <drake:loop",
    "urdf-unknown-element <lnik/",
    "urdf-missing-attribute <link/",
  ]);
});

test("files are looked for if the caller knows which exist", () => {
  const visual = (file, texture) =>
    `<visual><geometry><mesh filename="${file}"/></geometry><material name=""><texture filename="${texture}"/></material></visual>`;
  const text = `<robot name="r"><link name="a">${visual("a.stl", "a.png")}\n${visual("b.stl", "b.png")}</link></robot>`;
  assert.deepEqual(found(text), []);
  const missing = found(text, null, (name) => name.startsWith("a"));
  assert.deepEqual(missing, ["urdf-mesh-missing b.stl", "urdf-texture-missing b.png"]);
  assert.equal(found(text, null, () => true).length, 0);
});

test("a mimic of a URDF alone has an effect, and not in version 1", () => {
  const text = urdf(["a", "b"]).replace("</joint>", '<mimic joint="to_b"/></joint>');
  assert.deepEqual(found(text), ["urdf-mimic-cycle to_b"]);
  assert.deepEqual(found(text, "{}"), []);
});

test("hostile texts are reported, and do nothing else", () => {
  const deep = "<a>".repeat(300) + "</a>".repeat(300);
  const texts = {
    [`<robot name="r">${deep}</robot>`]: "file-too-large",
    [`<robot name="r" a="${"=".repeat(1_000_001)}"/>`]: "file-too-large",
    [`<!DOCTYPE r [<!ENTITY a "${"x".repeat(99)}">]><robot name="&a;"/>`]: "xml-doctype",
    [`<robot name="r">\u0001</robot>`]: "xml-syntax",
    [`<robot name="r"><link name="&nope;"/></robot>`]: "xml-syntax",
    "": "xml-syntax",
    "<robot": "xml-syntax",
    [`<robot xmlns:a="n" a:__proto__="x" name="r">`]: "xml-syntax",
  };
  for (const [text, code] of Object.entries(texts)) {
    assert.equal(
      reading(text)
        .diagnostics.map((each) => each.code)
        .join(),
      code,
      text.slice(0, 80),
    );
  }
});

test("names of JavaScript's own properties are names like others", () => {
  const names = ["__proto__", "constructor", "toString", "hasOwnProperty"];
  const { robot, diagnostics } = reading(urdf(names, `<__proto__/><constructor toString="1"/>`));
  assert.deepEqual(diagnostics, []);
  assert.deepEqual([...robot.links.keys()], names);
});
