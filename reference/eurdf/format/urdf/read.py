"""Reading a URDF."""

from __future__ import annotations

from eurdf.diagnostics import Diagnostics
from eurdf.format.urdf.data import Urdf, UrdfJoint, UrdfLink
from eurdf.format.urdf.elements import UrdfReader
from eurdf.format.urdf.joints import read_joint
from eurdf.format.urdf.links import read_link
from eurdf.format.urdf.materials import Materials
from eurdf.format.urdf.tree import build_tree
from eurdf.reading.other_formats import of_element, of_root
from eurdf.reading.xml_reader import Element, XmlDocument, XmlReporter, written_name

#: Elements by which other dialects state a closure or a coupling; a parser of this format would ignore them.
_CLOSURE_DIALECTS = frozenset({"loop", "loop_joint", "constraint", "coupling"})

#: The versions of URDF; a robot that states none has the rules of the first.
_VERSIONS = ("1.0", "1.1", "1.2")

#: Joints that a robot may have, fixed ones too (EU-FIL-002). A description adds joints to those of the URDF, where it
#: splits one in two, and removes none: of three merged joints, two become fixed.
JOINT_LIMIT = 10_000


def read_urdf(
    document: XmlDocument,
    diagnostics: Diagnostics,
    *,
    geometry: bool = True,
    mimic_diagnostics: Diagnostics | None = None,
) -> Urdf | None:
    """Read a URDF and check it without the YAML file; None if an error was added to ``diagnostics``.

    Without ``geometry``, links have no visuals and collisions, and these are not checked. What is wrong with mimic
    joints goes to ``mimic_diagnostics``, if given: for a caller that ignores mimics.
    """
    before = diagnostics.error_count
    of_mimics = diagnostics if mimic_diagnostics is None else mimic_diagnostics
    reader = UrdfReader(XmlReporter(document, diagnostics), XmlReporter(document, of_mimics))
    urdf = _read_robot(reader, document.root, Materials(reader) if geometry else None)
    return None if diagnostics.error_count > before else urdf


def _read_robot(reader: UrdfReader, root: Element, materials: Materials | None) -> Urdf | None:
    if not _is_robot(reader, root) or not _has_known_version(reader, root):
        return None
    name = reader.name(root)
    elements: list[tuple[str, Element]] = []
    for element in root:
        tag = element.tag
        if tag in ("link", "joint"):
            elements.append((tag, element))
        elif tag == "material":
            if materials is not None:
                materials.define(element)
        elif isinstance(tag, str) and not _is_of_other_dialect(reader, element):
            reader.unknown(root, element)
    count = sum(tag == "joint" for tag, _ in elements)
    if count > JOINT_LIMIT:
        reader.report("file-too-large", f"the robot has {count:,} joints; the maximum is {JOINT_LIMIT:,}", root)
        return None
    links: list[UrdfLink] = []
    joints: list[UrdfJoint] = []
    for tag, element in elements:
        if tag == "link":
            if link := read_link(reader, element, materials):
                links.append(link)
        elif joint := read_joint(reader, element):
            joints.append(joint)
    if materials is not None:
        materials.report_textures()
    reader.report_later()
    if name is None or len(links) + len(joints) < len(elements):
        return None
    return build_tree(reader, name, links, joints)


def _is_robot(reader: UrdfReader, root: Element) -> bool:
    """EU-URD-003: the root element is ``robot``."""
    if root.tag == "robot":
        return True
    found = of_root(str(root.tag))
    message = f"the root element is <{written_name(root, str(root.tag))}>; it must be <robot>"
    reader.report("urdf-root-element", message, root, hint=found and found.hint)
    return False


def _has_known_version(reader: UrdfReader, root: Element) -> bool:
    """EU-URD-037: whether the version that the robot states, if it states one, exists; the reader gets it."""
    version = root.get("version")
    if version is None or version in _VERSIONS:
        reader.version = version or ""
        return True
    known = ", ".join(_VERSIONS[:-1]) + f" or {_VERSIONS[-1]}"
    message = f"URDF has no version '{version}'; it must be {known}"
    hint = f'write version="{version}.0"' if f"{version}.0" in _VERSIONS else "leave it out for URDF 1.0"
    reader.report("urdf-version", message, root, "version", hint)
    return False


def _is_of_other_dialect(reader: UrdfReader, element: Element) -> bool:
    """EU-URD-027: whether an element of the robot states a closure in another dialect, which is reported."""
    local = str(element.tag).rpartition("}")[2]
    if local not in _CLOSURE_DIALECTS and not local.endswith("_constraint"):
        return False
    found, hint = of_element(element), "describe it under 'closures' in the description"
    if found is not None:
        hint = f"{found.hint}, or {hint}" if found.importer else found.hint
    reader.report(
        "urdf-closure-ignored",
        f"<{local}> is a constraint of another dialect of URDF and has no effect here",
        element,
        hint=hint,
    )
    return True
