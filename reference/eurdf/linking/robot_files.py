"""From the files of a robot to its mechanism, with all diagnostics; no simulator is loaded."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Literal, NamedTuple, TypeVar

from eurdf.collection import RobotFiles, find_robot
from eurdf.diagnostics import Diagnostics, FileError, Place
from eurdf.errors import CannotExpand, InvalidRobot
from eurdf.format.model import Description
from eurdf.format.read import read_description, version_of
from eurdf.format.urdf.data import Urdf
from eurdf.format.urdf.read import read_urdf
from eurdf.linking.inertia import check_inertias, check_leaves
from eurdf.linking.link import link
from eurdf.linking.missing_urdf import report_missing_urdf
from eurdf.mechanism.mechanism import Mechanism, Root
from eurdf.mesh_files.folders import Folders
from eurdf.reading.resource import FileFinder
from eurdf.reading.robot_source import RobotSource, display_name, source_of
from eurdf.reading.source import Source, Texts, decoded, read_bytes, read_source
from eurdf.reading.xacro import expand, expand_once, is_xacro
from eurdf.reading.xml_reader import read_xml
from eurdf.reading.yaml_reader import YamlDocument, read_yaml

_Part = TypeVar("_Part")

_NO_XACRO = "only a .xacro file accepts arguments; give one as the robot or as its URDF, or name one under 'urdf'"

#: What to do about errors of mimic joints: report them and refuse the URDF, report them only, or ignore them.
_MimicErrors = Literal["refused", "kept", "ignored"]


class ReadRobot(NamedTuple):
    """The files of a robot as read, and what they describe.

    Attributes:
        path: As the caller gave it.
        diagnostics: Found by all phases but the last, that of closures.
        tree: The URDF; None if it has an error itself, or was not read.
        linked: What the files describe; None if an error leaves nothing to build.
        yaml: The content of the description; None for a bare URDF, and if an error leaves nothing to build.
    """

    path: str
    diagnostics: Diagnostics
    tree: Urdf | None = None
    linked: Mechanism | None = None
    yaml: Description | None = None

    @property
    def urdf(self) -> Urdf:
        """The URDF of a robot that can be built."""
        return self._of_valid(self.tree)

    @property
    def mechanism(self) -> Mechanism:
        """What the files of a robot that can be built describe."""
        return self._of_valid(self.linked)

    @property
    def description(self) -> Description:
        """The content of the description of a robot that has one."""
        return self._of_valid(self.yaml)

    def _of_valid(self, part: _Part | None) -> _Part:
        if part is None:
            raise InvalidRobot(self.path, tuple(self.diagnostics))
        return part

    def place_of_constraint(self, name: str) -> Place:
        """Where a closure or a coupling is stated."""
        file = self.description
        pointers = {each.name: each.pointer for each in file.closures}
        pointers |= {each.name: each.pointer for each in file.couplings}
        return file.document.place(pointers[name])

    def place_of_configuration(self, name: str) -> Place:
        """Where a configuration is stated."""
        return self.description.document.place(("configurations", name), True)


def read_valid(path: RobotSource, **options: Any) -> ReadRobot:
    """Read and link the files of a robot, as `read_robot` does.

    Raises:
        InvalidRobot: It cannot be built without guessing.
    """
    read = read_robot(path, **options)
    if read.linked is None or read.diagnostics.refused:
        raise InvalidRobot(read.path, tuple(read.diagnostics))
    return read


def read_robot(
    path: RobotSource,
    urdf: RobotSource | None = None,
    root: Root | None = None,
    *,
    geometry: bool = True,
    mimic: bool = True,
    package_dirs: Sequence[str | os.PathLike[str]] = (),
    xacro_args: Mapping[str, str] | None = None,
    confined: bool = False,
    allow_outside: bool = False,
    inertias: bool = True,
    texts: Texts | None = None,
) -> ReadRobot:
    """Read and link the files of a robot, and check its inertias.

    EU-DIA-002: what needs a file that has an error is not checked, so that no consequence of that error is reported.

    Args:
        path: What `find_robot` takes.
        urdf: A URDF in place of the one that the description names.
        root: In place of the root that the description states.
        geometry: Whether to read the geometry; else bodies have none, and it is not checked.
        mimic: Whether mimic joints depend on their leaders; if not, each is free, and an error in its leader is
            reported but leaves a mechanism. With a description of version 1 they are free in any case, and not checked.
        package_dirs: Folders to look for packages in, which a xacro finds files in.
        xacro_args: Values of the arguments of a xacro.
        confined: Whether a URDF that the description names must be in the folder of the description.
        allow_outside: Whether meshes may be anywhere, for `find_meshes`: no mesh is looked for here.
        inertias: Whether to check the inertias of a robot that can be linked. If not, `inertia_diagnostics` does.
        texts: In place of those of files, by path or by name; what is read, or expanded from a xacro, is added.

    Raises:
        RobotNotFound: Where there are no such files.
        CannotExpand: A xacro has an error, or arguments are given for what is no xacro.
        MissingExtra: A xacro is given, and the extra ``xacro`` is not installed.
        ValueError: Files are confined to their folder, and allowed outside it.
    """
    if confined and allow_outside:
        raise ValueError("confined and allow_outside exclude each other; choose one of them")
    diagnostics, texts = Diagnostics(), Texts() if texts is None else texts
    name = display_name(path)
    try:
        files = RobotFiles(*(_open(file, texts) for file in find_robot(path, urdf, texts)))
        given = files.urdf and _expanded(files.urdf, name, diagnostics, package_dirs, xacro_args)
    except FileError as error:
        diagnostics.add(error.diagnostic)
        return ReadRobot(name, diagnostics)
    if files.description is None:
        assert given is not None
        read, description = partial(_own_source, given, confined, texts), None
        mimic_errors: _MimicErrors = "refused" if mimic else "kept"
    else:
        document = _read_description(files.description, diagnostics, confined, texts)
        description = None if document is None else read_description(document, diagnostics)
        if given is not None:
            read = partial(_own_source, given, texts=texts)
        else:
            own = files.description
            folder = own.folder if isinstance(own, Source) else own.parent
            named = named_urdf(folder, description, document)
            is_inside = _is_inside(named, folder)
            if not _may_read(named, is_inside, own, description, diagnostics, confined, texts):
                return ReadRobot(name, diagnostics)
            # Another file that the description names may be anyone's: no line of it is shown.
            read = partial(_named_source, named, is_inside, texts)
            if is_xacro(named):
                if description is None:
                    return ReadRobot(name, diagnostics)
                real = Path(os.path.realpath(named)).parent
                finder = FileFinder(named.parent, package_dirs, real_folder=real, allow_outside=allow_outside)
                folders = None if confined else finder.folders
                read = partial(_named_xacro, named, description, diagnostics, package_dirs, xacro_args, folders, texts)
            elif description is not None and xacro_args:
                raise CannotExpand(name, _NO_XACRO)
        # Without a version, whether a mimic has an effect is not known.
        version = description.version if description is not None else document and version_of(document)
        mimic_errors = "ignored" if version in (None, "1") else "refused" if mimic else "kept"
    tree = _read_urdf(read, diagnostics, geometry, mimic_errors)
    if tree is None:
        return ReadRobot(name, diagnostics)
    mechanism = None
    if description is not None or files.description is None:
        mechanism = link(tree, description, diagnostics, root, mimic=mimic)
    if mechanism is None:
        check_inertias(tree, diagnostics)
        return ReadRobot(name, diagnostics, tree)
    if inertias:
        _check_inertias_and_leaves(tree, mechanism, diagnostics)
    return ReadRobot(name, diagnostics, tree, mechanism, description)


def inertia_diagnostics(read: ReadRobot) -> Diagnostics:
    """What is wrong with the inertias of a robot that `read_robot` did not check."""
    diagnostics = Diagnostics()
    _check_inertias_and_leaves(read.urdf, read.mechanism, diagnostics)
    return diagnostics


def _check_inertias_and_leaves(urdf: Urdf, mechanism: Mechanism, diagnostics: Diagnostics) -> None:
    check_leaves(mechanism, urdf, diagnostics, check_inertias(urdf, diagnostics))


def read_urdf_alone(
    path: RobotSource,
    diagnostics: Diagnostics,
    package_dirs: Sequence[str | os.PathLike[str]] = (),
    xacro_args: Mapping[str, str] | None = None,
) -> Urdf:
    """Read what is given as a URDF, without looking for a description.

    Raises:
        InvalidRobot: It has an error.
        CannotExpand, MissingExtra: See `read_robot`, which also explains the arguments.
    """
    try:
        text = source_of(path)
        file = Path(display_name(path)) if text is None else text
        given = _expanded(file, display_name(path), diagnostics, package_dirs, xacro_args)
    except FileError as error:
        diagnostics.add(error.diagnostic)
        urdf = None
    else:
        urdf = _read_urdf(partial(_own_source, given), diagnostics, geometry=True, mimic_errors="refused")
    if urdf is None:
        raise InvalidRobot(display_name(path), tuple(diagnostics))
    return urdf


def _expanded(
    urdf: Path | Source,
    name: str,
    diagnostics: Diagnostics,
    package_dirs: Sequence[str | os.PathLike[str]],
    xacro_args: Mapping[str, str] | None,
) -> Path | Source:
    """A URDF that the caller gave, or that a xacro is expanded to."""
    if isinstance(urdf, Path) and is_xacro(urdf) and os.path.lexists(urdf):
        source, warnings = expand(urdf, xacro_args, package_dirs)
        _add_warnings(urdf, warnings, diagnostics)
        return source
    if xacro_args:
        raise CannotExpand(name, _NO_XACRO)
    return urdf


def _named_xacro(
    urdf: Path,
    description: Description,
    diagnostics: Diagnostics,
    package_dirs: Sequence[str | os.PathLike[str]],
    xacro_args: Mapping[str, str] | None,
    folders: Folders | None,
    texts: Texts,
) -> Source:
    """The URDF that a xacro, which the description names, is expanded to; it reads ``folders``, None if confined.

    Raises:
        CannotExpand: It has an error, and arguments are given, which may be the reason.
        FileError: ``file-unreadable``: it is no regular file, has an error, or files are confined; or
            ``file-too-large``.
        MissingExtra: See `read_robot`.
    """
    place = description.document.place(("urdf",))
    if folders is None:
        message = f"the URDF '{urdf}' is a xacro, which is a program, and files are confined to their folder"
        raise FileError("file-unreadable", message, place, "expand it, and name the result")
    read_bytes(os.fspath(urdf))  # refuses what is no regular file, as of every file that a description names
    try:
        source, warnings = expand_once(texts, urdf, xacro_args, package_dirs, folders)
    except CannotExpand as error:
        if xacro_args:
            raise
        raise FileError("file-unreadable", str(error), place) from None
    _add_warnings(urdf, warnings, diagnostics)
    return replace(source, is_quoted=_is_inside(urdf, description.document.source.folder))


def _add_warnings(xacro: Path, warnings: str, diagnostics: Diagnostics) -> None:
    if warnings:
        diagnostics.report("x-xacro-warning", f"xacro warns: {' '.join(warnings.split())}", Place(os.fspath(xacro)))


def _read_urdf(
    read: Callable[[], Source], diagnostics: Diagnostics, geometry: bool, mimic_errors: _MimicErrors
) -> Urdf | None:
    try:
        document = read_xml(read())
    except FileError as error:
        diagnostics.add(error.diagnostic)
        return None
    mimic_diagnostics = diagnostics if mimic_errors == "refused" else Diagnostics()
    urdf = read_urdf(document, diagnostics, geometry=geometry, mimic_diagnostics=mimic_diagnostics)
    if mimic_errors == "kept":
        for found in mimic_diagnostics:
            diagnostics.add(found)
    return urdf


def named_urdf(folder: Path, description: Description | None, document: YamlDocument | None) -> Path:
    """The URDF that a description in a folder names, which may have errors."""
    name = "robot.urdf"
    if description is not None:
        name = description.urdf
    elif document is not None and isinstance(document.data, dict) and isinstance(document.data.get("urdf"), str):
        name = document.data["urdf"]
    try:
        return folder / name
    except ValueError:
        return folder / "robot.urdf"


def _read_description(
    path: Path | Source, diagnostics: Diagnostics, confined: bool, texts: Texts
) -> YamlDocument | None:
    try:
        return read_yaml(_own_source(path, confined, texts))
    except FileError as error:
        diagnostics.add(error.diagnostic)
        return None


def _own_source(path: Path | Source, confined: bool = False, texts: Texts | None = None) -> Source:
    """The text of a file of the robot that the caller named, or found in a folder, which is added to those read.

    `FileError` if it cannot be read; or if files are confined to their folder, and it is a link to one elsewhere.
    """
    if isinstance(path, Source):
        return path
    is_inside = _is_inside(path, path.parent)
    if confined and not is_inside:
        message = f"'{path}' is a link to a file in another folder, and files are confined to their folder"
        raise FileError("file-unreadable", message, Place(os.fspath(path)))
    return _read(Texts() if texts is None else texts, path, is_inside)


def _read(texts: Texts, path: Path, is_quoted: bool) -> Source:
    source = read_source(path, is_quoted=is_quoted)
    texts[source.file] = source.text
    return source


def _open(file: Path | Source | None, texts: Texts) -> Path | Source | None:
    """A file, or what was read already, or else the text in its place."""
    if file is None:
        return None
    name = file.file if isinstance(file, Source) else os.fspath(file)
    if (text := texts.get(name)) is None:
        return file
    base, is_quoted = (file.base, file.is_quoted) if isinstance(file, Source) else (None, _is_inside(file, file.parent))
    return decoded(text.encode(), name, base, is_quoted=is_quoted)


def _named_source(path: Path, is_quoted: bool, texts: Texts) -> Source:
    """The text of the URDF that a description names, or the one in its place."""
    found = _open(path, texts)
    return replace(found, is_quoted=is_quoted) if isinstance(found, Source) else _read(texts, path, is_quoted)


def _is_inside(path: Path, folder: Path) -> bool:
    """Whether a file is in a folder, with every symbolic link followed."""
    if path.parent == folder and path.name not in ("", "..") and not os.path.islink(path):
        return True  # whatever the folder is a link to
    try:
        return path.resolve().is_relative_to(folder.resolve())
    except (OSError, ValueError, RuntimeError):  # a path that cannot be one, or a circle of links
        return True  # which is an error where it is read


def _may_read(
    path: Path,
    is_inside: bool,
    file: Path | Source,
    description: Description | None,
    diagnostics: Diagnostics,
    confined: bool,
    texts: Texts,
) -> bool:
    """Whether the URDF that the description names exists, and is in its folder if files are confined to it.

    If the description could not be read, its URDF is a guess, so a second error would be wrong.
    """
    if confined and not is_inside:
        if description is not None:
            message = f"the URDF '{path}' is outside the folder of the description, and files are confined to it"
            hint = "move the URDF into the folder, or give it with --urdf (urdf= in Python)"
            diagnostics.report("file-unreadable", message, description.document.place(("urdf",)), hint)
        return False
    if not (os.fspath(path) in texts or os.path.lexists(path)):
        if description is not None:
            report_missing_urdf(path, description, diagnostics)
        return False
    # Some installers fill a folder with links into one other folder.
    if not (is_inside or description is None or (isinstance(file, Path) and _is_inside(path, file.resolve().parent))):
        diagnostics.report(
            "x-urdf-outside-folder",
            f"the URDF '{path}' is outside the folder of the description",
            description.document.place(("urdf",)),
            "keep the URDF in this folder, or below it; --confined refuses others",
        )
    return True
