"""The versions of the YAML file."""

from __future__ import annotations

from typing import Literal

#: The key that states the version; files of version 1 lack it.
VERSION_KEY = "extended_urdf"

Version = Literal["1", "2.0", "2.1"]
VERSION2_0: Literal["2.0"] = "2.0"
VERSION2_1: Literal["2.1"] = "2.1"
