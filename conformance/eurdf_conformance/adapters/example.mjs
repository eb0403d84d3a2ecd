// A complete adapter in JavaScript, of a toy parser of version 1: --parser="cmd:node example.mjs"
// Two libraries read the files: npm install yaml @xmldom/xmldom

import { readFileSync } from "node:fs";
import { createInterface } from "node:readline";
import { DOMParser, onErrorStopParsing as onError } from "@xmldom/xmldom";
import { parse as parseYaml } from "yaml";

class Wrong extends Error {} // what the parser throws for wrong files, ...
class Lacking extends Error {} // ... and for a feature that it lacks

const ROUND = ["radius", "length"];
const SIZES = { box: ["size"], cylinder: ROUND, capsule: ROUND, sphere: ["radius"], mesh: ["scale"] };

// The adapter: what it answers to each command.
const parser = { name: "example", version: "0.1", language: "JavaScript" };
const lacks = ["planar", "floating", "spherical", "universal"];
const answers = {
  start: () => ({ outcome: "started", protocol: "1.0", parser, claims: { 1: ["accept", "structure"] }, lacks }),
  load: (request) => ({ outcome: "accepted", robot: read(request.description, request.urdf), issues: [] }),
  evaluate: () => ({ outcome: "unsupported", feature: "evaluate" }),
  stop: () => ({ outcome: "stopped" }),
};

function answer(request) {
  try {
    return answers[request.command](request);
  } catch (error) {
    if (error instanceof Wrong) return { outcome: "rejected", issues: [{ message: error.message }] };
    if (error instanceof Lacking) return { outcome: "unsupported", feature: error.message };
    return { outcome: "errored", message: error.stack };
  }
}

for await (const line of createInterface({ input: process.stdin })) {
  const request = JSON.parse(line);
  process.stdout.write(JSON.stringify({ id: request.id, ...answer(request) }) + "\n");
  if (request.command === "stop") process.exit();
}

// The parser: the robot as a canonical description.
function read(description, urdf) {
  const { closed_loop = [], type, name_mot = [], ...rest } = parsed(description, parseYaml) ?? {};
  if ("extended_urdf" in rest) throw new Lacking("version 2");
  if ("joint_name" in rest) throw new Lacking(String(rest.joint_type).includes("UJOINT") ? "universal" : "spherical");
  const types = (type ?? closed_loop.map(() => "6d")).map((each) => String(each).toLowerCase());
  if (types.some((each) => each !== "3d" && each !== "6d")) throw new Wrong("a closure is 3d or 6d");
  if (types.length !== closed_loop.length) throw new Wrong("type and closed_loop differ in length");
  const tree = parsed(urdf, (text) => new DOMParser({ onError }).parseFromString(text, "text/xml").documentElement);
  const links = children(tree, "link").map((link) => link.getAttribute("name"));
  const joints = children(tree, "joint").map(jointOf);
  const bodies = new Map([...links.map((link) => [link, link]), ...joints.map((joint) => [joint.name, joint.child])]);
  const closures = closed_loop.map((pair, i) => {
    if (!pair.every((frame) => bodies.has(frame))) throw new Wrong(`there is no such frame among ${pair}`);
    return { name: `closure_${i + 1}`, type: types[i], a: bodies.get(pair[0]), b: bodies.get(pair[1]) };
  });
  const robot = { name: tree.getAttribute("name"), version: "1", root: "fixed", links, frames: [], closures };
  robot.shapes = children(tree, "link").flatMap((link) =>
    ["visual", "collision"].flatMap((use) => children(link, use).map((element) => shapeOf(link, use, element))),
  );
  robot.joints = joints.filter((joint) => joint.type !== "fixed");
  robot.actuators = name_mot.map((joint) => ({ joint }));
  robot.own = Object.fromEntries(Object.entries(rest).map(([key, value]) => [`/${key}`, value]));
  return { ...robot, configurations: {} };
}

function jointOf(joint) {
  const said = (tag, key, absent) => children(joint, tag)[0]?.getAttribute(key) ?? absent;
  const type = joint.getAttribute("type");
  if (["planar", "floating"].includes(type)) throw new Lacking(type);
  const read = { name: joint.getAttribute("name"), type, parent: said("parent", "link"), child: said("child", "link") };
  for (const key of ["lower", "upper"]) read[key] = [type === "continuous" ? null : number(said("limit", key, "0"))];
  for (const key of ["velocity", "effort"]) read[key] = [said("limit", key) ? number(said("limit", key)) : null];
  for (const key of ["damping", "friction"]) read[key] = [number(said("dynamics", key, "0"))];
  return { ...read, armature: [0] };
}

function shapeOf(link, use, element) {
  const numbers = (text) => text.trim().split(/\s+/).map(number);
  const origin = children(element, "origin")[0];
  const [r, p, y] = numbers(origin?.getAttribute("rpy") || "0 0 0");
  const { sin, cos } = Math;
  const rotation = [
    [cos(y) * cos(p), cos(y) * sin(p) * sin(r) - sin(y) * cos(r), cos(y) * sin(p) * cos(r) + sin(y) * sin(r)],
    [sin(y) * cos(p), sin(y) * sin(p) * sin(r) + cos(y) * cos(r), sin(y) * sin(p) * cos(r) - cos(y) * sin(r)],
    [-sin(p), cos(p) * sin(r), cos(p) * cos(r)],
  ];
  const pose = { rotation, translation: numbers(origin?.getAttribute("xyz") || "0 0 0") };
  const geometry = children(element, "geometry")[0];
  const [type, sizes] = Object.entries(SIZES).find(([tag]) => children(geometry, tag).length);
  const shape = children(geometry, type)[0];
  const size = sizes.flatMap((key) => numbers(shape.getAttribute(key) || "1 1 1"));
  const file = shape.getAttribute("filename") || undefined;
  return { link: link.getAttribute("name"), use, type, size, file, pose };
}

function children(element, tag) {
  return Array.from(element.childNodes).filter((child) => child.nodeName === tag);
}

function number(text) {
  if (!Number.isFinite(Number(text))) throw new Wrong(`'${text}' is not a number`); // which JSON would make null
  return Number(text);
}

function parsed(path, parse) {
  try {
    return parse(new TextDecoder("utf-8", { fatal: true }).decode(readFileSync(path)));
  } catch (error) {
    throw new Wrong(`${path}: ${error.message}`);
  }
}
