"""``eurdf view``."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from eurdf.commands.main import main

MISSING = "websockets is not installed: pip install -e '.[view]'"


@pytest.mark.slow
def test_command_ends_with_an_interrupt() -> None:
    pytest.importorskip("websockets", reason=MISSING)
    command = [sys.executable, "-m", "eurdf", "view", "four_bar", "--no-browser", "--port", "0"]
    with subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # Where the tests run as a background job of a script, SIGINT is ignored, also by what they start.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as running:
        try:
            assert running.stdout is not None
            assert running.stdout.readline().startswith("four_bar: http://127.0.0.1:")
            running.send_signal(signal.SIGINT)
            assert running.communicate(timeout=30) == ("", "")
        finally:
            running.kill()
    assert running.returncode == 0


def test_trajectory_with_an_error_ends_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("websockets", reason=MISSING)
    file = tmp_path / "walk.csv"
    file.write_text("time,motor\n0,0\n")
    assert main(["view", "four_bar", "--no-browser", "--port", "0", "--trajectory", os.fspath(file)]) == 2
    assert f"'{file}': line 1: there is no joint 'motor'" in capsys.readouterr().err


@pytest.mark.parametrize("port", ["-1", "65536", "a"])
def test_command_refuses_wrong_port(port: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as exit_:
        main(["view", "four_bar", f"--port={port}"])
    assert exit_.value.code == 2
    assert "is not a port" in capsys.readouterr().err
