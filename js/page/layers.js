// What can be shown of a robot beside its visual shapes: the layers of a scene, and a ghost of a configuration.

import { AxesHelper, Group, Matrix4, Mesh, MeshStandardMaterial, SphereGeometry, Vector3 } from "three";
import { matrixOf, shapesOf } from "../src/three/shapes.js";
import { Labels } from "./labels.js";
import { Marks } from "./marks.js";

const COLLISION = new MeshStandardMaterial({ color: 0xf59f00, transparent: true, opacity: 0.45, depthWrite: false });
const INERTIA = new MeshStandardMaterial({ color: 0x4263eb, transparent: true, opacity: 0.4, depthWrite: false });
const GHOST = new MeshStandardMaterial({ color: 0x74a0d8, transparent: true, opacity: 0.3, depthWrite: false, polygonOffset: true, polygonOffsetFactor: 1 });
const MASS = 0xe8590c;
export const AXES = { motor: 0x2b8a3e, passive: 0x1c7ed6, dependent: 0xf08c00 };

const BALL = new SphereGeometry(1, 32, 20);

/** Layers by name; each is made when it is first shown. */
const LAYERS = {
  collision: (layers) => layers.shapesOf(COLLISION, "collision"),
  skeleton: (layers) => layers.skeleton(),
  axes: (layers) => layers.axes(),
  frames: (layers) => layers.frames(),
  origins: (layers) => layers.origins(),
  inertias: (layers) => layers.inertias(),
  mass: (layers) => layers.centerOfMass(),
  names: (layers) => layers.names(),
  ghost: (layers) => layers.ghost(),
};

/** The layers that a robot can have: [name, title]. */
export function layersOf({ robot, configurations }) {
  const links = [...robot.links.values()];
  const has = (use) => links.some(({ shapes }) => shapes.some((shape) => shape.use === use));
  return [
    has("visual") && ["visual", "Visual shapes"],
    has("visual") && ["translucent", "Translucent shapes"],
    has("collision") && ["collision", "Collision shapes"],
    robot.joints.length && ["skeleton", "Skeleton"],
    robot.closures.length && ["closures", "Closures"],
    robot.joints.some(({ type }) => type !== "fixed") && ["axes", "Joint axes"],
    robot.frameNames.length && ["frames", "Frames"],
    ["origins", "Link frames"],
    links.some(({ inertia, mass }) => inertia && mass) && ["inertias", "Inertia ellipsoids"],
    links.some(({ mass }) => mass) && ["mass", "Center of mass"],
    ["names", "Link names"],
    configurations.has("assembled") && has("visual") && ["ghost", "Ghost of “assembled”"],
  ].filter(Boolean);
}

export class Layers extends Group {
  /**
   * @param scene The RobotScene to add them to.
   * @param options.mesh As of the scene.
   * @param options.viewport Where labels are shown.
   * @param options.dependent Names of the actuators that depend on one another.
   */
  constructor(scene, { mesh, viewport, dependent = [] }) {
    super();
    Object.assign(this, { scene, mesh, viewport, session: scene.session, dependent: new Set(dependent) });
    this.made = new Map(); // {object, place} by name
    this.shown = new Set();
    scene.add(this);
  }

  /** Show or hide a layer. */
  show(name, on) {
    this.shown[on ? "add" : "delete"](name);
    const { scene } = this;
    if (name === "visual") for (const link of scene.links.values()) link.visible = on;
    else if (name === "translucent") scene.translucent = on;
    else if (name === "closures") scene.loops.shown = on;
    else {
      if (on && !this.made.has(name)) {
        this.made.set(name, LAYERS[name](this));
        this.add(this.made.get(name).object);
      }
      if (this.made.has(name)) this.made.get(name).object.visible = on;
    }
    scene.place();
    this.place();
  }

  /** Bring what is shown to where the session is. */
  place() {
    for (const [name, { place }] of this.made) if (this.shown.has(name)) place?.();
    this.updateMatrixWorld(true);
    this.viewport.draw(true);
  }

  dispose() {
    this.labels?.dispose();
  }

  /** A group for each link, which moves with it. */
  onLinks(fill, poseOf = (link) => this.session.kinematics.pose(link)) {
    const object = new Group();
    const groups = [...this.session.robot.links.values()].map((link) => {
      const group = new Group();
      group.matrixAutoUpdate = false;
      fill(group, link);
      object.add(group);
      return [link.name, group];
    });
    const place = () => {
      for (const [name, group] of groups) group.matrix.copy(matrixOf(poseOf(name)));
    };
    return { object, place };
  }

  shapesOf(material, use, poseOf) {
    return this.onLinks((group, link) => {
      const { object, loaded } = shapesOf(link, { use, mesh: this.mesh, material });
      group.add(object);
      loaded.then(() => this.place());
    }, poseOf);
  }

  ghost() {
    const { mechanism, configurations } = this.session;
    const kinematics = mechanism.at(configurations.get("assembled"));
    return this.shapesOf(GHOST, "visual", (link) => kinematics.pose(link));
  }

  /** Rods and balls, and what brings them to where the robot is. */
  marks(fill) {
    const object = new Marks();
    const each = fill(object, this.scene.size);
    return { object, place: () => each.forEach((place) => place(this.session.kinematics)) };
  }

  skeleton() {
    return this.marks((marks, size) => marks.skeleton(this.session.robot, 0.003 * size));
  }

  /** The axes of moving joints: motors green, passive joints blue, dependent actuators orange. */
  axes() {
    const { robot } = this.session;
    const motors = new Set(robot.actuators.map(({ joint }) => joint));
    return this.marks((marks, size) =>
      robot.joints
        .filter(({ type }) => type !== "fixed" && type !== "floating")
        .flatMap((joint) => {
          const kind = this.dependent.has(joint.name) ? "dependent" : motors.has(joint.name) ? "motor" : "passive";
          // A planar or spherical joint has those of its frame.
          const axes = joint.axes.length && joint.type !== "planar" ? joint.axes : [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
          return axes.map((axis) => {
            const rod = marks.rod(0.004 * size, AXES[kind]);
            return (kinematics) => {
              // They turn with the child, in which the frame that the joint moves is where `after` leads from.
              const moved = matrixOf(kinematics.pose(joint.child)).multiply(matrixOf(joint.after).invert());
              const [from, to] = [-1, 1].map((side) => along(moved, axis, 0.05 * side * size));
              rod.span(from, to);
            };
          });
        }),
    );
  }

  frames() {
    const { robot } = this.session;
    const names = robot.frameNames.map((name, i) => ({ name, frame: robot.allFrames[i] }));
    const found = this.axesHelpers(names.map(({ frame }) => (kinematics) => kinematics.pose(frame)));
    this.label(found.object, names.map(({ name, frame }) => [name, (kinematics) => kinematics.pose(frame).p]));
    return found;
  }

  origins() {
    return this.axesHelpers([...this.session.robot.links.keys()].map((link) => (kinematics) => kinematics.pose(link)));
  }

  axesHelpers(poses) {
    const object = new Group();
    const each = poses.map((poseOf) => {
      const axes = new AxesHelper(0.06 * this.scene.size);
      axes.material.depthTest = false;
      axes.renderOrder = 11;
      axes.matrixAutoUpdate = false;
      object.add(axes);
      return () => axes.matrix.copy(matrixOf(poseOf(this.session.kinematics)));
    });
    return { object, place: () => each.forEach((place) => place()) };
  }

  /** For each link the ellipsoid of constant density with its mass and moments of inertia. */
  inertias() {
    return this.onLinks((group, { inertia, mass }) => {
      if (!inertia || !mass) return;
      const ball = new Mesh(BALL, INERTIA);
      ball.matrixAutoUpdate = false;
      ball.matrix.copy(matrixOf(inertia.pose)).multiply(ellipsoid(inertia.matrix, mass));
      group.add(ball);
    });
  }

  /** A ball, and a line down to the ground. */
  centerOfMass() {
    const ground = this.scene.box.min.z;
    return this.marks((marks, size) => {
      const ball = marks.ball(0.015 * size, MASS);
      const rod = marks.rod(0.002 * size, MASS);
      return [
        (kinematics) => {
          const [x, y, z] = kinematics.centerOfMass();
          ball.position.set(x, y, z);
          rod.span([x, y, z], [x, y, ground]);
        },
      ];
    });
  }

  names() {
    const object = new Group();
    this.label(object, [...this.session.robot.links.keys()].map((link) => [link, (kinematics) => kinematics.pose(link).p]));
    return { object };
  }

  /** Names that are shown while an object is visible. */
  label(object, names) {
    this.labels ??= new Labels(this.viewport);
    for (const [text, pointOf] of names) {
      this.labels.add(text, () => object.visible && this.scene.localToWorld(vector(pointOf(this.session.kinematics))));
    }
  }
}

const vector = (point) => new Vector3(...point);

/** The point at a distance along an axis of a frame, m. */
function along(frame, [x, y, z], distance) {
  return vector([distance * x, distance * y, distance * z]).applyMatrix4(frame).toArray();
}

/**
 * What makes an ellipsoid of the unit sphere: L with L Lᵀ = 5 J / m, where J = ½ tr(I) 1 - I is the second moment of mass
 * about the center, kg m². For half axes a, b, c along the axes, J is m/5 diag(a², b², c²).
 */
function ellipsoid(inertia, mass) {
  const half = (inertia[0][0] + inertia[1][1] + inertia[2][2]) / 2;
  const moment = inertia.map((row, i) => row.map((value, j) => (5 * ((i === j ? half : 0) - value)) / mass));
  const L = [[0, 0, 0], [0, 0, 0], [0, 0, 0]];
  for (let j = 0; j < 3; j += 1) {
    for (let i = j; i < 3; i += 1) {
      let left = moment[i][j];
      for (let k = 0; k < j; k += 1) left -= L[i][k] * L[j][k];
      if (i === j) L[i][j] = Math.sqrt(Math.max(left, 0)); // below 0: no body has such moments
      else L[i][j] = L[j][j] > 1e-12 ? left / L[j][j] : 0;
    }
  }
  return new Matrix4().set(...L[0], 0, ...L[1], 0, ...L[2], 0, 0, 0, 0, 1);
}
