"""What a description of version 2 says, misread."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from eurdf.format import read_extension
from eurdf.format.version2 import Version2
from eurdf.linking import description, link
from eurdf.mechanism.mechanism import ROOT_JOINT, Mechanism
from eurdf_conformance.adapters.reference_values import Quantities
from eurdf_conformance.level import Level
from eurdf_conformance.mutants.accepting import accepting
from eurdf_conformance.mutants.deviation import Deviation, around, instead
from eurdf_conformance.mutants.mutant import Mutant, mutant
from eurdf_conformance.mutants.of_the_reference import canonical, data_of_version2, mechanism, said_in_version2
from eurdf_conformance.oracle.own import own_data

accepts_missing_version = accepting("missing-key", "EU-VER-003", "accepts_missing_version")


def _each(value: Any, change: Any) -> Any:
    """The value, with all that is in it changed, but for the user's own."""
    if isinstance(value, dict):
        return {key: item if key.startswith("x-") else _each(item, change) for key, item in value.items()}
    if isinstance(value, list):
        return [_each(item, change) for item in value]
    return change(value)


def _number(value: Any) -> Any:
    try:
        return float(value) if isinstance(value, str) and value != "2.0" else value
    except ValueError:
        return value


@mutant("EU-VER-002")
def every_description_is_of_version_2() -> Deviation:
    """A description that has keys of neither version is refused."""

    def version(original: Any, document: Any, diagnostics: Any) -> Any:
        if not any(key in document.data for key in (*read_extension._VERSION1_KEYS, read_extension.VERSION_KEY)):
            diagnostics.report("missing-key", "the version is missing", document.place())
            return None
        return original(document, diagnostics)

    return around(read_extension, "_version", version)


@mutant("EU-VER-002")
def version_1_is_called_2() -> Deviation:
    """A description of version 1 is said to be of version 2."""
    return canonical(lambda robot: {"version": "2"})


@mutant("EU-VER-003")
def version_1_unless_it_says() -> Deviation:
    """A description that does not say its version is of version 1, whatever its keys."""
    return around(
        read_extension,
        "_version",
        lambda original, document, told: (
            original(document, told) if read_extension.VERSION_KEY in document.data else "1"
        ),
    )


@mutant("EU-VER-004")
def root_is_always_fixed() -> Deviation:
    """The root is fixed, whatever the description says."""
    return mechanism(lambda robot: replace(robot, root="fixed"))


@mutant("EU-VER-004")
def root_floats_unless_fixed() -> Deviation:
    """The root floats where the description does not say that it is fixed."""

    def linked(
        original: Any, urdf: Any, extension: Any, document: Any, *arguments: Any, **named: Any
    ) -> Mechanism | None:
        robot: Mechanism | None = original(urdf, extension, document, *arguments, **named)
        return replace(robot, root="floating") if robot and "root" not in document.data else robot

    return around(description, "link", linked)


@mutant("EU-VER-004", level=Level.KINEMATICS)
def floating_root_only_turns() -> Deviation:
    """A floating root stands at the origin of the world, and only turns there."""

    def placed(original: Any, self: Any, robot: Any, configuration: Any, frames: Any) -> None:
        root = configuration.get(ROOT_JOINT)
        still = {**configuration, ROOT_JOINT: [0.0, 0.0, 0.0, *root[3:]]} if root else configuration
        original(self, robot, still, frames)

    return around(Quantities, "__init__", placed)


@mutant("EU-SCH-002", versions=("2",))  # version 1 has no numbers
def text_is_a_number() -> Deviation:
    """A text that looks like a number is one."""
    return data_of_version2(lambda data: _each(data, _number))


@mutant("EU-SCH-002", versions=("2",))  # version 1 has no numbers
def true_is_one() -> Deviation:
    """A boolean is the number 0 or 1, as in Python and C."""
    return data_of_version2(lambda data: _each(data, lambda value: float(value) if isinstance(value, bool) else value))


@mutant("EU-SCH-002", versions=("2",))  # of version 1 it is null_is_an_empty_list
def null_is_left_out() -> Deviation:
    """A key whose value is null is left out."""

    def without(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: without(item) for key, item in value.items() if item is not None}
        return [without(item) for item in value] if isinstance(value, list) else value

    return data_of_version2(without)


@mutant("EU-SCH-002", versions=("2",))  # version 1 says no version
def version_may_be_a_number() -> Deviation:
    """The version may be the number 2.0."""

    def read(original: Any, document: Any, diagnostics: Any) -> Any:
        if document.data.get(read_extension.VERSION_KEY) == 2:
            document.data[read_extension.VERSION_KEY] = "2.0"
        return original(document, diagnostics)

    return around(description, "read_extension", read)


@mutant("EU-SCH-004", versions=("2",))  # version 1 has upper case itself
def case_of_types_does_not_matter() -> Deviation:
    """A closure's type, and a joint's, may be in upper case, as in version 1."""
    words = ("3D", "6D", "Spherical", "SPHERICAL", "FIXED", "Fixed", "XY", "Floating")
    return data_of_version2(lambda data: _each(data, lambda value: value.lower() if value in words else value))


@mutant("EU-EXT-001")
def unknown_keys_at_the_top_are_own() -> Deviation:
    """At the top of a description any key that is not known is the user's own, as in version 1."""
    return data_of_version2(
        lambda data: {key: value for key, value in data.items() if key in Version2.model_fields or key.startswith("x-")}
    )


@mutant("EU-EXT-002")
def own_data_is_dropped() -> Deviation:
    """What stands under a key x- is dropped."""
    return said_in_version2(lambda said: replace(said, own_data={}))


@mutant("EU-EXT-002")
def own_data_within_is_dropped() -> Deviation:
    """What stands under a key x- is kept at the top of the description only."""
    return said_in_version2(
        lambda said: replace(said, own_data={where: value for where, value in said.own_data.items() if len(where) == 1})
    )


@mutant("EU-EXT-002")
def own_data_is_text() -> Deviation:
    """What stands under a key x- is kept as text."""
    return canonical(lambda robot: {"own": {where: str(value) for where, value in robot.own.items()}})


@mutant("EU-CAN-002")
def pointers_are_not_escaped() -> Deviation:
    """A slash in a key stands in its JSON pointer as it is."""
    return instead(link, "json_pointer", lambda steps: "".join(f"/{step}" for step in steps))


@mutant("EU-CAN-002")
def pointers_without_x() -> Deviation:
    """Own data is kept under its key without the x-."""
    return canonical(lambda robot: {"own": {where.replace("/x-", "/"): value for where, value in robot.own.items()}})


@mutant("EU-CAN-002")
def own_data_within_own_data() -> Deviation:
    """A key that begins with x- within the user's own data is listed once more, by itself."""

    def listed(own: dict[str, Any]) -> dict[str, Any]:
        return own | {inner: value for where, item in own.items() for inner, value in own_data(item, where).items()}

    return canonical(lambda robot: {"own": listed(robot.own)})


@mutant("EU-EXT-004")
def own_keys_are_read() -> Deviation:
    """A key that begins with x- is read as if it did not, where the other is left out."""

    def read(value: Any) -> Any:
        if isinstance(value, list):
            return [read(item) for item in value]
        if not isinstance(value, dict):
            return value
        own = {key[2:]: item for key, item in value.items() if key.startswith("x-")}
        return own | {key: read(item) for key, item in value.items() if not key.startswith("x-")}

    return data_of_version2(read)


def _key_of_neither(key: str) -> Mutant:
    """A key of version 2 alone does not tell that a description is of that version."""

    def deviation() -> Deviation:
        others = tuple(other for other in read_extension._VERSION2_KEYS if other != key)
        return instead(read_extension, "_VERSION2_KEYS", others)

    breaks = f"A description of nothing but `{key}` is of version 1."
    return Mutant(f"{key}_alone_is_of_version_1", "EU-VER-003", breaks, deviation)


#: Of `actuators` the cases have more than one.
ALONE = tuple(map(_key_of_neither, ("urdf", "root", "closures", "joints", "frames", "configurations")))
