// The canonical description, which the level structure compares.

import { toJson } from "../src/reading/own.js";

export function canonical(robot) {
  const moving = robot.joints.filter((joint) => joint.type !== "fixed");
  const velocities = new Map(moving.map((joint) => [joint.name, joint.velocity.length]));
  const shapes = [...robot.links.values()].flatMap((link) => link.shapes.map((shape) => shapeOf(link.name, shape)));
  return {
    name: robot.name,
    version: robot.version,
    root: robot.root,
    links: [...robot.links.keys()],
    frames: robot.frameNames,
    joints: moving.map(jointOf),
    closures: robot.closures.map(closureOf),
    actuators: robot.actuators.map((actuator) => actuatorOf(actuator, velocities.get(actuator.joint))),
    ...(robot.couplings.length && { couplings: robot.couplings.map(couplingOf) }),
    configurations: toJson(robot.configurations),
    ...(shapes.length && { shapes }),
    own: toJson(robot.own),
  };
}

function jointOf({ name, type, parent, child, lower, upper, velocity, effort, damping, friction, armature, ...joint }) {
  const spring = joint.stiffness && { stiffness: joint.stiffness, rest: joint.rest };
  const limits = { lower, upper, velocity, effort };
  return { name, type, parent, child, ...limits, damping, friction, armature, ...spring, mimic: mimicOf(joint) };
}

const mimicOf = ({ mimic }) => mimic && { joint: mimic.joint, multiplier: mimic.multiplier, offset: mimic.offset };

function closureOf({ name, type, frames: [a, b], axes, length, compliance }) {
  const isRigid = !compliance || (compliance.linear === 0 && compliance.angular === 0);
  const optional = { ...(axes && { axes }), ...(length !== undefined && { length }), ...(!isRigid && { compliance }) };
  return { name, type, a: a.link, b: b.link, ...optional };
}

function actuatorOf({ joint, gear_ratio, rotor_inertia, name, control }, velocities) {
  const each = (number) => Array(velocities).fill(number);
  const optional = { ...(name !== undefined && { name }), ...(control && { control }) };
  return { joint, gear_ratio: each(gear_ratio), rotor_inertia: each(rotor_inertia), ...optional };
}

const couplingOf = ({ name, joints, offset }) => ({ name, joints: toJson(joints), offset });

const shapeOf = (link, { use, type, size, file, pose }) => ({
  link,
  use,
  type,
  size,
  ...(file !== undefined && { file }),
  pose: { rotation: pose.R, translation: pose.p },
});
