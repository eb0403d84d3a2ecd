// The loops of a robot in the scene: lines to both frames of each closure, red where a loop is open or stops a motion.

import { CLOSED } from "../src/closing/tolerances.js";
import { Marks, RED } from "./marks.js";

const CLOSURE = 0x9c36b5;
const LINE = 0.003; // radius of a line, in sizes of the robot
const DOT = 0.008;

export class Loops extends Marks {
  /** @param size Of the robot, m. */
  constructor(robot, size) {
    super();
    this.shown = false; // all loops; those that are open or stop a motion always are
    const joints = jointsAbove(robot);
    this.closures = robot.closures.map((closure) => {
      const [a, b] = closure.frames.map(({ link }) => joints(link));
      return {
        closure,
        joints: new Set([...a, ...b].filter((name) => a.includes(name) !== b.includes(name))),
        rods: [this.rod(LINE * size, CLOSURE), this.rod(LINE * size, CLOSURE)],
        gap: this.rod(1.5 * LINE * size, CLOSURE),
        dots: [this.ball(DOT * size, CLOSURE), this.ball(DOT * size, CLOSURE)],
      };
    });
  }

  place({ kinematics, residuals, stop }) {
    for (const { closure, joints, rods, gap, dots } of this.closures) {
      const isOpen = residuals[closure.name].some((row) => Math.abs(row) > CLOSED);
      const stops = joints.has(stop?.joint);
      const isShown = this.shown || stops;
      const ends = closure.frames.map((frame) => kinematics.pose(frame).p);
      closure.frames.forEach(({ link }, i) => {
        rods[i].span(kinematics.pose(link).p, ends[i]);
        rods[i].mesh.visible &&= isShown;
        dots[i].position.set(...ends[i]);
        dots[i].visible = isShown || isOpen;
      });
      gap.span(...ends);
      gap.mesh.visible &&= isShown || isOpen;
      for (const mesh of [...rods.map((rod) => rod.mesh), ...dots]) mesh.material = this.material(stops ? RED : CLOSURE);
      gap.mesh.material = this.material(stops || isOpen || closure.type !== "distance" ? RED : CLOSURE);
    }
  }
}

/** The names of the joints from a link to the root. */
function jointsAbove({ joints }) {
  const above = new Map(joints.map((joint) => [joint.child, joint]));
  return function of(link) {
    const joint = above.get(link);
    return joint ? [joint.name, ...of(joint.parent)] : [];
  };
}
