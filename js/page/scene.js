// The robot of a session as objects of three.js: the shapes of its links, red where a limit is reached, and its loops.

import { Box3, Color, Group, Vector3 } from "three";
import { matrixOf, shapesOf } from "../src/three/shapes.js";
import { Loops } from "./loops.js";
import { Marks, RED } from "./marks.js";

const AT_LIMIT = new Color(RED);
const TRANSLUCENT = 0.22; // opacity of shapes behind which loops are shown

export class RobotScene extends Group {
  /**
   * @param session The robot; `place` brings the scene to where it is.
   * @param mesh The content of a mesh file by its name: (file) => Promise<ArrayBuffer>.
   */
  constructor(session, mesh) {
    super();
    this.session = session;
    this.links = new Map();
    this.parts = []; // the drawn meshes: {mesh, link, color, opacity}
    this.bones = null;
    this.translucent = false;
    this.dark = 0; // colours whose luminance is below are lightened
    const loading = [...session.robot.links.values()].map((link) => {
      const { object, loaded } = shapesOf(link, { mesh });
      object.matrixAutoUpdate = false;
      this.links.set(link.name, object);
      this.add(object);
      this.collect(link.name);
      return loaded.then((failed) => {
        this.collect(link.name);
        return failed;
      });
    });
    /** Settled when all meshes are drawn: [{file, message}] of those that are not. */
    this.loaded = Promise.all(loading).then((each) => {
      const failed = each.flat();
      if (failed.length) this.addBones();
      this.place();
      return failed;
    });
    this.placeLinks();
    this.measure();
    this.loops = new Loops(session.robot, this.size);
    this.add(this.loops);
    const shapes = [...session.robot.links.values()].flatMap((link) => link.shapes);
    if (!shapes.some(({ use }) => use === "visual")) this.addBones();
    this.place();
  }

  /** Bring everything to where the session is. */
  place() {
    this.placeLinks();
    this.loops.place(this.session);
    this.placeBones?.forEach((place) => place(this.session.kinematics));
    this.paint();
  }

  placeLinks() {
    const { kinematics } = this.session;
    for (const [name, object] of this.links) object.matrix.copy(matrixOf(kinematics.pose(name)));
    this.updateMatrixWorld(true);
  }

  /** The box around the robot in the world, and its diagonal, m. */
  measure() {
    this.box = new Box3();
    for (const object of this.links.values()) {
      this.box.expandByObject(object);
      this.box.expandByPoint(new Vector3().setFromMatrixPosition(object.matrixWorld));
    }
    this.size = this.box.getSize(new Vector3()).length() || 1;
  }

  /** Give each drawn mesh of a link a material of its own, so that it can turn red, and shadows. */
  collect(link) {
    this.links.get(link).traverse((mesh) => {
      if (!mesh.isMesh || mesh.userData.link) return;
      mesh.userData.link = link;
      mesh.castShadow = mesh.receiveShadow = true;
      mesh.material = Array.isArray(mesh.material) ? mesh.material.map((each) => each.clone()) : mesh.material.clone();
      for (const material of [mesh.material].flat())
        this.parts.push({ mesh, link, material, color: material.color?.clone(), opacity: material.opacity });
    });
  }

  /** A robot without shapes, or with a mesh that is not drawn, has lines between its links; each is a part of the upper link. */
  addBones() {
    this.bones = new Marks();
    this.placeBones = this.bones.skeleton(this.session.robot, 0.004 * this.size);
    this.add(this.bones);
  }

  /** The meshes that can be grabbed; each says its link in its data. */
  get grabbed() {
    return [...new Set(this.parts.map(({ mesh }) => mesh)), ...(this.bones?.children ?? [])];
  }

  /** Colours and opacity of the parts; a part whose joint is at a limit is red. */
  paint() {
    const { atLimits, stop, robot } = this.session;
    const stopped = robot.joints.filter(({ name }) => atLimits.has(name) || stop?.joint === name);
    const red = new Set(stopped.map((joint) => joint.child));
    for (const { link, material, color, opacity } of this.parts) {
      if (color) lighten(material.color.copy(color), this.dark);
      if (color && red.has(link)) material.color.lerp(AT_LIMIT, 0.7);
      const alpha = this.translucent ? TRANSLUCENT * opacity : opacity;
      if (material.transparent !== alpha < 1) material.needsUpdate = true;
      material.transparent = alpha < 1;
      material.opacity = alpha;
      material.depthWrite = alpha === 1;
    }
  }

  dispose() {
    for (const { mesh, material } of this.parts) {
      mesh.geometry.dispose();
      material.dispose();
    }
  }
}

/** A luminance y below `dark` becomes (y + dark) / 2. */
function lighten(color, dark) {
  const luminance = 0.2126 * color.r + 0.7152 * color.g + 0.0722 * color.b;
  if (luminance < dark) color.lerp(new Color(1, 1, 1), (0.5 * (dark - luminance)) / (1 - luminance));
}
