// Actuators and the armatures that they give joints, EU-ACT-001 to -010.

import { fail } from "./invalid.js";

/** `moving`: the joints that move, by name; `changes`: what the description changes, by URDF joint. */
export function linkActuators(description, moving, changes) {
  const actuated = new Set();
  const names = new Set();
  const stated = new Set([...changes.values()].filter((change) => "armature" in change).map((change) => change.joint));
  return description.actuators.map((actuator) => {
    const joint = moving.get(actuator.joint);
    if (!joint) fail(`there is no joint '${actuator.joint}' that moves and could be actuated`);
    if (joint.mimic) fail(`the actuated joint '${actuator.joint}' is a mimic joint`);
    if (actuated.has(joint)) fail(`two actuators name the joint '${actuator.joint}'`);
    actuated.add(joint);
    const name = actuator.name ?? actuator.joint;
    if (names.has(name)) fail(`two actuators have the name '${name}'`);
    names.add(name);
    const { gear_ratio = 1, rotor_inertia = 0 } = actuator;
    const armature = gear_ratio * gear_ratio * rotor_inertia;
    if (!stated.has(actuator.joint)) joint.armature = joint.armature.map(() => armature);
    return { ...actuator, gear_ratio, rotor_inertia };
  });
}
