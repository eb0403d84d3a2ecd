// A configuration written into the text of a description of version 2. All else stays as it is, also comments.

import { isMap, isScalar, parse, parseDocument } from "yaml";

const DIGITS = 12; // behind the point: m, rad, and parts of quaternions

/**
 * The text with a named configuration added, or its coordinates replaced; joints that it leaves out stay left out
 * where they are neutral.
 *
 * @param q {joint: [coordinates]} of all joints that have coordinates of their own; so is `neutral`.
 */
export function withConfiguration(text, name, q, neutral) {
  const wanted = parse(text);
  const stated = wanted.configurations?.[name] ?? {};
  const values = {};
  for (const [joint, own] of Object.entries(q)) {
    const written = own.map((value) => Number(value.toFixed(DIGITS)));
    const isNeutral = written.every((value, index) => value === neutral[joint][index]);
    if (!isNeutral || joint in stated) values[joint] = written.length === 1 ? written[0] : written;
  }
  wanted.configurations = { ...wanted.configurations, [name]: { ...stated, ...values } };
  const edited = edit(text, name, values);
  if (edited !== null && same(edited, wanted)) return edited;
  // An unusual form, such as an alias: rewritten from its tree, with its other comments.
  const document = parseDocument(text);
  document.set("configurations", document.createNode(wanted.configurations));
  return document.toString({ lineWidth: 0 });
}

function same(text, wanted) {
  try {
    return JSON.stringify(sorted(parse(text))) === JSON.stringify(sorted(wanted));
  } catch {
    return false;
  }
}

function sorted(value) {
  if (Array.isArray(value)) return value.map(sorted);
  if (value === null || typeof value !== "object") return value;
  return Object.entries(value)
    .sort(([a], [b]) => (a < b ? -1 : 1))
    .map(([key, each]) => [key, sorted(each)]);
}

/** The text with the parts replaced that differ; null where that is not simple. */
function edit(text, name, values) {
  const root = parseDocument(text).contents;
  const configurations = root.get("configurations", true);
  if (!configurations) return withEntry(text, root, "configurations", `\n  ${key(name)}: ${flow(values)}`);
  if (!isMap(configurations)) return null;
  const own = configurations.get(name, true);
  if (!own) return withEntry(text, configurations, name, ` ${flow(values)}`);
  if (!isMap(own)) return null;
  let edited = text;
  const missing = Object.entries(values).filter(([joint]) => !own.has(joint));
  if (missing.length) {
    const list = missing.map(([joint, value]) => [joint, ` ${written(value)}`]);
    edited = own.items.length
      ? list.reduceRight((now, each) => now && withEntry(now, own, ...each), edited)
      : splice(edited, own, flow(values));
    if (edited === null) return null;
  }
  // From the end, so that ranges before it stay right.
  for (const { key: joint, value } of [...own.items].reverse()) {
    if (!isScalar(joint) || !value?.range) return null;
    if (joint.value in values) edited = splice(edited, value, written(values[joint.value]));
  }
  return edited;
}

/** A mapping with one more entry behind its last one; null where it has none, or no place for it. */
function withEntry(text, map, name, value) {
  const last = map.items.at(-1);
  if (!last?.value?.range) return null;
  const end = last.value.range[1];
  if (map.flow) return `${text.slice(0, end)}, ${key(name)}:${value}${text.slice(end)}`;
  const begin = last.key.range[0];
  const indent = text.slice(text.lastIndexOf("\n", begin - 1) + 1, begin);
  if (indent.trim()) return null;
  // Behind a comment on its line.
  const line = text.indexOf("\n", end - (text[end - 1] === "\n"));
  const at = line < 0 ? text.length : line;
  return `${text.slice(0, at)}\n${indent}${key(name)}:${value.replaceAll("\n", `\n${indent}`)}${text.slice(at) || "\n"}`;
}

const splice = (text, { range: [begin, end] }, value) => text.slice(0, begin) + value + text.slice(end);

const flow = (values) =>
  `{${Object.entries(values)
    .map(([joint, value]) => `${key(joint)}: ${written(value)}`)
    .join(", ")}}`;

/** A number or a list of numbers. */
const written = (value) => JSON.stringify(value).replaceAll(",", ", ");

/** A key as text that YAML reads as this string, also in braces. */
const key = (name) => (/^[A-Za-z_][\w-]*$/.test(name) && parse(name) === name ? name : JSON.stringify(name));
