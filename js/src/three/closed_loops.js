// The objects of a URDFRobot of urdf-loader, led by a mechanism: its joints move with the loops closed.

import { Group } from "three";
import { Drive, assemble } from "../closing.js";
import { Mechanism } from "../mechanism.js";
import { JOINT_TYPES, quaternionAt } from "../mechanism/joint_types.js";
import { log3 } from "../mechanism/log6.js";
import { fromOrigin, fromQuaternion } from "../mechanism/spatial.js";
import { matrixOf } from "./shapes.js";

/**
 * Changes a URDFRobot: `setJointValue` keeps the loops closed and the limits, and the robot begins at `assembled`.
 *
 * A joint that the description replaces or makes is an object of `joints` too. A joint of several coordinates takes as many
 * values, in the order of the specification; null leaves one as it is. A mimic joint moves with its leader, and takes none.
 * The pose of a floating root is that of the robot in its scene.
 *
 * @param object What `URDFLoader.parse` makes of the URDF.
 * @param robot What `read` makes of the description and the URDF.
 * @returns The object, with `mechanism`; `q`, the configuration, which can be set; `stop`, why the last motion ended before
 *   its goal, or null; `closures`: [{name, type, frames, residual()}], whose two frames are objects in links.
 */
export function withClosedLoops(object, robot) {
  const mechanism = new Mechanism(robot);
  const drive = new Drive(mechanism, assemble(mechanism).q);
  const joints = objectsOf(robot, object);
  const place = () => {
    const kinematics = mechanism.at(drive.q);
    for (const [joint, own] of joints) {
      const [parent, child] = [joint.parent, joint.child].map((link) => matrixOf(kinematics.pose(link)));
      parent.invert().multiply(child).decompose(own.position, own.quaternion, own.scale);
      own.matrixWorldNeedsUpdate = true;
      own.jointValue = valuesOf(joint, drive.q);
    }
  };
  for (const [joint, own] of joints) {
    own.setJointValue = (...values) => {
      const before = own.jointValue;
      if (joint.mimic || !before.length) return false;
      object.stop = move(drive, joint, values);
      place();
      return own.jointValue.some((value, i) => value !== before[i]);
    };
  }
  const closures = robot.closures.map(({ name, type, frames }) => ({
    name,
    type,
    frames: frames.map((frame) => frameIn(object.links[frame.link], frame)),
    residual: () => mechanism.at(drive.q).residuals()[name],
  }));
  place();
  Object.assign(object, { mechanism, closures, stop: null });
  return Object.defineProperty(object, "q", {
    get: () => drive.q,
    set(q) {
      drive.q = q;
      place();
    },
    configurable: true,
  });
}

/** Moves one coordinate after the other; why it stopped, or null. */
function move(drive, { name, type }, values) {
  const { coordinates } = JOINT_TYPES[type];
  if (values.length !== coordinates.length) {
    throw new RangeError(`joint '${name}', which is ${type}, has ${coordinates.length} coordinates; it is given ${values.length}`);
  }
  const at = quaternionAt(type);
  const goals = at < 0 ? values : [...values.slice(0, at), ...log3(fromQuaternion(values.slice(at)))];
  for (const [index, goal] of goals.entries()) {
    if (goal === null) continue;
    const turns = type === "continuous" ? drive.q[name][0] - drive.value(name) : 0; // whole ones, which a drive does not count
    const { stop } = drive.move(name, index, Number(goal) - turns);
    if (stop) return stop;
  }
  return null;
}

/** The coordinates of a joint, as files have them. */
function valuesOf({ name, leader }, q) {
  if (leader) return [leader.multiplier * q[leader.joint.name][0] + leader.offset];
  return q[name] ?? [];
}

/** [joint, object] of each joint of a robot, with its child in it and it in its parent: objects that are missing are made. */
function objectsOf(robot, { links, joints, frames }) {
  const Link = Object.values(links).find((each) => !each.isURDFRobot)?.constructor;
  const Joint = Object.values(joints)[0]?.constructor;
  for (const name of Object.keys(joints)) delete joints[name];
  return robot.joints.map((joint) => {
    links[joint.child] ??= Object.assign(new Link(), { name: joint.child, urdfName: joint.child });
    const child = links[joint.child];
    const own = child.parent?.isURDFJoint ? child.parent : new Joint();
    const name = joint.name ?? own.name; // a joint that is merged has none
    links[joint.parent].add(own.add(child));
    Object.assign(own, { name, urdfName: name, jointType: joint.type, mimicJoints: [] });
    if (JOINT_TYPES[joint.type].coordinates.length === 1) {
      for (const key of ["lower", "upper", "effort", "velocity"]) own.limit[key] = limitOf(joint, key);
    }
    joints[name] = frames[name] = own;
    return [joint, own];
  });
}

/** As urdf-loader has it, but infinite where there is none. */
function limitOf(joint, key) {
  return joint[key][0] ?? (key === "lower" ? -Infinity : Infinity);
}

/** An object at a frame of a link. */
function frameIn(link, { xyz, rpy }) {
  const frame = new Group();
  matrixOf(fromOrigin(xyz, rpy)).decompose(frame.position, frame.quaternion, frame.scale);
  link.add(frame);
  return frame;
}
