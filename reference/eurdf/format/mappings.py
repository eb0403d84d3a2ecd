"""Mappings with known keys: the fields of a model class, each of which states a key once for every use of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from inspect import cleandoc
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, TypeVar

from eurdf.format.conventions import OWN_KEY, VERSION2_1, Version, is_own_key
from eurdf.format.value_types import OWN_DATA, Check, Choice, Schema, Schemas, ValueType
from eurdf.reading.yaml_node import Pointer

_Model = TypeVar("_Model")


class Key(NamedTuple):
    """A key of a mapping.

    Attributes:
        type: What its value may be.
        title: What editors call it.
        text: What it says, with the unit.
        examples: Some values.
        default: What it means if it is left out; None if the schema shows no value.
        required: Whether it must not be left out.
        since: The first version that has it.
        becomes: Of version 1: the key of version 2.0 that says the same.
    """

    type: ValueType
    title: str
    text: str
    examples: tuple[Any, ...]
    default: Any
    required: bool
    since: Version
    becomes: str


def required(kind: ValueType, title: str, text: str, *examples: Any, since: Version = "1") -> Any:
    """A field of an `Entry` that is a key of its mapping: see `Key`."""
    return field(metadata={"key": Key(kind, title, text, examples, None, True, since, "")})


def key(
    kind: ValueType, title: str, text: str, *examples: Any, default: Any = None, since: Version = "1", becomes: str = ""
) -> Any:
    """The same, of a key that may be left out."""
    metadata = {"key": Key(kind, title, text, examples, default, False, since, becomes)}
    return (
        field(default_factory=dict, metadata=metadata) if default == {} else field(default=default, metadata=metadata)
    )


if TYPE_CHECKING:
    from typing_extensions import dataclass_transform

    @dataclass_transform(frozen_default=True, kw_only_default=True, field_specifiers=(field,))
    def entry(model: type[_Model]) -> type[_Model]:
        """A model, whose fields are set once, by keywords."""
        return model
else:
    # Each method that a dataclass gets takes time at import, so it gets no more than a constructor.
    entry = dataclass(kw_only=True, eq=False, repr=False)


@entry
class Entry:
    """What a file says in one mapping; subclasses have a field for each key.

    A class is the model of a kind of mapping. Its docstring is the description in the schema.

    Attributes:
        pointer: Where it is.
    """

    title: ClassVar[str]
    since: ClassVar[Version] = "1"

    #: A key that must be beside another one, by that one.
    needs: ClassVar[Mapping[str, str]] = {}

    #: Whether it must have at least one of its keys, except those that need another.
    says_something: ClassVar[bool] = False

    #: Whether any other key is user-defined, or only one that begins with ``x-``.
    is_open: ClassVar[bool] = False

    pointer: Pointer = ()


def key_like(model: type[Entry], name: str, *examples: Any) -> Any:
    """The field of a model, with other examples."""
    return field(metadata={"key": _keys_of(model)[name]._replace(examples=examples)})


def _keys_of(model: Any) -> dict[str, Key]:
    return {each.name: each.metadata["key"] for each in fields(model) if "key" in each.metadata}


def in_order(keys: Mapping[str, Key]) -> list[tuple[str, Key]]:
    """Keys by name, those of earlier versions first."""
    return sorted(keys.items(), key=lambda item: item[1].since)


class Record(ValueType):
    """A mapping with the keys of a model, and user-defined ones, which begin with ``x-``."""

    types = (dict,)

    def __init__(self, model: type[Entry]) -> None:
        self.model: Any = model
        self.name = model.__name__.removesuffix("Entry")
        self.since = model.since
        self.all_keys = {
            name: key if key.since >= model.since else key._replace(since=model.since)
            for name, key in _keys_of(model).items()
        }
        self._keys: dict[Version, dict[str, Key]] = {}

    def keys(self, version: Version) -> Mapping[str, Key]:
        """Its keys in a version."""
        if version not in self._keys:
            self._keys[version] = {name: key for name, key in self.all_keys.items() if key.since <= version}
        return self._keys[version]

    def values_of_type(self) -> tuple[str, ...]:
        """The values that its key ``type`` may have; empty if it has no such key."""
        kind = self.all_keys["type"].type if "type" in self.all_keys else None
        return kind.values if isinstance(kind, Choice) else ()

    def one_of(self, version: Version) -> list[str]:
        """The keys of which there must be one, those of earlier versions first; empty if all may be left out."""
        if not self.model.says_something:
            return []
        return [name for name, _ in in_order(self.keys(version)) if name not in self.model.needs]

    def check(self, value: Any, at: Pointer, file: Check, union: OneOf | None = None) -> None:
        if type(value) is not dict:
            file.report(at, "wrong-type", "must be a mapping", value)
            return
        before = len(file.found)
        keys = self.keys(file.version)
        for name, key in keys.items():
            if name in value:
                key.type.check(value[name], (*at, name), file)
            elif key.required:
                file.report((*at, name), "missing")
        if not self.model.is_open:
            for name in value:
                if name not in keys and not is_own_key(name):
                    file.report((*at, name), "unknown-key", about=(self, union))
        if len(file.found) > before:
            return
        for name, needed in self.model.needs.items():
            if name in value and needed not in value:
                file.report(at, "missing-key", f"has '{name}' but lacks '{needed}', which it needs", about=name)
                return
        one_of = self.one_of(file.version)
        if one_of and value.keys().isdisjoint(one_of):
            names = ", ".join(f"'{name}'" for name in one_of)
            file.report(at, "missing-key", f"must have at least one of {names}")

    def read(self, value: dict[str, Any], at: Pointer, **more: Any) -> Any:
        for name, key in self.all_keys.items():
            if name in value:
                more[name] = key.type.read(value[name], (*at, name))
        return self.model(pointer=at, **more)

    def write(self, value: Entry) -> dict[str, Any]:
        """Without the keys that have their default; first its name, and what else is required."""
        keys = sorted(self.all_keys.items(), key=lambda item: (not item[1].required, item[0] != "name"))
        values = ((name, key, getattr(value, name)) for name, key in keys)
        return {name: key.type.write(held) for name, key, held in values if key.required or held != key.default}

    def schema(self, schemas: Schemas) -> Schema:
        model, keys = self.model, self.keys(schemas.version)
        schema: Schema = {
            "type": "object",
            "title": model.title.format(version=schemas.version),
            "description": cleandoc(str(model.__doc__)),
            "properties": {name: self._property(key, schemas) for name, key in keys.items()},
            "additionalProperties": model.is_open,
        }
        if not model.is_open:
            schema["patternProperties"] = {OWN_KEY: OWN_DATA}
        if required := [name for name, key in keys.items() if key.required]:
            schema["required"] = required
        if one_of := self.one_of(schemas.version):
            schema["anyOf"] = [{"required": [name]} for name in one_of]
        if needs := {name: [needed] for name, needed in model.needs.items() if name in keys}:
            schema["dependentRequired"] = needs
        return schema

    def _property(self, key: Key, schemas: Schemas) -> Schema:
        examples = [*key.examples] or [schemas.version]
        shown: Schema = {"title": key.title, "description": key.text, "examples": examples}
        if key.default is not None and (default := key.type.default(key.default)) is not None:
            shown["default"] = default
        return {**schemas.of(key.type), **shown}


class Alone(ValueType):
    """A text that stands for a mapping in which it is the value of one key, and the only one.

    Args:
        text: Type of the text.
        key: The key.
        record: The mapping, if a file cannot state it in full; else another form of the same value.
    """

    types = (str,)

    def __init__(self, text: ValueType, key: str, record: Record | None = None) -> None:
        self.text, self.key, self.record = text, key, record

    def check(self, value: Any, at: Pointer, file: Check) -> None:
        self.text.check(value, at, file)

    def says(self, written: Mapping[str, Any]) -> bool:
        """Whether the text alone says what a mapping says."""
        check = Check(VERSION2_1)
        if written.keys() == {self.key}:
            self.text.check(written[self.key], (), check)
        return written.keys() == {self.key} and not check.found

    def schema(self, schemas: Schemas) -> Schema:
        return schemas.of(self.text)


class OneOf(ValueType):
    """A value that has one of several forms.

    The form that a value is meant to have is decided first, so that errors refer to that form only.

    Args:
        expected: What the value must be, as the message says if it has no such form.
        forms: The forms. A mapping without a key that tells has the first one of those that are mappings.
        name: Of its definition.
        apart: What to say of a key that belongs to another form, with ``{key}``, ``{owner}``, the type of that form,
            and ``{kind}``, the type of this one.
    """

    def __init__(self, expected: str, *forms: ValueType, name: str = "", apart: str = "") -> None:
        self.expected, self.all_forms, self.name, self._apart = expected, forms, name, apart
        self.records = [form for form in forms if isinstance(form, Record)]
        own = [record.all_keys for record in self.records]
        common = {name for name in own[0] if all(name in keys for keys in own)} if own else set()
        # Of each mapping, the keys that not all of them have: first those that it must have.
        self._telling = [
            (
                record,
                must,
                [name for name, key in record.all_keys.items() if name not in common and key.required is must],
            )
            for must in (True, False)
            for record in self.records
        ]

    def forms(self, version: Version) -> list[ValueType]:
        """Its forms in a version."""
        return [form for form in self.all_forms if form.since <= version]

    def keys(self, version: Version) -> dict[str, Key]:
        """The keys of all mappings among its forms in a version."""
        forms = [record.keys(version) for record in self.records if record.since <= version]
        return {name: key for keys in forms for name, key in keys.items()}

    def values_of_type(self, version: Version) -> tuple[str, ...]:
        """The values that the key ``type`` may have in a version."""
        records = [record for record in self.records if record.since <= version]
        return tuple(dict.fromkeys(value for record in records for value in record.values_of_type()))

    def form_of(self, value: Any, version: Version = VERSION2_1) -> ValueType | None:
        """The form that a value is meant to have in a version; None if it has none."""
        forms = [form for form in self.forms(version) if type(value) in form.types]
        if len(forms) <= 1 or type(value) is not dict:
            return forms[0] if forms else None
        if "type" in value and any(record.values_of_type() for record in self.records):
            forms = [form for form in forms if isinstance(form, Record) and value["type"] in form.values_of_type()]
            if not forms:
                first = self.records[0]
                return first if "type" in first.all_keys else None
        telling = (
            record for record, _, names in self._telling if record in forms and not value.keys().isdisjoint(names)
        )
        return next(telling, forms[0])

    def check(self, value: Any, at: Pointer, file: Check) -> None:
        form = self.form_of(value, file.version)
        if isinstance(form, Record):
            form.check(value, at, file, self)
        elif form is not None:
            form.check(value, at, file)
        elif type(value) is dict and self.records:
            file.report((*at, "type"), "choice", value=value["type"], about=self.values_of_type(file.version))
        elif len(forms := self.forms(file.version)) == 1:
            forms[0].check(value, at, file)
        else:
            file.report(at, "wrong-type", f"must be {self.expected}", value)

    def apart(self, record: Record, version: Version) -> dict[str, str]:
        """The keys of other forms that a mapping cannot have in a version, and why."""
        found: dict[str, str] = {}
        keys, kinds = record.keys(version), record.values_of_type()
        for other in self.records if self._apart else ():
            for name in other.keys(version) if other.since <= version else ():
                if name in keys or name in found:
                    continue
                if kinds and kinds == other.values_of_type():
                    rival = next(mine for mine in keys if mine not in other.all_keys)
                    found[name] = f"'{name}' and '{rival}' exclude one another"
                else:
                    owner = ", ".join(other.values_of_type())
                    found[name] = self._apart.format(key=name, owner=owner, kind=", ".join(kinds))
        return found

    def read(self, value: Any, at: Pointer) -> Any:
        form = self.form_of(value)
        if isinstance(form, Alone):
            value = {form.key: value}
            form = form.record or self.form_of(value)
        assert form is not None
        return form.read(value, at)

    def write(self, value: Any) -> Any:
        """A mapping without the keys that have their default; the text alone, where that says the same."""
        alone = next((form for form in self.all_forms if isinstance(form, Alone)), None)
        records = [*self.records, *([alone.record] if alone is not None and alone.record is not None else ())]
        written = next(record for record in records if record.model is type(value)).write(value)
        return written[alone.key] if alone is not None and alone.says(written) else written

    def schema(self, schemas: Schemas) -> Schema:
        forms = self.forms(schemas.version)
        return schemas.of(forms[0]) if len(forms) == 1 else {"oneOf": [schemas.of(form) for form in forms]}
