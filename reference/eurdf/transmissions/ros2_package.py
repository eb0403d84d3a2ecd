"""The transmission as a package of ROS 2: a plugin of ros2_control around the generated C."""

from __future__ import annotations

import re
from collections.abc import Sequence
from importlib.resources import files
from string import Template
from xml.sax.saxutils import escape, quoteattr

from eurdf.transmissions.generated_source import GeneratedSource

# Of each template, the path of its file in the package.
_FILES = {
    "CMakeLists.txt": "CMakeLists.txt",
    "package.xml": "package.xml",
    "plugins.xml": "plugins.xml",
    "transmission.xml": "transmission.xml",
    "plugin.cpp": "src/plugin.cpp",
    "transmission.hpp": "include/{package}/transmission.hpp",
}


def ros2_package(
    source: GeneratedSource, robot: str, joints: Sequence[str], motors: Sequence[str], real: str
) -> GeneratedSource:
    """The package; see `eurdf.transmissions.prepared.PreparedTransmission.ros2_package`.

    Args:
        source: The C, in both directions.
        robot: Name of the robot.
        joints: Names of the serial joints.
        motors: Names of the motors, as many.
        real: The type of the numbers in C.
    """
    header, c_file = source.files
    name = header.removesuffix(".h")
    # A name of a package has small letters, digits and single underscores.
    package = re.sub(r"_+", "_", f"{name}_ros2".lower())
    elements = [
        f"  <{element} name={quoteattr(label)} role={quoteattr(label)}/>\n"
        for element, labels in (("joint", joints), ("actuator", motors))
        for label in labels
    ]
    values = {
        "package": package,
        "name": name,
        "NAME": name.upper(),
        "robot": escape(robot),
        "size": str(len(joints)),
        "joints": ", ".join(map(_literal, joints)),
        "motors": ", ".join(map(_literal, motors)),
        "real": real,
        "elements": "".join(elements),
    }
    made = {f"include/{package}/{header}": source.files[header], f"src/{c_file}": source.files[c_file]}
    templates = files("eurdf.transmissions") / "ros2"
    for template, path in _FILES.items():
        text = (templates / template).read_text(encoding="utf-8")
        made[path.format(package=package)] = Template(text).substitute(values).encode()
    return GeneratedSource(made)


def _literal(name: str) -> str:
    """A string of C++ with the bytes of a name in UTF-8."""
    plain = (chr(byte) if 32 <= byte < 127 and chr(byte) not in '"\\?' else f"\\{byte:03o}" for byte in name.encode())
    return f'"{"".join(plain)}"'
