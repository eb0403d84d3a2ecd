// Shapes of links as objects of three.js, in the frame of the link: m, the axis of cylinders and capsules along z.

import {
  BoxGeometry,
  CapsuleGeometry,
  Color,
  CylinderGeometry,
  Group,
  Matrix4,
  Mesh,
  MeshStandardMaterial,
  SRGBColorSpace,
  SphereGeometry,
} from "three";
import { loadMesh } from "./meshes.js";

const GRAY = [0.9, 0.9, 0.9, 1]; // of a shape without a colour
const AROUND = 40; // faces around a curved surface

/** The axis of these of three.js is y. */
const alongZ = (geometry) => geometry.rotateX(Math.PI / 2);

const GEOMETRIES = {
  box: ([x, y, z]) => new BoxGeometry(x, y, z),
  cylinder: ([radius, length]) => alongZ(new CylinderGeometry(radius, radius, length, AROUND)),
  capsule: ([radius, length]) => alongZ(new CapsuleGeometry(radius, length, 10, AROUND)),
  sphere: ([radius]) => new SphereGeometry(radius, AROUND, AROUND / 2),
};

/** The material of a colour of a URDF: red, green, blue and alpha from 0 to 1. */
export function materialOf([red, green, blue, alpha]) {
  const color = new Color().setRGB(red, green, blue, SRGBColorSpace);
  return new MeshStandardMaterial({ color, roughness: 0.55, transparent: alpha < 1, opacity: alpha });
}

/** The matrix of a pose {R, p}. */
export function matrixOf({ R, p }) {
  return new Matrix4().set(...R[0], p[0], ...R[1], p[1], ...R[2], p[2], 0, 0, 0, 1);
}

/**
 * The shapes of a link of a robot that `read` gives.
 *
 * @param link The link.
 * @param options.use "visual" or "collision".
 * @param options.mesh The content of a mesh file, by the name that the URDF gives it: (file) => Promise<ArrayBuffer>;
 *   without it, meshes are left out.
 * @param options.material The material of all shapes; by default that of the URDF, or of the mesh file.
 * @returns {object, loaded}: a Group; a promise, after the meshes are in it, of what failed: [{file, message}].
 */
export function shapesOf(link, { use = "visual", mesh, material } = {}) {
  const object = new Group();
  object.name = link.name;
  const loading = [];
  for (const shape of link.shapes.filter((each) => each.use === use)) {
    const place = new Group();
    place.matrixAutoUpdate = false;
    place.matrix.copy(matrixOf(shape.pose));
    object.add(place);
    if (shape.type !== "mesh") {
      place.add(new Mesh(GEOMETRIES[shape.type](shape.size), material ?? materialOf(shape.color ?? GRAY)));
    } else if (mesh) {
      const own = material ?? (shape.color && materialOf(shape.color));
      loading.push(placeMesh(place, shape, mesh, own));
    }
  }
  return { object, loaded: Promise.all(loading).then((each) => each.filter(Boolean)) };
}

/** Puts a mesh where it belongs; what failed, or nothing. */
async function placeMesh(place, { file, size }, mesh, material) {
  try {
    const found = await loadMesh(file, mesh);
    found.traverse((each) => {
      if (each.isMesh) each.material = material ?? each.material ?? materialOf(GRAY);
    });
    const scaled = new Group();
    scaled.scale.set(...size);
    scaled.add(found);
    place.add(scaled);
    return undefined;
  } catch (error) {
    return { file, message: error.message };
  }
}
