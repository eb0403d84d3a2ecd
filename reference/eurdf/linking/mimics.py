"""Mimic joints: those that the description frees, and chains of them, where a leader mimics a joint itself."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType

from eurdf.diagnostics import Diagnostics
from eurdf.format.conventions import HINT, LARGEST, is_too_small, too_large, too_small
from eurdf.format.fixes import removed
from eurdf.format.joint_model import JointEntry
from eurdf.format.urdf.data import Urdf
from eurdf.linking.joints import report_of_joints
from eurdf.mechanism.joint import Mimic, drivers
from eurdf.mechanism.mechanism import Mechanism
from eurdf.reading.yaml_reader import YamlReporter


def freed_joints(entries: Iterable[JointEntry], urdf: Urdf, reporter: YamlReporter) -> set[str]:
    """EU-JNT-033, EU-JNT-034: the joints whose ``<mimic>`` has no effect, because their entry states ``mimic: false``.

    An entry that merges joints frees those of them that mimic.
    """
    freed: set[str] = set()
    for entry in entries:
        if entry.mimic is not False:
            continue
        named = entry.merges or (entry.name,)
        mimicking = {name for name in named if name in urdf.joints and urdf.joints[name].mimic}
        # An unknown joint is reported as such.
        if not mimicking and all(name in urdf.joints for name in named):
            what = f"joint '{entry.name}' mimics no other" if not entry.merges else "none of the merged joints is one"
            message = f"'mimic: false' frees a mimic joint, but {what}"
            pointer = (*entry.pointer, "mimic")
            mimics = any(joint.mimic for joint in urdf.joints.values())  # one of them may be meant
            fixes = () if mimics else removed(reporter.document, pointer, "'mimic'")
            reporter.report("joint-not-mimic", message, pointer, "which joint mimics another?", fixes)
        freed |= mimicking
    return freed


def led_configurations(
    mechanism: Mechanism, mimics: Mapping[str, Mimic]
) -> Mapping[str, Mapping[str, tuple[float, ...]]]:
    """The named configurations, in which each free mimic joint has the value that its leader would give it."""
    joints = {joint.name: joint for joint in mechanism.joints}
    led = {
        name: mimic
        for name, mimic in drivers(mimics).items()
        if all(other in joints and joints[other].type.is_axial for other in (name, mimic.joint))
    }
    if not led:
        return mechanism.configurations
    configurations = {}
    for key, stated in mechanism.configurations.items():
        followed = {
            name: (mimic.multiplier * stated.get(mimic.joint, (0.0,))[0] + mimic.offset,) for name, mimic in led.items()
        }
        configurations[key] = MappingProxyType({**followed, **stated})
    return MappingProxyType(configurations)


def check_chains(mechanism: Mechanism, urdf: Urdf, diagnostics: Diagnostics) -> None:
    """EU-FIL-005: multiplier and offset of a mimic joint with respect to the leader of its chain are within bounds.

    One error for a robot: what mimics such a joint is beyond them too.
    """
    mimics = {joint.name: joint.mimic for joint in mechanism.joints if joint.mimic is not None}
    if all(mimic.joint not in mimics for mimic in mimics.values()):
        return
    for name, mimic in drivers(mimics).items():
        for attribute, value in (("multiplier", mimic.multiplier), ("offset", mimic.offset)):
            if abs(value) > LARGEST:
                what = too_large(value)
            elif attribute == "multiplier" and is_too_small(value):
                what = too_small(value)
            else:
                continue
            message = (
                f"'{attribute}' of joint '{name}' with respect to joint '{mimic.joint}' at the end of its chain is "
                f"{what}"
            )
            element = next(urdf.joints[name].element.iterchildren("mimic"))
            diagnostics.report("number-out-of-bounds", message, urdf.document.place(element, attribute), HINT)
            return


def warn_of_ignored_mimics(mechanism: Mechanism, urdf: Urdf, diagnostics: Diagnostics) -> None:
    """Report mimic joints that a description of version 1 leaves free (EU-ONE-009) and that no motor moves.

    One that is actuated, locked or replaced is meant to be a joint of its own. A description without actuators leaves
    open which joints move by themselves.
    """
    if mechanism.version != "1" or not mechanism.actuators:
        return
    free = {joint.name for joint in mechanism.joints if joint.type.is_axial} - set(mechanism.actuators)
    found = [joint for joint in urdf.joints.values() if joint.mimic is not None and joint.name in free]
    what = "a <mimic> but no actuator, and version 1 ignores <mimic>"
    hint = "actuate the joints that move freely, remove <mimic>, or use version 2, which respects it"
    report_of_joints("x-mimic-ignored", found, what, "mimic", hint, urdf, diagnostics)
