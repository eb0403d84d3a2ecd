// Where the camera looks from, and what it follows.

import { Vector3 } from "three";

const TOP = Math.PI / 2 - 1e-3; // straight down, the camera would not know what is up, rad

/** Azimuth, from x about z, and elevation of directions to look from, rad. A robot looks along x; y is to its left. */
export const DIRECTIONS = {
  Front: [0, 0],
  Back: [Math.PI, 0],
  Left: [Math.PI / 2, 0],
  Right: [-Math.PI / 2, 0],
  Top: [0, TOP],
};

/** Keeps a link, or the center of mass, where it is in the picture. */
export class Follower {
  constructor(viewport) {
    this.viewport = viewport;
    this.pointOf = null; // the point in the world, m, of a session
  }

  /** Follow a point of a session's robot: (session) => [x, y, z], or null for none. */
  follow(pointOf, session) {
    this.pointOf = pointOf;
    this.last = pointOf && new Vector3(...pointOf(session));
  }

  /** Bring the camera to where the robot of a session is. */
  place(session) {
    if (!this.pointOf) return;
    const { camera, controls } = this.viewport;
    const now = new Vector3(...this.pointOf(session));
    const moved = now.clone().sub(this.last);
    camera.position.add(moved);
    controls.target.add(moved);
    controls.update();
    this.last = now;
  }
}
