// The elements of a URDF against their table: EU-URD-004 to -008, -012, -013, -019, -020, -024, -026, -030, -036, -038,
// -040 and -041.

import { RATES, WITH_AXIS, WITH_RANGE, robotRow, shapesOf } from "./elements.js";
import { isNear, meant } from "./near.js";
import { allowedSizes, isNone } from "./numbers.js";
import { valueOf } from "./xml.js";

const TYPES = ["revolute", "continuous", "prismatic", "planar", "floating", "fixed"];
const NUMBER = /^[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?$/;
const MAGNITUDES = ["effort", "velocity", ...RATES];
const NOT_NEGATIVE = [...MAGNITUDES, "damping", "friction"];
const KINDS = new Map([
  ["lower", "lower"],
  ["multiplier", "divisor"],
  ...["upper", ...MAGNITUDES].map((name) => [name, "upper"]),
]);

/** The numbers that a text has, NaN where a word is no decimal number. */
export function decimals(text) {
  const words = text.split(/[ \t\n\r]+/).filter(Boolean);
  return words.map((word) => (NUMBER.test(word) ? Number(word) : NaN));
}

/** The children of an element with that name. */
export const childrenOf = (element, name) => element.children.filter((each) => each.name === name);

/** The numbers of an attribute of the child `tag`, null where a limit is none; `absent` if it is left out. */
export function numbersOf(element, tag, name, absent) {
  return childrenOf(element, tag)[0]?.numbers.get(name) ?? absent;
}

/** Checks the elements below `root`, and gives each that is in the table its `numbers`; whether there is no error. */
export function checkElements(root, version, withMimics, diagnostics) {
  return new Check(version, withMimics, diagnostics).run(root);
}

class Check {
  constructor(version, withMimics, diagnostics) {
    this.version = version;
    this.withMimics = withMimics;
    this.shapes = shapesOf(version);
    this.diagnostics = diagnostics;
    this.seenLater = new Set();
    this.errors = 0;
  }

  run(root) {
    this.element(root, "<robot>", robotRow(this.version));
    return this.errors === 0;
  }

  error(code, place, message, hint) {
    this.errors += 1;
    this.diagnostics.report(code, place, message, hint);
  }

  element(element, where, row) {
    const { needs = [], names = [], numbers = {}, optional = [], later = {} } = row;
    const { attributes } = element;
    for (const [name, since] of Object.entries(later)) {
      if (attributes.has(name)) this.later(name, valueOf(element, name), since, `${name} of ${where}`);
    }
    const unknown = [...attributes.keys()].filter(
      (name) => ![needs, optional, Object.keys(numbers), Object.keys(later)].some((known) => known.includes(name)),
    );
    const left = [...optional, ...Object.keys(numbers)].filter((name) => !needs.includes(name));
    for (const name of unknown) this.near({ ...element, part: name }, name, left, `attribute ${name} of ${where}`);
    const missing = needs.filter((name) => !attributes.has(name));
    if (missing.length) {
      const said = unknown.find((name) => isNear(name, missing[0]));
      const hint = said ? `write ${missing[0]} for ${said}` : `add ${missing.map((name) => `${name}="…"`).join(" ")}`;
      this.error("urdf-missing-attribute", element, `${where} has no ${missing.join(", ")}`, hint);
    }
    for (const name of names) {
      if (!attributes.has(name) || /[^ \t\n\r]/.test(attributes.get(name))) continue;
      this.error("urdf-empty-name", valueOf(element, name), `the ${name} of ${where} is empty`, "write a name");
    }
    element.numbers = new Map();
    for (const [name, count] of Object.entries(numbers)) this.numbers(element, name, count, where);
    this.children(element, where, row);
    if (["origin", "geometry", "joint"].includes(element.name)) this[element.name](element, where);
  }

  /** An attribute or element that URDF has from a later version on, EU-URD-038. */
  later(name, place, since, what) {
    if (this.seenLater.has(name)) return;
    this.seenLater.add(name);
    const message = `${what} is of URDF ${since}, which the robot does not state`;
    this.diagnostics.report("urdf-later-version", place, message, `state version="${since}" in <robot>`);
  }

  /** EU-URD-026; whether the name is near a known one. */
  near(place, name, known, what) {
    const right = name.includes(":") ? undefined : known.find((each) => isNear(name, each));
    if (right === undefined) return false;
    this.diagnostics.report("urdf-unknown-element", place, `${what} is unknown and has no effect`, `write ${right}`);
    return true;
  }

  children(element, where, { inside = [], elements = {}, repeatable = {} }) {
    const known = new Map(Object.entries({ ...elements, ...repeatable }));
    const optional = [...known.keys()].filter((name) => !inside.includes(name));
    const counts = new Map();
    const far = new Set(); // names that are near none
    for (const child of element.children) {
      if (far.has(child.name)) continue;
      const row = known.get(child.name);
      const what = `<${child.name}> in ${where}`;
      if (!row) {
        if (!this.near(child, child.name, optional, what)) far.add(child.name);
        continue;
      }
      counts.set(child.name, (counts.get(child.name) ?? 0) + 1);
      if (Object.hasOwn(elements, child.name) && counts.get(child.name) === 2) {
        this.error("urdf-repeated-element", child, `${where} has more than one <${child.name}>`, "keep one of them");
      }
      const isNamed = child.name === "link" || child.name === "joint";
      const name = isNamed && `${child.name} '${child.attributes.get("name")}'`;
      this.element(
        child,
        isNamed && child.attributes.has("name") ? name : what,
        row instanceof Function ? row(child) : row,
      );
    }
    const missing = inside.filter((name) => !counts.has(name));
    if (!missing.length) return;
    const listed = missing.map((name) => `<${name}>`).join(", ");
    this.error("urdf-missing-element", element, `${where} has no ${listed}`, `add ${listed}`);
  }

  /** The numbers of an attribute, EU-URD-007, null where a limit is none. */
  numbers(element, name, count, where) {
    const text = element.attributes.get(name);
    if (text === undefined) return;
    const values = decimals(text);
    const what = `${name} of ${where}`;
    const place = valueOf(element, name);
    if (values.length !== count || !values.every(Number.isFinite)) {
      const wanted = count === 1 ? "one finite decimal number" : `${count} finite decimal numbers`;
      this.error(
        "urdf-bad-number",
        place,
        `${what} is '${text}', not ${wanted}`,
        `write ${wanted}, separated by spaces`,
      );
      return;
    }
    const kind = KINDS.get(name);
    const [sizes] = values.map((value) => allowedSizes(value, kind)).filter(Boolean);
    if (sizes) {
      const message = `${what} is '${text}', and not ${sizes}`;
      this.error("number-out-of-bounds", place, message, "correct the exponent or the unit");
      return;
    }
    element.numbers.set(
      name,
      values.map((value) => (isNone(value, kind) ? null : value)),
    );
    if (NOT_NEGATIVE.includes(name) && values[0] < 0) {
      this.error("urdf-negative-limit", place, `${what} is ${values[0]}, below 0`, "remove the sign");
    }
  }

  origin(element, where) {
    if (this.version < 1.1 || !element.attributes.has("quat_xyzw")) return;
    const place = valueOf(element, "quat_xyzw");
    if (element.attributes.has("rpy")) {
      this.error("urdf-two-orientations", place, `${where} has both rpy and quat_xyzw`, "remove one of them");
    }
    if (element.numbers.get("quat_xyzw")?.every((number) => number === 0)) {
      this.error("urdf-zero-quaternion", place, `the quaternion of ${where} is zero`, "for no rotation, write 0 0 0 1");
    }
  }

  geometry(element, where) {
    const shapes = element.children.filter(({ name }) => Object.hasOwn(this.shapes, name));
    if (shapes.length !== 1) {
      const other = shapes.length || element.children.length !== 1 ? element : element.children[0];
      const known = Object.keys(this.shapes).join(", ");
      const message = `${where} contains ${shapes.length ? `${shapes.length} shapes` : "no shape"}`;
      this.error("urdf-geometry", other, message, `write one of ${known}; other shapes need a <visual> of their own`);
      return;
    }
    const [shape] = shapes;
    const before = this.errors;
    this.shape(shape, `<${shape.name}> in ${where}`);
    shape.isWrong = this.errors > before; // which hides that its file does not exist
  }

  shape(shape, what) {
    if (shape.name === "capsule" && this.version < 1.0) this.later("capsule", shape, "1.1", what);
    this.element(shape, what, this.shapes[shape.name]);
    const isMesh = shape.name === "mesh";
    const sizes = [...shape.numbers.values()].flat();
    if (sizes.every((size) => (isMesh ? size !== 0 : size > 0))) return;
    const message = `${what} has the ${isMesh ? "scale" : "size"} ${sizes.join(" ")}`;
    const hint = isMesh ? "write a scale that is not zero on any axis" : "write sizes above 0";
    this.error("urdf-geometry", isMesh ? valueOf(shape, "scale") : shape, message, hint);
  }

  joint(element, where) {
    const type = element.attributes.get("type");
    if (type === undefined) return;
    if (!TYPES.includes(type)) {
      const message = `${where} has the type '${type}', not one of ${TYPES.join(", ")}`;
      this.error("urdf-joint-type", valueOf(element, "type"), message, meant(type, TYPES));
      return;
    }
    this.jointAxis(element, type, where);
    const [mimic] = childrenOf(element, "mimic");
    if (mimic && type === "fixed" && this.withMimics) {
      this.diagnostics.report("urdf-mimic-fixed", mimic, `${where} is fixed: its <mimic> has no effect`, "remove it");
    }
    const [limit] = childrenOf(element, "limit");
    if (!limit || !(this.version >= 1.2 || WITH_RANGE.includes(type))) return;
    const absent = this.version >= 1.2 ? [null] : [0];
    const read = (name) => (limit.attributes.has(name) ? (limit.numbers.get(name) ?? [null]) : absent)[0];
    const [lower, upper] = [read("lower"), read("upper")];
    if (lower === null || upper === null || lower <= upper) return;
    const place = limit.attributes.has("lower") ? valueOf(limit, "lower") : limit;
    const message = `the lower limit ${lower} of ${where} is greater than the upper limit ${upper}`;
    this.error("urdf-reversed-limits", place, message, "write the smaller one as lower");
  }

  jointAxis(element, type, where) {
    const xyz = numbersOf(element, "axis", "xyz", null);
    if (!xyz) return;
    const place = valueOf(childrenOf(element, "axis")[0], "xyz");
    if (WITH_AXIS.includes(type) && xyz.every((number) => number === 0)) {
      this.error("urdf-zero-axis", place, `the axis of ${where} is zero`, "write the direction of the axis");
    }
    if (type === "planar" && (xyz[0] !== 0 || xyz[1] !== 0)) {
      const message = `the axis of ${where} is ${xyz.join(" ")}, but a planar joint moves in the xy plane of its frame`;
      this.diagnostics.report("urdf-planar-axis", place, message, "write 0 0 1, and turn the frame by rpy of <origin>");
    }
  }
}
