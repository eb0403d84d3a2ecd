"""Several files, written all or none: the suite is installed without the reference, which has its own way."""

from __future__ import annotations

import secrets
from collections.abc import Mapping
from pathlib import Path


def write_together(files: Mapping[Path, bytes]) -> None:
    """Write files, all or none: each takes its name only when all are on the disk.

    Raises:
        OSError: One cannot be written; what was there before is still there.
    """
    scratch = {path: path.with_name(f".{path.name}.{secrets.token_hex(8)}.tmp") for path in files}
    try:
        for path, content in files.items():
            if path.is_dir():
                raise IsADirectoryError(21, "it is a folder", str(path))
            scratch[path].write_bytes(content)
        for path in files:
            scratch[path].replace(path)
    finally:
        for path in scratch.values():
            path.unlink(missing_ok=True)
