// The table of types, coordinates and velocities: the chapter on joints.

/** `coordinates`: the kind of each; `velocities`: how many; `limited`: whether it has position limits. */
export const JOINT_TYPES = {
  fixed: { coordinates: [], velocities: 0, limited: false },
  revolute: { coordinates: ["angle"], velocities: 1, limited: true },
  continuous: { coordinates: ["angle"], velocities: 1, limited: false },
  prismatic: { coordinates: ["length"], velocities: 1, limited: true },
  helical: { coordinates: ["angle"], velocities: 1, limited: true },
  cylindrical: { coordinates: ["length", "angle"], velocities: 2, limited: true },
  universal: { coordinates: ["angle", "angle"], velocities: 2, limited: true },
  planar: { coordinates: ["length", "length", "angle"], velocities: 3, limited: false },
  spherical: { coordinates: Array(4).fill("quaternion"), velocities: 3, limited: false },
  floating: {
    coordinates: [...Array(3).fill("length"), ...Array(4).fill("quaternion")],
    velocities: 6,
    limited: false,
  },
};

/** The coordinates at the neutral. */
export function neutral(type) {
  const { coordinates } = JOINT_TYPES[type];
  return coordinates.map((kind, i) => (kind === "quaternion" && i === coordinates.length - 1 ? 1 : 0));
}

/** Where the quaternion begins in the coordinates of a type, or -1. */
export const quaternionAt = (type) => JOINT_TYPES[type].coordinates.indexOf("quaternion");
