// Actuators and the armatures that they give joints, EU-ACT-001 to -010.

import { meant } from "./near.js";

/** The actuators of a description. `joints`: the `JointNames` of the robot; `changes`: by URDF joint. */
export function linkActuators({ actuators }, joints, changes, diagnostics) {
  const actuated = new Set();
  const names = new Set();
  const stated = new Set([...changes.values()].filter((change) => "armature" in change).map((change) => change.joint));
  return actuators.map((actuator) => {
    const { gear_ratio = 1, rotor_inertia = 0 } = actuator;
    const linked = { ...actuator, gear_ratio, rotor_inertia };
    if (actuator.isFaulty) return linked;
    const joint = joints.find(actuator.joint);
    const place = actuator.node.isMapping ? actuator.node.get("joint") : actuator.node;
    const error = (code, message, hint) => diagnostics.report(code, place, message, hint);
    const name = actuator.name ?? actuator.joint;
    if (joints.isUnclear(actuator.joint)) return linked;
    if (!joint) {
      error("unknown-actuator", `'${actuator.joint}' is no joint of the robot`, meant(actuator.joint, joints.names()));
    } else if (joint.isMerged) {
      error("actuator-merged", `joint '${actuator.joint}' is merged into another joint`, "name the merged joint");
    } else if (joint.type === "fixed") {
      error("actuator-immobile", `joint '${actuator.joint}' is fixed`, "remove the actuator, or let the joint move");
    } else if (joint.leader) {
      error("actuator-mimic", `joint '${actuator.joint}' is a mimic joint`, `name its leader, '${joint.mimic.joint}'`);
    } else if (actuated.has(joint)) {
      error("actuator-duplicate", `another actuator names joint '${actuator.joint}'`, "keep one of the two");
    } else if (names.has(name)) {
      const own = actuator.name === undefined ? place : actuator.node.get("name");
      diagnostics.report(
        "duplicate-actuator-name",
        own,
        `another actuator has the name '${name}'`,
        "write another name",
      );
    } else {
      const armature = gear_ratio * gear_ratio * rotor_inertia;
      if (!stated.has(actuator.joint)) joint.armature = joint.armature.map(() => armature);
    }
    actuated.add(joint);
    names.add(name);
    return linked;
  });
}
