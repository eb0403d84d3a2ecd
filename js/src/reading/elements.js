// Which elements and attributes a URDF has: the table of its chapter, by version of URDF (a number; 0.9 if none is
// stated). A row: required attributes, those that are names, numeric ones with their count, other ones; attributes of a
// later version, with that version; required elements, elements, and those that are repeatable. A row may be a function
// of its element.

export const WITH_AXIS = ["revolute", "continuous", "prismatic"];
export const WITH_RANGE = ["revolute", "prismatic"];
export const RATES = ["acceleration", "deceleration", "jerk"];
const MOMENTS = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];

const one = (names) => Object.fromEntries(names.map((name) => [name, 1]));

const MATERIAL = {
  optional: ["name"],
  elements: { color: { needs: ["rgba"], numbers: { rgba: 4 } }, texture: { optional: ["filename"] } },
};
const ROUND = { needs: ["radius", "length"], numbers: one(["radius", "length"]) };
const SHAPES = {
  box: { needs: ["size"], numbers: { size: 3 } },
  cylinder: ROUND,
  capsule: ROUND,
  sphere: { needs: ["radius"], numbers: { radius: 1 } },
  mesh: { needs: ["filename"], names: ["filename"], numbers: { scale: 3 } },
};
const LINKED = { needs: ["link"], names: ["link"] };

/** The rows of shapes; only a URDF that states version 1.0 has no capsule. */
export function shapesOf(version) {
  const { capsule, ...others } = SHAPES;
  return version === 1.0 ? others : SHAPES;
}

/** The row of `robot`; the rows of all other elements are in it. */
export function robotRow(version) {
  const pose = {
    origin:
      version < 1.1
        ? { numbers: { xyz: 3, rpy: 3 }, later: { quat_xyzw: "1.1" } }
        : { numbers: { xyz: 3, rpy: 3, quat_xyzw: 4 } },
  };
  const shape = { inside: ["geometry"], elements: { ...pose, geometry: {} } };
  const inertial = {
    inside: ["mass", "inertia"],
    elements: {
      ...pose,
      mass: { needs: ["value"], numbers: { value: 1 } },
      inertia: { needs: MOMENTS, numbers: one(MOMENTS) },
    },
  };
  const link = {
    needs: ["name"],
    names: ["name"],
    elements: { inertial },
    repeatable: { visual: { ...shape, elements: { ...shape.elements, material: MATERIAL } }, collision: shape },
  };
  const [ranged, unranged] = [true, false].map((isRanged) => ({
    needs: ["name", "type"],
    names: ["name"],
    inside: ["parent", "child", ...(isRanged ? ["limit"] : [])],
    elements: {
      ...pose,
      parent: LINKED,
      child: LINKED,
      axis: { needs: ["xyz"], numbers: { xyz: 3 } },
      limit: limitRow(version, isRanged),
      dynamics: { numbers: one(["damping", "friction"]) },
      mimic: { needs: ["joint"], names: ["joint"], numbers: one(["multiplier", "offset"]) },
    },
  }));
  const joint = ({ attributes }) => (WITH_RANGE.includes(attributes.get("type")) ? ranged : unranged);
  return {
    needs: ["name"],
    names: ["name"],
    repeatable: { link, joint, material: { ...MATERIAL, optional: [], needs: ["name"], names: ["name"] } },
  };
}

function limitRow(version, isRanged) {
  const numbers = one(["lower", "upper", "effort", "velocity"]);
  if (version < 1.2) {
    const later = Object.fromEntries(RATES.map((name) => [name, "1.2"]));
    return { needs: ["effort", "velocity"], numbers, later };
  }
  return { needs: isRanged ? ["lower", "upper"] : [], numbers: { ...numbers, ...one(RATES) } };
}
