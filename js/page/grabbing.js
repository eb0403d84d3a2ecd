// Grabbing: the part under the pointer follows it, in the plane through the point that faces the camera.

import { Plane, Raycaster, Vector2, Vector3 } from "three";
import { Marks } from "./marks.js";

const HANDLE = 0x1c7ed6;

export class Grabbing {
  constructor(viewport, scene) {
    this.viewport = viewport;
    this.scene = scene;
    this.ray = new Raycaster();
    this.held = null; // {link, point, rotation, target, pointer}: a point of a link, in its frame, and where it is to go
    const { canvas } = viewport;
    // Before the controls of the camera, which this keeps from turning it.
    canvas.addEventListener("pointerdown", (event) => this.take(event), { capture: true });
    canvas.addEventListener("pointermove", (event) => this.move(event), { capture: true });
    for (const end of ["pointerup", "pointercancel"])
      canvas.addEventListener(end, (event) => this.release(event), { capture: true });
    // A finger on the robot moves it, and does not scroll the page.
    canvas.addEventListener("touchstart", (event) => this.held && event.preventDefault(), { passive: false });
    viewport.drawn.push(() => this.follow());
  }

  /** What is under a pointer: {link, position in the world}, or undefined. */
  under(event) {
    this.aim(event);
    const [hit] = this.ray.intersectObjects(this.scene.grabbed, false);
    return hit && { link: hit.object.userData.link, position: hit.point };
  }

  aim({ clientX, clientY }) {
    const { left, top, width, height } = this.viewport.canvas.getBoundingClientRect();
    const at = new Vector2((2 * (clientX - left)) / width - 1, 1 - (2 * (clientY - top)) / height);
    this.ray.setFromCamera(at, this.viewport.camera);
  }

  take(event) {
    if (this.held || event.button !== 0 || event.ctrlKey || event.shiftKey || !event.isPrimary) return;
    const hit = this.under(event);
    if (!hit) return;
    event.stopImmediatePropagation();
    this.viewport.canvas.focus({ preventScroll: true });
    this.viewport.canvas.setPointerCapture(event.pointerId);
    this.hold(event.pointerId, hit);
  }

  hold(pointer, { link, position }) {
    const { camera } = this.viewport;
    const facing = camera.getWorldDirection(new Vector3());
    this.plane = new Plane().setFromNormalAndCoplanarPoint(facing, position);
    const point = this.scene.links.get(link).worldToLocal(position.clone()).toArray();
    this.held = { link, point, target: null, pointer, rotation: this.scene.session.kinematics.pose(link).R };
    this.scene.session.begin();
    this.mark = new Marks();
    const size = this.scene.size;
    Object.assign(this, { ball: this.mark.ball(0.012 * size, HANDLE), rod: this.mark.rod(0.003 * size, HANDLE) });
    this.scene.add(this.mark);
    this.showHandle(position);
  }

  move(event) {
    if (event.pointerId !== this.held?.pointer) {
      if (!event.buttons) this.hover(event);
      return;
    }
    event.stopImmediatePropagation();
    this.aim(event);
    const target = this.ray.ray.intersectPlane(this.plane, new Vector3());
    if (!target) return;
    this.held.target = target;
    this.viewport.draw();
  }

  /** Once a frame: show by the cursor whether there is something to grab. */
  hover(event) {
    this.hovered = event;
    this.hovering ??= requestAnimationFrame(() => {
      this.hovering = undefined;
      this.viewport.canvas.classList.toggle("eu-live-grabs", Boolean(this.under(this.hovered)));
    });
  }

  /** Once a frame: bring the part to where the pointer is. */
  follow() {
    const { held, scene } = this;
    if (!held?.target) return;
    scene.session.drag(held.link, held.point, held.target.toArray(), held.rotation);
    this.showHandle(held.target);
    held.target = null;
  }

  /** A ball on the part, and a line to the pointer where the part does not reach it. */
  showHandle(target) {
    const at = this.scene.links.get(this.held.link).localToWorld(new Vector3(...this.held.point));
    this.ball.position.copy(at);
    this.rod.span(at.toArray(), target.toArray());
    this.viewport.draw();
  }

  release(event) {
    if (event.pointerId !== this.held?.pointer) return;
    event.stopImmediatePropagation();
    this.follow();
    this.held = null;
    this.scene.remove(this.mark);
    this.viewport.draw(true);
  }
}
