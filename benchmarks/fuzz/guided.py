"""Coverage-guided fuzzing: atheris chooses the bytes of a description or a URDF by the code that they reach.

It sees the Python code of reading, the format and linking. It runs in a process of its own, where a crash or a hang
ends it and leaves the input.
"""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from benchmarks.fuzz.case import Case
from benchmarks.fuzz.robots import seeds, try_robot

#: Time after which an input is taken to hang, s.
_TIMEOUT = 60


def run(minutes: float, findings: Path) -> int:
    """Let atheris run in a process of its own.

    Returns:
        0 if it found nothing, 1 if it did, 2 if it is not installed.
    """
    if importlib.util.find_spec("atheris") is None:
        print("atheris is not installed: pip install '.[fuzz]'", file=sys.stderr)
        return 2
    findings.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        corpus = Path(folder, "corpus")
        corpus.mkdir()
        for number, seed in enumerate(seeds()):
            for kind, content in ((b"y", seed.description), (b"u", seed.urdf)):
                (corpus / f"{number}{kind.decode()}").write_bytes(kind + (content or b""))
        program = [sys.executable, "-m", "benchmarks.fuzz.guided", f"-max_total_time={minutes * 60:.0f}"]
        bounds = [f"-timeout={_TIMEOUT}", "-rss_limit_mb=6000", "-print_final_stats=1", "-max_len=60000"]
        done = subprocess.run(
            [*program, *bounds, f"-artifact_prefix={folder}/", str(corpus)], capture_output=True, check=False
        )
        log = done.stderr.decode(errors="replace")
        print("\n".join(log.splitlines()[-12:]))
        found = [path for path in Path(folder).iterdir() if path.is_file()]
        for path in found:
            case_of(path.read_bytes()).write(findings / f"guided-{path.name}")
            print(f"kept: {findings / f'guided-{path.name}'}")
    return int(bool(found or done.returncode))


def case_of(data: bytes) -> Case:
    """The case that bytes are: a description, if the first of them is ``y``, else a URDF; the other file is sound."""
    sound = seeds()[0]
    assert sound.description is not None
    is_description = data[:1] == b"y"
    urdf = sound.urdf if is_description else data[1:]
    description = data[1:] if is_description else sound.description
    files = {"robot.urdf": urdf, "workbench.urdf": urdf, "robot.yaml": description}
    return Case("robot", "guided", files, "robot.yaml")


def main() -> None:
    """Fuzz until atheris ends the process."""
    import atheris

    with atheris.instrument_imports(include=["eurdf"]):
        import eurdf.loading  # noqa: F401 - instrumented
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)

        def once(data: bytes) -> None:
            case = case_of(data)
            for file, content in case.files.items():
                (folder / file).write_bytes(content)
            try_robot(folder / case.path, analyse=False)

        fuzzer: Any = atheris
        fuzzer.Setup(sys.argv, once)
        fuzzer.Fuzz()


if __name__ == "__main__":
    main()
