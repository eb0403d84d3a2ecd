// Marks that are seen through what is in front of them: rods and balls, sizes in m, positions in the world.

import { CylinderGeometry, Group, Mesh, MeshBasicMaterial, Quaternion, SphereGeometry, Vector3 } from "three";

export const RED = 0xe03131; // of what is at a limit or open
const BONE = 0x868e96;

const Y = new Vector3(0, 1, 0);
const ROD = new CylinderGeometry(1, 1, 1, 12, 1);
const BALL = new SphereGeometry(1, 20, 14);

export class Marks extends Group {
  constructor() {
    super();
    this.materials = new Map(); // by colour
  }

  rod(radius, color) {
    return new Rod(this.made(ROD, color), radius);
  }

  ball(radius, color) {
    const mesh = this.made(BALL, color);
    mesh.scale.setScalar(radius);
    return mesh;
  }

  /** A rod from each link to those below it, which is a part of the upper link; what brings them to where links are. */
  skeleton(robot, radius) {
    return robot.joints.map(({ parent, child }) => {
      const rod = this.rod(radius, BONE);
      rod.mesh.userData.link = parent;
      return (kinematics) => rod.span(kinematics.pose(parent).p, kinematics.pose(child).p);
    });
  }

  made(geometry, color) {
    const mesh = new Mesh(geometry, this.material(color));
    mesh.renderOrder = 10;
    this.add(mesh);
    return mesh;
  }

  material(color) {
    if (!this.materials.has(color)) {
      this.materials.set(color, new MeshBasicMaterial({ color, depthTest: false, transparent: true }));
    }
    return this.materials.get(color);
  }
}

class Rod {
  constructor(mesh, radius) {
    this.mesh = mesh;
    this.radius = radius;
  }

  /** Span two points. */
  span(from, to) {
    const [a, b] = [new Vector3(...from), new Vector3(...to)];
    const along = b.clone().sub(a);
    const length = along.length();
    this.mesh.visible = length > 1e-9;
    if (!this.mesh.visible) return;
    this.mesh.position.copy(a).addScaledVector(along, 0.5);
    this.mesh.quaternion.copy(new Quaternion().setFromUnitVectors(Y, along.divideScalar(length)));
    this.mesh.scale.set(this.radius, length, this.radius);
  }
}
