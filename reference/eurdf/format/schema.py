"""JSON Schemas (2020-12) of the YAML file, for editors: ``python -m eurdf.format.schema FOLDER`` writes them."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from eurdf.format.conventions import OWN_KEY, Version, is_own_key
from eurdf.format.model import MODELS
from eurdf.format.urdf.data import Urdf
from eurdf.format.value_types import Schema, Schemas

DIALECT = "https://json-schema.org/draft/2020-12/schema"

#: Versions of the format, as commands name them: 2 is version 2.0.
SchemaVersion = Literal["1", "2", "2.1"]

#: File and identifier of each version's schema.
FILES: dict[SchemaVersion, str] = {
    "1": "extended-urdf-1.schema.json",
    "2": "extended-urdf-2.0.schema.json",
    "2.1": "extended-urdf-2.1.schema.json",
}
#: Versions of the format, as files name them.
NUMBERS: dict[SchemaVersion, Version] = {"1": "1", "2": "2.0", "2.1": "2.1"}

#: Next to an enumeration of names: a value that is not a name is reported elsewhere.
_OTHER_THAN_TEXT = {"not": {"type": "string"}}


@dataclass(frozen=True, slots=True)
class Names:
    """The names in the URDF of one robot: its links, its joints, fixed ones too, and those that can move."""

    links: Sequence[str]
    joints: Sequence[str]
    movable_joints: Sequence[str]


def names_of(urdf: Urdf) -> Names:
    """The names in a URDF."""
    movable = tuple(name for name, joint in urdf.joints.items() if not joint.type.is_fixed)
    return Names(tuple(urdf.links), tuple(urdf.joints), movable)


def json_schema(version: SchemaVersion, names: Names | None = None) -> Schema:
    """The schema of a version, as the models say it, for any robot or with the names of one.

    With names, an editor completes them. A file can itself define names that the URDF does not have: by the key
    ``frames``, and by giving joints another type. Where a file can define names, the schema offers those of the URDF
    and accepts others. It rejects unknown names in a file that has neither key, and where a file cannot define names
    (links, joints to merge).
    """
    number = NUMBERS[version]
    schemas = Schemas(number)
    described = MODELS[number].schema(schemas)
    head = {"$schema": DIALECT, "$id": f"urn:extended-urdf:schema:{number}"}
    schema = {**head, **_sorted({**described, "$defs": schemas.definitions})}
    if names is not None:
        del schema["$id"]  # that of the schema of any robot
        _put_names(schema, version, names)
    return schema


def _sorted(value: Any, key: str = "") -> Any:
    """The same schema, with its keywords and definitions in alphabetical order, and the keys of files in theirs."""
    if isinstance(value, dict):
        keys = value if key == "properties" else sorted(value)
        return {name: _sorted(value[name], name) for name in keys}
    return [_sorted(item) for item in value] if isinstance(value, list) else value


def _put_names(schema: Schema, version: SchemaVersion, names: Names) -> None:
    """Insert the names of one robot where names are expected."""
    definitions = schema["$defs"]
    movable: Schema = {"enum": list(names.movable_joints)}
    frames: Schema = {"enum": list(dict.fromkeys((*names.links, *names.joints)))}
    joints: Schema = {"enum": list(names.joints)}
    for name, known in {"LinkName": {"enum": list(names.links)}, "UrdfJointName": joints}.items():
        if name in definitions:
            definitions[name] |= known
    for name, known in {"JointName": joints, "MovingJointName": movable, "FrameName": frames}.items():
        if name in definitions:
            definition = definitions[name]
            definition["anyOf"] = [known, {key: definition.pop(key) for key in ("type", "minLength")}]
    if version == "1":
        makes_names: Schema = {"required": ["joint_name"]}
        of_the_urdf: Schema = {"closed_loop": {"items": {"items": frames}}, "name_mot": {"items": movable}}
    else:
        _put_joint_keys(schema, names)
        makes_names = {"anyOf": [{"required": ["frames"]}, {"required": ["joints"]}]}
        own = {OWN_KEY: True}
        of_the_urdf = {
            "closures": {"items": {"properties": {"frames": {"items": {"anyOf": [frames, _OTHER_THAN_TEXT]}}}}},
            "actuators": {"items": {"anyOf": [movable, _OTHER_THAN_TEXT | {"properties": {"joint": movable}}]}},
            "configurations": {
                "patternProperties": own,
                "additionalProperties": {"propertyNames": {"anyOf": [movable, {"pattern": OWN_KEY}]}},
            },
        }
    schema |= {"if": makes_names, "else": {"properties": of_the_urdf}}


def _put_joint_keys(schema: Schema, names: Names) -> None:
    """Insert the names of joints where they are the keys of a mapping."""
    joint = {"$ref": "#/$defs/Joint"}
    joints = schema["properties"]["joints"]
    joints["properties"] = {name: joint for name in names.joints if not is_own_key(name)}
    joints["additionalProperties"] = {"allOf": [joint, {"type": "object", "required": ["merges"]}]}
    if "Coupling" in schema["$defs"]:
        coupled = schema["$defs"]["Coupling"]["properties"]["joints"]
        coefficient = coupled["additionalProperties"]
        coupled["properties"] = {name: coefficient for name in names.movable_joints if not is_own_key(name)}
    configuration = schema["properties"]["configurations"]["additionalProperties"]
    coordinates = configuration["additionalProperties"]
    configuration["properties"] = {name: coordinates for name in names.movable_joints if not is_own_key(name)}


def schema_text(schema: Schema) -> str:
    """The text of a schema's file."""
    return json.dumps(schema, indent=2, ensure_ascii=False) + "\n"


def main(folder: str) -> None:
    """Write the schema of each version into a folder."""
    for version, name in FILES.items():
        Path(folder, name).write_text(schema_text(json_schema(version)), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
