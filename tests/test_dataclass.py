"""Frozen dataclasses of this package do what those of the standard library do."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import math
import pickle
from functools import cached_property
from types import SimpleNamespace
from typing import Any, ClassVar, get_type_hints

import pytest

from eurdf.dataclass import dataclass
from eurdf.mechanism.frame import Anchor
from eurdf.mechanism.pose import Pose


def classes(dataclass: Any) -> Any:
    """Classes of all options and kinds of fields, defined by a function."""

    @dataclass(frozen=True, slots=True)
    class Point:
        """A value."""

        kind: ClassVar[str] = "point"
        x: float
        y: float = 2.0
        tags: list[str] = dataclasses.field(default_factory=list)
        note: str = dataclasses.field(default="", compare=False, repr=False)

    @dataclass(frozen=True, slots=True)
    class Named(Point):  # type: ignore[misc]
        """A value with a base."""

        name: str = "a"

    @dataclass(frozen=True, slots=True)
    class Single:
        """A value of one field, and one that has no hash."""

        value: float
        parts: list[float] = dataclasses.field(default_factory=list, hash=False)

    @dataclass(frozen=True, eq=False, repr=False, kw_only=True)
    class Square:
        """No value: it has an identity, a cache, and fields of its own making."""

        side: float
        made: dict[str, float] = dataclasses.field(init=False, default_factory=dict)
        unit: str = dataclasses.field(init=False, default="m")
        area: float = dataclasses.field(init=False)

        def __post_init__(self) -> None:
            object.__setattr__(self, "area", self.side**2)

        @cached_property
        def diagonal(self) -> float:
            return math.sqrt(2.0 * self.area)

    @dataclass(slots=True)
    class Open:
        """A class that is not frozen."""

        x: float

    return SimpleNamespace(Point=Point, Named=Named, Single=Single, Square=Square, Open=Open)


@pytest.fixture(params=[dataclass, dataclasses.dataclass], ids=["ours", "library"])
def of(request: pytest.FixtureRequest) -> Any:
    """The classes as defined by either function."""
    return classes(request.param)


def test_text_is_that_of_the_fields(of: Any) -> None:
    assert repr(of.Point(1.0, tags=["a"], note="b")).endswith("Point(x=1.0, y=2.0, tags=['a'])")
    assert repr(of.Named(1.0)).endswith("Named(x=1.0, y=2.0, tags=[], name='a')")
    assert repr(of.Square(side=1.0)).startswith("<")


def test_signature_is_that_of_the_fields(of: Any) -> None:
    expected = "(x: 'float', y: 'float' = 2.0, tags: 'list[str]' = <factory>, note: 'str' = '') -> None"
    assert str(inspect.signature(of.Point)) == expected
    assert str(inspect.signature(of.Square)) == "(*, side: 'float') -> None"
    assert of.Point.__match_args__ == ("x", "y", "tags", "note")
    assert get_type_hints(of.Point.__init__) == {
        "x": float,
        "y": float,
        "tags": list[str],
        "note": str,
        "return": type(None),
    }


def test_equality_is_that_of_the_fields(of: Any) -> None:
    assert of.Point(1.0, note="a") == of.Point(1.0, note="b") != of.Point(2.0)
    assert of.Named(1.0) != of.Point(1.0)
    assert of.Single(1.0) == of.Single(1.0) != of.Single(2.0)
    assert of.Square(side=1.0) != of.Square(side=1.0)


def test_hash_is_that_of_the_fields(of: Any) -> None:
    assert hash(of.Single(1.0)) == hash((1.0,))
    assert hash(of.Point(1.0, tags=(), note="a")) == hash((1.0, 2.0, ()))
    with pytest.raises(TypeError, match="unhashable type: 'list'"):
        hash(of.Point(1.0))


def test_defaults_are_given_or_made(of: Any) -> None:
    assert of.Point(1.0).tags is not of.Point(1.0).tags
    square = of.Square(side=2.0)
    assert (square.made, square.unit, square.area, square.diagonal) == ({}, "m", 4.0, math.sqrt(8.0))


def test_nothing_is_assigned_to_a_frozen_field(of: Any) -> None:
    for value, name in (
        (of.Point(1.0), "x"),
        (of.Named(1.0), "x"),
        (of.Named(1.0), "name"),
        (of.Square(side=1.0), "side"),
    ):
        with pytest.raises(dataclasses.FrozenInstanceError, match=f"cannot assign to field '{name}'"):
            setattr(value, name, 1.0)
        with pytest.raises(dataclasses.FrozenInstanceError, match=f"cannot delete field '{name}'"):
            delattr(value, name)
    assert not hasattr(of.Point(1.0), "__dict__")


def test_class_that_is_not_frozen_can_be_assigned_to(of: Any) -> None:
    value = of.Open(1.0)
    value.x = 2.0
    assert value == of.Open(2.0)


def test_copies_are_equal(of: Any) -> None:
    for value in (of.Point(1.0, tags=["a"], note="b"), of.Named(1.0, name="c", note="b")):
        for copied in (copy.copy(value), copy.deepcopy(value), dataclasses.replace(value)):
            assert copied == value
            assert copied.note == "b"


def test_value_can_be_pickled() -> None:
    anchor = Anchor("rod", Pose((1.0, 2.0, 3.0)), "end")
    assert pickle.loads(pickle.dumps(anchor)) == anchor


def test_library_checks_subclasses(of: Any) -> None:
    @dataclasses.dataclass(frozen=True, slots=True)
    class Sub(of.Point):  # type: ignore[misc]
        z: float = 3.0

    assert Sub(1.0) == Sub(1.0, z=3.0) != Sub(1.0, z=4.0)
    with pytest.raises(TypeError, match="cannot inherit non-frozen dataclass from a frozen one"):
        dataclasses.dataclass(type("Wrong", (of.Point,), {}))
