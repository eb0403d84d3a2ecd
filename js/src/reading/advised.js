// What a URDF should not have, although it is valid: closures of other dialects, materials without a definition,
// names of files that do not exist, and joints without a range. EU-URD-025, -027 to -029 and -033.

import { childrenOf } from "./element_check.js";
import { WITH_RANGE } from "./elements.js";
import { valueOf } from "./xml.js";

/** Whether an element of `robot` is a closure of another dialect. */
export function isDialect({ name }) {
  const local = name.slice(name.indexOf(":") + 1);
  return ["loop", "loop_joint", "constraint", "coupling"].includes(local) || local.endsWith("_constraint");
}

/** EU-URD-027. */
export function checkDialects(root, diagnostics) {
  for (const element of root.children.filter(isDialect)) {
    const message = `<${element.name}> is of another dialect and has no effect`;
    diagnostics.report("urdf-closure-ignored", element, message, "describe it under closures or couplings");
  }
}

/** EU-URD-028, -029 and -033. `files`: whether a file exists, or undefined if that is unknown. */
export function checkAppearance(root, shapes, files, diagnostics) {
  const inShapes = childrenOf(root, "link").flatMap((link) =>
    link.children.filter(({ name }) => name === "visual" || name === "collision"),
  );
  const visuals = inShapes.filter(({ name }) => name === "visual");
  checkMaterials(childrenOf(root, "material"), visuals, diagnostics);
  if (!files) return;
  const materials = [root, ...visuals].flatMap((element) => childrenOf(element, "material"));
  checkTextures(
    materials.flatMap((material) => childrenOf(material, "texture")),
    files,
    diagnostics,
  );
  const meshes = inShapes
    .flatMap((shape) => childrenOf(shape, "geometry"))
    .filter(({ children }) => children.filter(({ name }) => Object.hasOwn(shapes, name)).length === 1)
    .flatMap((geometry) => childrenOf(geometry, "mesh"))
    .filter(({ attributes, isWrong }) => !isWrong && attributes.has("filename"));
  reportMissing("urdf-mesh-missing", "mesh", meshes.filter(isMissing(files)), diagnostics);
}

const isMissing =
  (files) =>
  ({ attributes }) =>
    !files(attributes.get("filename"));

/** Reports the first of the elements whose files do not exist. */
function reportMissing(code, kind, missing, diagnostics) {
  if (!missing.length) return;
  const others = missing.length > 1 ? `, and ${missing.length - 1} more` : "";
  const message = `the ${kind} '${missing[0].attributes.get("filename")}' does not exist${others}`;
  diagnostics.report(code, valueOf(missing[0], "filename"), message, "write a path relative to the URDF");
}

function checkTextures(textures, files, diagnostics) {
  const isNamed = ({ attributes }) => /[^ \t\n\r]/.test(attributes.get("filename") ?? "");
  const nameless = textures.find((texture) => !isNamed(texture));
  if (nameless) {
    const place = nameless.attributes.has("filename") ? valueOf(nameless, "filename") : nameless;
    diagnostics.report("urdf-texture-missing", place, "the <texture> names no file", "remove it, or add filename");
  }
  reportMissing("urdf-texture-missing", "texture", textures.filter(isNamed).filter(isMissing(files)), diagnostics);
}

/** EU-URD-029: `shared` are the materials of the robot. One without a name may be the one that is missing. */
function checkMaterials(shared, visuals, diagnostics) {
  const names = shared.map(({ attributes }) => attributes.get("name") ?? "");
  if (!names.every((name) => /[^ \t\n\r]/.test(name))) return;
  const defined = new Set(names);
  for (const material of visuals.flatMap((visual) => childrenOf(visual, "material"))) {
    const name = material.attributes.get("name");
    if (material.children.some((child) => child.name === "color" || child.name === "texture")) defined.add(name);
    else if (name === undefined || !defined.has(name)) {
      const place = name === undefined ? material : valueOf(material, "name");
      const message =
        name === undefined ? "a <material> has neither name nor color" : `no material '${name}' is defined`;
      diagnostics.report("urdf-unknown-material", place, message, "add a <color>, or define the material in <robot>");
    }
  }
}

/** EU-URD-025: of the first joint that has no range, in the URDF and in the model. */
export function checkRanges(urdf, robot, diagnostics) {
  const model = new Map(robot.joints.map((joint) => [joint.name, joint]));
  for (const { name, type, lower, upper, element } of urdf.joints.values()) {
    const joint = model.get(name);
    if (!WITH_RANGE.includes(type) || !joint || !WITH_RANGE.includes(joint.type)) continue;
    if (![lower, upper, joint.lower[0], joint.upper[0]].every((limit) => limit === 0)) continue;
    const [place] = childrenOf(element, "limit");
    const message = `joint '${name}' has no range: its position limits are 0 and 0`;
    diagnostics.report("urdf-no-range", place, message, "write lower and upper, or make it continuous or fixed");
    return;
  }
}
