"""The materials of a URDF."""

from __future__ import annotations

from functools import partial

from eurdf.format.urdf.elements import WHITE, UrdfReader, named
from eurdf.reading.xml_reader import Element

#: Red, green, blue, alpha, or None; and the file name of a texture, or an empty text.
Look = tuple[tuple[float, float, float, float] | None, str]


class Materials:
    """The materials of one robot, by name."""

    def __init__(self, reader: UrdfReader) -> None:
        self._reader = reader
        self._known: dict[str, Look] = {}
        self._nameless = False  # whether a material of the robot has no name
        self._fileless: list[Element] = []  # textures that name no file

    def define(self, element: Element) -> None:
        """Add a material of the robot."""
        name = self._reader.name(element)
        look = self._look(element)
        if name is None:
            self._nameless = True
        else:
            self._known.setdefault(name, look)

    def of(self, element: Element) -> Look:
        """EU-URD-029: a material is defined where it is used, in the robot, or at an earlier use."""
        name = element.get("name", "")
        if element.find("color") is None and element.find("texture") is None:
            if name not in self._known:
                if self._nameless:  # the material without a name may be the one meant
                    return None, ""
                message = f"material '{name}' is not defined" if name else f"{named(element)} has no name and no color"
                if name:
                    self._reader.reporter.report_name("urdf-unknown-material", message, element, "name", self._known)
                else:
                    proposals = partial(self._reader.renamings_to, element, "name")
                    self._reader.report("urdf-unknown-material", message, element, "name", proposals=proposals)
                return None, ""
            return self._known[name]
        own = self._look(element)
        return self._known.setdefault(name, own) if name else own

    def report_textures(self) -> None:
        """EU-URD-033: warn of the textures that name no file, once for all: exporters write one in each material."""
        if not self._fileless:
            return
        first, *others = self._fileless
        more = f", and {len(others)} more" if others else ""
        self._reader.report(
            "urdf-texture-missing",
            f"{named(first)} names no file{more}",
            first,
            "filename",
            "add filename=…, or remove the element",
        )

    def _look(self, element: Element) -> Look:
        reader = self._reader
        found = reader.children(element)
        rgba: tuple[float, ...] | None = None
        if "color" in found:
            rgba = reader.required(found["color"], "rgba", 4)
        texture = self._file(found["texture"]) if "texture" in found else ""
        return rgba, texture  # type: ignore[return-value]

    def _file(self, texture: Element) -> str:
        """The file name of a texture; empty if it names none."""
        name = texture.get("filename", "")
        if name.strip(WHITE):
            return name
        if not self._reader.attributes(texture):  # a misspelt attribute is the same error
            self._fileless.append(texture)
        return ""
