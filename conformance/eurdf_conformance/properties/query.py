"""The queries to a parser about one mechanism."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from eurdf_conformance.level import Version
from eurdf_conformance.properties.document import configuration
from eurdf_conformance.properties.files import Files, files_of
from eurdf_conformance.properties.mechanism import Configuration, Mechanism


@dataclass(frozen=True)
class Query:
    """Two files, and the configurations at which the robot is evaluated.

    Attributes:
        mechanism: What the files say.
        version: Version of the description.
        files: The files.
        configurations: In the joints of that version.
        frames: Names of the frames of which poses are asked for.
    """

    mechanism: Mechanism
    version: Version
    files: Files
    configurations: Sequence[Mapping[str, Sequence[float]]]
    frames: Sequence[str]


def query_of(
    mechanism: Mechanism,
    version: Version,
    *,
    files: Files | None = None,
    at: Mapping[str, Configuration] | None = None,
    frames: Sequence[str] | None = None,
) -> Query:
    """A query about a mechanism.

    Args:
        mechanism: The mechanism.
        version: Version of the description.
        files: Its files, if they are not those that people would write.
        at: Configurations in place of its own, in its own joints.
        frames: Frames in place of all that it has.
    """
    stated = mechanism.configurations if at is None else at
    return Query(
        mechanism,
        version,
        files or files_of(mechanism, version),
        [configuration(mechanism, each, version) for each in stated.values()],
        all_frames(mechanism) if frames is None else frames,
    )


def all_frames(mechanism: Mechanism) -> list[str]:
    """The names of all frames: links, joints, merged joints, and frames of the description."""
    names = [link.name for link in mechanism.links]
    names += [joint.name for joint in mechanism.joints]
    names += [name for name, change in mechanism.changes.items() if change.merges]
    names += [frame.name for frame in mechanism.frames]
    return list(dict.fromkeys(names))
