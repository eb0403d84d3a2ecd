"""Files made to hurt, and what becomes of them.

``python tests/support/hostile.py NAME…`` checks, reports and loads each in a process of its own, bounded in time
and memory, and writes one JSON line for each: what was found, the processor time in s, the memory in MiB.
"""

from __future__ import annotations

import json
import os
import resource
import signal
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

#: Processor time after which checking, reporting and loading one is taken not to end, in s; the slowest takes about 8.
CPU_SECONDS = 120

#: Memory that one may take beyond that of the packages, in MiB.
MEMORY = 1024

VERSION2 = 'extended_urdf: "2.0"\n'


@dataclass(frozen=True, slots=True)
class Hostile:
    """A robot made to hurt.

    Attributes:
        code: Code of the diagnostic that refuses it, or name of the exception; empty where it is a robot after all.
        write: Writes its files into a folder; returns the path to check.
    """

    code: str
    write: Callable[[Path], Path]


def _files(code: str, make: Callable[[], tuple[str | bytes | None, str | bytes]]) -> Hostile:
    def write(folder: Path) -> Path:
        description, urdf = make()
        for name, content in (("robot.urdf", urdf), ("robot.yaml", description)):
            if content is not None:
                (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
        return folder / ("robot.urdf" if description is None else "robot.yaml")

    return Hostile(code, write)


def _yaml(code: str, text: str | bytes) -> Hostile:
    return _files(code, lambda: (text, star(2)))


def _urdf(code: str, make: Callable[[], str | bytes]) -> Hostile:
    return _files(code, lambda: (None, make()))


def _linked(folder: Path) -> Path:
    (folder / "robot.yaml").symlink_to("/dev/zero")
    return folder / "robot.yaml"


def _pipe(folder: Path) -> Path:
    os.mkfifo(folder / "robot.yaml")
    return folder / "robot.yaml"


def _folder(folder: Path) -> Path:
    (folder / "robot.yaml").mkdir()
    return folder / "robot.yaml"


def _sparse(name: str) -> Callable[[Path], Path]:
    def write(folder: Path) -> Path:
        with (folder / name).open("wb") as file:
            file.truncate(100 << 20)
        return folder / name

    return write


def _pipe_as_urdf(folder: Path) -> Path:
    os.mkfifo(folder / "pipe.urdf")
    (folder / "robot.yaml").write_text(VERSION2 + "urdf: pipe.urdf\n")
    return folder / "robot.yaml"


def _named_urdf(name: str) -> Hostile:
    return _files("urdf-not-found", lambda: (VERSION2 + f"urdf: {json.dumps(name)}\n", star(2)))


def joint(name: str, parent: str, child: str, kind: str = "continuous", content: str = "") -> str:
    return f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{content}</joint>'


INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'


def robot(links: Sequence[str], joints: Sequence[str], content: str = "") -> str:
    elements = (f'<link name="{link}">{content}</link>' for link in links)
    return '<robot name="r">' + "".join(elements) + "".join(joints) + "</robot>"


def numbered(count: int, prefix: str = "l") -> list[str]:
    return [f"{prefix}{index}" for index in range(count)]


def chain(joints: int, kind: str = "continuous") -> str:
    return robot(numbered(joints + 1), [joint(f"j{i}", f"l{i}", f"l{i + 1}", kind) for i in range(joints)])


def star(joints: int, kind: str = "continuous", content: str = "") -> str:
    return robot(numbered(joints + 1), [joint(f"j{i}", "l0", f"l{i + 1}", kind, content) for i in range(joints)])


def mimics(joints: int, last: str) -> str:
    following = [f'<mimic joint="j{index + 1}"/>' for index in range(joints - 1)] + [last]
    return robot(
        numbered(joints + 1),
        [joint(f"j{i}", "l0", f"l{i + 1}", content=mimic) for i, mimic in enumerate(following)],
    )


def shared(closures: int, joints: int) -> tuple[str, str]:
    """Closures between the first hundred links of a chain and its last ones."""
    pairs = (f"l{i % 100}, l{joints - i // 100}" for i in range(closures))
    items = "".join(f"- {{name: c{i}, type: 3d, frames: [{pair}]}}\n" for i, pair in enumerate(pairs))
    return f"{VERSION2}closures:\n{items}", chain(joints)


def four_bars(count: int, in_series: bool, ground: float = 1.6) -> tuple[str, str]:
    """Four-bars, each on the rocker of the one before, or side by side on the ground; they close up to 3.7 m of it."""
    links, joints, closures, foot, y = ["ground"], [], [], "ground", 0.0
    for i in range(count):
        parent = foot
        for name, xyz in (("crank", f"0 {y} 0"), ("coupler", "1 0 0"), ("rocker", "1.5 0 0")):
            links.append(f"{name}{i}")
            joints.append(
                joint(f"{name}_pin{i}", parent, f"{name}{i}", content=f'<origin xyz="{xyz}"/><axis xyz="0 0 1"/>')
            )
            parent = f"{name}{i}"
        ends = f"{{link: {foot}, xyz: [{ground}, {y}, 0]}}, {{link: {parent}, xyz: [1.2, 0, 0]}}"
        closures.append(f"- {{name: loop{i}, type: 3d, frames: [{ends}]}}\n")
        foot, y = (parent, 0.1) if in_series else ("ground", y + 0.1)
    cranks = ", ".join(f"crank_pin{i}" for i in range(count))
    return f"{VERSION2}actuators: [{cranks}]\nclosures:\n{''.join(closures)}", robot(links, joints, INERTIAL)


def many(key: str, item: str, count: int) -> str:
    return f"{VERSION2}{key}:\n" + "".join(f"- {item.format(i)}\n" for i in range(count))


def entity_bomb() -> str:
    entities = "".join(f'<!ENTITY e{i + 1} "{f"&e{i};" * 10}">' for i in range(10))
    return f'<!DOCTYPE robot [<!ENTITY e0 "ha">{entities}]><robot name="&e10;"/>'


def alias_bomb() -> str:
    return "k0: &a0 [x, x]\n" + "".join(f"k{i + 1}: &a{i + 1} [{', '.join([f'*a{i}'] * 9)}]\n" for i in range(9))


HOSTILE = {
    # what is no text, or never ends
    "an endless device": Hostile("file-unreadable", _linked),
    "a pipe": Hostile("file-unreadable", _pipe),
    "a pipe for a URDF": Hostile("file-unreadable", _pipe_as_urdf),
    "a folder named robot.yaml": Hostile("RobotNotFound", _folder),
    "a YAML file of 100 MB": Hostile("file-too-large", _sparse("robot.yaml")),
    "a URDF of 100 MB": Hostile("file-too-large", _sparse("robot.urdf")),
    "binary data for YAML": _yaml("file-not-utf8", b"\x7fELF\x02\x01\x01" + bytes(range(256)) * 400),
    "binary data for a URDF": _urdf("file-not-utf8", lambda: b"\x7fELF\x02\x01\x01" + bytes(range(256)) * 400),
    "a path of 100,000 letters": _named_urdf("n" * 100_000),
    "a path with a NUL": _named_urdf("a\0b"),
    # what grows when it is read
    "an entity bomb": _urdf("xml-doctype", entity_bomb),
    "an alias bomb": _yaml("yaml-alias", alias_bomb()),
    "100,000 elements in one another": _urdf("file-too-large", lambda: "<a>" * 100_000 + "</a>" * 100_000),
    "100,000 lists in one another": _yaml("yaml-too-deep", "[" * 100_000),
    "a scalar of 16 MB": _yaml("urdf-not-found", f"{VERSION2}urdf: {'x' * 16_000_000}\n"),
    "8,000 keys that are near misses": _yaml("", "type: []\n" + "".join(f"name_mo{i}: 1\n" for i in range(8_000))),
    "20,000 unknown keys": _yaml("unknown-key", VERSION2 + "".join(f"clos{i}: 1\n" for i in range(20_000))),
    # an error over and over
    "40,000 links of one name": _urdf("urdf-duplicate-link", lambda: robot(["a"] * 40_000, [])),
    "60,000 different unknown elements": _urdf(
        "urdf-no-link", lambda: '<robot name="r">' + "".join(f"<a{i}/>" for i in range(60_000)) + "</robot>"
    ),
    "60,000 misspelt elements": _urdf("urdf-no-link", lambda: '<robot name="r">' + "<lnik/>" * 60_000 + "</robot>"),
    "5,000 joints with an error each": _urdf("urdf-bad-number", lambda: star(5_000, content='<axis xyz="1 x 0"/>')),
    "8,000 unknown links among as many known": _urdf(
        "urdf-unknown-link",
        lambda: robot(
            numbered(8_000, "link_number_"),
            [joint(f"j{i}", f"lnik_number_{i}", f"link_nmber_{i}") for i in range(8_000)],
        ),
    ),
    "20,000 unknown actuators of 3,000 joints": _files(
        "unknown-actuator", lambda: (many("actuators", "lj{}", 20_000), star(3_000))
    ),
    "3,000 closures of unknown frames": _files(
        "unknown-frame",
        lambda: (many("closures", "{{name: c{0}, type: 3d, frames: [x{0}, y{0}]}}", 3_000), star(3_000)),
    ),
    "16,000 unknown joints in configurations": _files(
        "configuration-joint",
        lambda: (
            f"{VERSION2}configurations:\n"
            + "".join(f"  c{k}: {{{', '.join(f'x{i}: 1' for i in range(800))}}}\n" for k in range(20)),
            star(2_000),
        ),
    ),
    "names of 100,000 letters": _files(
        "unknown-actuator",
        lambda: (
            many("actuators", "a" * 100_000 + "{}", 10),
            robot(
                numbered(20, "b" * 100_000),
                [joint("j" * 100_000 + str(i), "b" * 100_000 + "0", f"{'b' * 100_000}{i}") for i in range(1, 20)],
            ),
        ),
    ),
    "3,000 names of one letter over and over": _files(
        "unknown-actuator",
        lambda: (
            VERSION2 + "actuators:\n" + "".join(f"- {'a' * (80 + i % 100)}b{i}\n" for i in range(3_000)),
            robot(numbered(3_001), [joint("a" * (20 + i % 100) + str(i), "l0", f"l{i + 1}") for i in range(3_000)]),
        ),
    ),
    # large structures
    "a chain of 20,000 links": _urdf("file-too-large", lambda: chain(20_000)),
    "a chain of 4,000 joints": _urdf("", lambda: chain(4_000)),
    "a chain of 4,001 joints": _urdf("file-too-large", lambda: chain(4_001)),
    "a chain of 666 floating joints": _urdf("", lambda: chain(666, "floating")),
    "a chain of 10,000 fixed links": _urdf("", lambda: chain(10_000, "fixed")),
    "4,000 links on one": _urdf("", lambda: star(4_000)),
    "a cycle of 10,000 links": _urdf(
        "urdf-cycle",
        lambda: robot(numbered(10_000), [joint(f"j{i}", f"l{i}", f"l{(i + 1) % 10_000}") for i in range(10_000)]),
    ),
    "29,000 joints": _urdf("file-too-large", lambda: star(29_000)),
    "80,000 joints": _urdf("file-too-large", lambda: star(80_000)),
    "10,000 mimics of unknown joints": _urdf(
        "urdf-mimic-unknown",
        lambda: robot(
            numbered(10_001),
            [joint(f"j{i}", "l0", f"l{i + 1}", content=f'<mimic joint="x{i}"/>') for i in range(10_000)],
        ),
    ),
    "16,000,000 lines and an unknown key": _yaml("unknown-key", f"{VERSION2}{chr(10) * 16_000_000}key: 1"),
    "an unknown key in a line of 16,000,000 characters": _yaml(
        "unknown-key", f"{VERSION2}x-a: {'b' * 16_000_000}\nkey: 1"
    ),
    "a chain of 12,000 mimics": _urdf("file-too-large", lambda: mimics(12_000, "")),
    "a chain of 2,000 mimics": _urdf("", lambda: mimics(2_000, "")),
    "a cycle of 10,000 mimics": _urdf("urdf-mimic-cycle", lambda: mimics(10_000, '<mimic joint="j0"/>')),
    "a chain of 6,000 joints, all split in two": _files(
        "file-too-large",
        lambda: (
            f"joint_name: [{', '.join(numbered(6_000, 'j'))}]\njoint_type: [{', '.join(['UJOINT_XY'] * 6_000)}]\n",
            chain(6_000),
        ),
    ),
    "6,000 closures that share 400 joints": _files("", lambda: shared(6_000, 400)),
    "6,666 closures that share 4,000 joints": _files("", lambda: shared(6_666, 4_000)),
    "6,667 closures": _files("file-too-large", lambda: shared(6_667, 400)),
    "500 closures that share 500 joints": _files("", lambda: shared(500, 500)),
    "300 four-bars side by side": _files("", lambda: four_bars(300, in_series=False)),
    "300 four-bars in series": _files("", lambda: four_bars(300, in_series=True)),
    "300 four-bars that cannot close": _files("", lambda: four_bars(300, in_series=True, ground=4.0)),
    "6,000 frames": _yaml("", many("frames", "{{name: f{}, link: l0}}", 6_000)),
    "4,000 closures on one joint that cannot close": _files(
        "",
        lambda: (
            VERSION2
            + "frames:\n"
            + "".join(f"- {{name: f{i}, link: l0, xyz: [{i}, 1, 0]}}\n" for i in range(4_000))
            + "closures:\n"
            + "".join(f"- {{name: c{i}, type: 3d, frames: [f{i}, l1]}}\n" for i in range(4_000)),
            star(1),
        ),
    ),
    "6,000 meshes that are not there": _urdf(
        "",
        lambda: (
            '<robot name="r"><link name="a">'
            + "".join(
                f'<visual><geometry><mesh filename="package://p/m{i}.stl"/></geometry></visual>' for i in range(6_000)
            )
            + "</link></robot>"
        ),
    ),
}


def face(name: str) -> dict[str, object]:
    """Check, report and load one; the diagnostics, and the length of the report."""
    import eurdf
    from eurdf.diagnostics.report import reports_to_json
    from eurdf.diagnostics.text import report_lines

    with tempfile.TemporaryDirectory() as folder:
        path = HOSTILE[name].write(Path(folder))
        try:
            report = eurdf.check(path)
        except eurdf.errors.RobotNotFound as error:
            return {"codes": [type(error).__name__], "loaded": "", "told": len(str(error))}
        told = "".join(text for line in report_lines(report) for text, _ in line) + json.dumps(
            reports_to_json([report])
        )
        try:
            loaded = repr(eurdf.load(path, geometry=False))
        except eurdf.InvalidRobot as error:
            loaded, told = "", told + str(error)
        codes = sorted({found.code for found in report.errors if found.phase not in ("inertia", "closure")})
        return {"codes": codes, "loaded": loaded, "told": len(told)}


def main(names: Sequence[str]) -> None:
    """The command described at the top."""
    # Loaded beforehand, so that what is measured is what the files take.
    import eurdf.kinematics.assembly
    import eurdf.pinocchio.robot  # noqa: F401

    base = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for name in names:
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            resource.setrlimit(resource.RLIMIT_AS, ((base << 10) + (MEMORY + 2048 << 20),) * 2)
            signal.setitimer(signal.ITIMER_PROF, CPU_SECONDS)
            try:
                answer = face(name)
            except BaseException as error:  # any exception is reported
                answer = {"raised": f"{type(error).__name__}: {str(error)[:300]}"}
            os.write(writing, json.dumps(answer).encode())
            os._exit(0)
        os.close(writing)
        with os.fdopen(reading, "rb") as stream:
            answer = stream.read()
        _, status, usage = os.wait4(child, 0)
        line = {
            "name": name,
            "status": os.waitstatus_to_exitcode(status),
            "seconds": round(usage.ru_utime + usage.ru_stime, 2),
            "memory": (usage.ru_maxrss - base) >> 10,
            **json.loads(answer or b"{}"),
        }
        print(json.dumps(line), flush=True)  # noqa: T201


if __name__ == "__main__":
    main(sys.argv[1:] or list(HOSTILE))
