// Marks that are seen through what is in front of them: rods and balls, sizes in m, positions in the world.

import { CylinderGeometry, Group, Mesh, MeshBasicMaterial, Quaternion, SphereGeometry, Vector3 } from "three";

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
