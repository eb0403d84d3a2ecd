"""Writes the files of a certificate: all of them, or none."""

from __future__ import annotations

import os
from pathlib import Path

from eurdf_conformance.certificate.badge import badge
from eurdf_conformance.certificate.certificate import FILE, Certificate
from eurdf_conformance.certificate.report import report
from eurdf_conformance.write_together import write_together

#: The files that show a certificate to people.
_SHOWING = ("report.html", "badge.svg")


class NoRoom(Exception):  # noqa: N818 - shown to the user as it is
    """No certificate can be written there; the text gives the reason."""


def make_room(folder: Path, *, force: bool = False) -> None:
    """Make the folder of a certificate, before the run that it is to be of.

    An earlier certificate there will be replaced, what is none only by force.

    Raises:
        NoRoom: It cannot be.
    """
    if folder.exists() and not folder.is_dir():
        raise NoRoom(f"'{folder}' is a file; a certificate is written into a folder")
    there = [folder / name for name in _SHOWING if (folder / name).exists()]
    if there and not force and not (folder / FILE).is_file():
        raise NoRoom(f"'{there[0]}' exists, but no certificate is beside it")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise NoRoom(f"cannot make the folder '{folder}': {error.strerror or error}") from error
    if not os.access(folder, os.W_OK):
        raise NoRoom(f"cannot write into the folder '{folder}'")


def write_certificate(folder: Path, certificate: Certificate) -> None:
    """Write ``certificate.json``, ``report.html`` and ``badge.svg`` into a folder, which is made where it is not there.

    Raises:
        OSError: It cannot be written; what was there before is still there.
    """
    # The certificate last: where it is, the others are.
    files = {**certificate_files(certificate), FILE: certificate.to_text()}
    folder.mkdir(parents=True, exist_ok=True)
    write_together({folder / name: text.encode() for name, text in files.items()})


def certificate_files(certificate: Certificate) -> dict[str, str]:
    """The files that show a certificate to people, by name."""
    return dict(zip(_SHOWING, (report(certificate), badge(certificate)), strict=True))
