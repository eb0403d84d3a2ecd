// The view of a scene: camera, lights and ground, turned and moved by pointers and keys; drawn only when it changed.

import {
  BufferGeometry,
  DirectionalLight,
  Float32BufferAttribute,
  HemisphereLight,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MOUSE,
  PCFShadowMap,
  PerspectiveCamera,
  PlaneGeometry,
  Scene,
  ShadowMaterial,
  Spherical,
  TOUCH,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

const FIELD = 35; // angle of view, degrees
const AZIMUTH = -0.65; // of the camera, at first, rad
const ELEVATION = 0.35;

export class Viewport {
  /**
   * @param canvas Where to draw.
   * @param options.embedded Whether the page scrolls past the canvas: then the wheel zooms only a canvas in focus.
   */
  constructor(canvas, { embedded = false } = {}) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(globalThis.devicePixelRatio || 1, 2));
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.shadowMap.autoUpdate = false;
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(FIELD, 1, 0.01, 100);
    this.camera.up.set(0, 0, 1);
    this.addLights();
    if (embedded) canvas.addEventListener("wheel", (event) => this.isInFocus || event.stopImmediatePropagation());
    this.controls = new OrbitControls(this.camera, canvas);
    if (embedded) canvas.style.touchAction = "pan-y";
    this.controls.zoomToCursor = true;
    this.controls.addEventListener("change", () => this.draw());
    new ResizeObserver(() => this.resize()).observe(canvas);
    canvas.addEventListener("keydown", (event) => this.key(event));
    this.drawn = []; // called before each drawing, with the time, ms
  }

  get isInFocus() {
    return document.activeElement === this.canvas;
  }

  addLights() {
    this.scene.add(new HemisphereLight(0xffffff, 0x9aa2ad, 1.9));
    this.sun = new DirectionalLight(0xffffff, 2.2);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(2048, 2048);
    this.sun.shadow.radius = 6;
    this.scene.add(this.sun, this.sun.target);
  }

  /** Look at a box (m): camera, lights and ground are made for its size. */
  lookAt(box) {
    this.size = box.getSize(new Vector3()).length() || 1;
    this.center = box.getCenter(new Vector3());
    const { size, center, camera, controls, sun } = this;
    this.placeGround(box);
    sun.position.copy(center).add(new Vector3(0.5, -0.7, 1.6).multiplyScalar(size));
    sun.target.position.copy(center);
    const around = { left: -size, right: size, top: size, bottom: -size };
    Object.assign(sun.shadow.camera, { ...around, near: 0.1 * size, far: 4 * size });
    sun.shadow.camera.updateProjectionMatrix();
    sun.shadow.normalBias = 0.004 * size;
    controls.minDistance = 0.1 * size;
    controls.maxDistance = 20 * size;
    camera.near = 0.01 * size;
    camera.far = 40 * size;
    this.home();
  }

  /** The camera as at first. */
  home() {
    this.view(AZIMUTH, ELEVATION);
  }

  /** Look at the center from a direction: azimuth about z from x, and elevation, rad. */
  view(azimuth, elevation) {
    const { camera, controls, size, center } = this;
    const reach = (0.54 * size) / Math.tan((FIELD * Math.PI) / 360);
    // Spherical coordinates of three.js are about y.
    const [y, z, x] = new Vector3().setFromSphericalCoords(1, Math.PI / 2 - elevation, azimuth).toArray();
    const toward = new Vector3(x, y, z);
    controls.target.copy(center);
    camera.position.copy(center).addScaledVector(toward, reach);
    controls.update();
    this.resize();
  }

  /** A grid that fades out, on which the robot casts its shadow. */
  placeGround(box) {
    if (this.ground) this.scene.remove(...this.ground);
    const { size, center } = this;
    const plane = new Mesh(new PlaneGeometry(8 * size, 8 * size), new ShadowMaterial({ opacity: 0.22 }));
    plane.receiveShadow = true;
    plane.position.set(center.x, center.y, box.min.z - 0.001 * size);
    this.ground = [plane, grid(center, size, box.min.z)];
    this.scene.add(...this.ground);
  }

  resize() {
    const { clientWidth, clientHeight } = this.canvas;
    if (!clientWidth || !clientHeight) return;
    this.renderer.setSize(clientWidth, clientHeight, false);
    const { camera } = this;
    camera.aspect = clientWidth / clientHeight;
    // A narrow picture shows as much from left to right as a square one.
    camera.fov = (360 / Math.PI) * Math.atan(Math.tan((FIELD * Math.PI) / 360) / Math.min(1, camera.aspect));
    camera.updateProjectionMatrix();
    this.draw();
  }

  /** Draw before the next frame of the screen; `moved`: the shadows changed. */
  draw(moved = false) {
    this.renderer.shadowMap.needsUpdate ||= moved;
    this.waiting ??= requestAnimationFrame((time) => {
      this.waiting = undefined;
      for (const each of this.drawn) each(time);
      this.renderer.render(this.scene, this.camera);
    });
  }

  /** Turn the camera about the robot, rad. */
  turn(azimuth, elevation) {
    const { camera, controls } = this;
    const away = camera.position.clone().sub(controls.target);
    // Spherical coordinates of three.js are about y.
    const at = new Spherical().setFromCartesianCoords(away.y, away.z, away.x);
    at.theta += azimuth;
    at.phi -= elevation;
    at.makeSafe();
    const [y, z, x] = new Vector3().setFromSpherical(at).toArray();
    camera.position.copy(controls.target).add(new Vector3(x, y, z));
    controls.update();
    this.draw();
  }

  /** Move the camera nearer (factor below 1) or away. */
  zoom(factor) {
    const { camera, controls } = this;
    camera.position.sub(controls.target).multiplyScalar(factor).add(controls.target);
    controls.update();
    this.draw();
  }

  key(event) {
    const keys = {
      ArrowLeft: () => this.turn(-0.1, 0),
      ArrowRight: () => this.turn(0.1, 0),
      ArrowUp: () => this.turn(0, 0.1),
      ArrowDown: () => this.turn(0, -0.1),
      "+": () => this.zoom(0.9),
      "-": () => this.zoom(1 / 0.9),
    };
    if (!Object.hasOwn(keys, event.key) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    keys[event.key]();
  }
}

/** Lines on the ground, a power of ten of metres apart, which fade with the distance. */
function grid({ x, y }, size, height) {
  const apart = 10 ** Math.round(Math.log10(0.25 * size));
  const reach = Math.ceil((1.3 * size) / apart);
  const [i, j] = [Math.round(x / apart), Math.round(y / apart)];
  const positions = [];
  const colors = [];
  const point = (u, v) => {
    positions.push((i + u) * apart, (j + v) * apart, height);
    colors.push(0.5, 0.5, 0.5, 0.4 * Math.max(0, 1 - Math.hypot(u, v) / reach));
  };
  for (let u = -reach; u <= reach; u += 1) {
    for (let v = -reach; v < reach; v += 1) {
      for (const each of [v, v + 1]) point(u, each);
      for (const each of [v, v + 1]) point(each, u);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(positions, 3));
  geometry.setAttribute("color", new Float32BufferAttribute(colors, 4));
  const material = new LineBasicMaterial({ vertexColors: true, transparent: true, depthWrite: false });
  return new LineSegments(geometry, material);
}
