// Mesh files as objects of three.js: STL, OBJ, COLLADA and glTF. The coordinates are those in the file, whatever it
// says of its unit and of the direction that is up.

import { LoadingManager, Mesh } from "three";
import { ColladaLoader } from "three/addons/loaders/ColladaLoader.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { OBJLoader } from "three/addons/loaders/OBJLoader.js";
import { STLLoader } from "three/addons/loaders/STLLoader.js";

// Only what is in a file is loaded: an address in it is not followed.
const within = new LoadingManager().setURLModifier((url) => (/^(data|blob):/.test(url) ? url : "data:,"));

const text = (bytes) => new TextDecoder().decode(bytes);

const FORMATS = {
  stl: (bytes) => new Mesh(new STLLoader().parse(bytes), null),

  obj: (bytes) => {
    const found = new OBJLoader().parse(text(bytes));
    found.traverse((each) => each.isMesh && (each.material = null)); // materials are in another file
    return found;
  },

  dae: (bytes) => {
    const { scene } = new ColladaLoader(within).parse(text(bytes), "");
    scene.rotation.set(0, 0, 0);
    scene.scale.set(1, 1, 1);
    return scene;
  },

  gltf: async (bytes, file, open) => {
    const document = JSON.parse(text(bytes));
    for (const each of [...(document.buffers ?? []), ...(document.images ?? [])]) {
      if (each.uri && !each.uri.startsWith("data:")) each.uri = await embedded(await open(beside(file, each.uri)));
    }
    return (await new GLTFLoader(within).parseAsync(JSON.stringify(document), "")).scene;
  },

  glb: async (bytes) => (await new GLTFLoader(within).parseAsync(bytes, "")).scene,
};

/** The name of a file that another one names from its folder. */
const beside = (file, name) => file.slice(0, file.lastIndexOf("/") + 1) + decodeURIComponent(name);

const embedded = (bytes) =>
  new Promise((done, failed) => {
    const reader = new FileReader();
    reader.onload = () => done(reader.result);
    reader.onerror = () => failed(reader.error);
    reader.readAsDataURL(new Blob([bytes]));
  });

/**
 * The mesh in a file.
 *
 * @param file Its name, whose ending says the format.
 * @param open The content of a file by its name: (file) => Promise<ArrayBuffer>.
 * @returns A promise of an Object3D; it rejects if the format is not known, or the file is none of it.
 */
export async function loadMesh(file, open) {
  const ending = file.slice(file.lastIndexOf(".") + 1).toLowerCase();
  if (!Object.hasOwn(FORMATS, ending)) {
    throw new Error(`the ending .${ending} is not that of a mesh; write it as STL, OBJ, COLLADA or glTF`);
  }
  return FORMATS[ending](await open(file), file, open);
}
