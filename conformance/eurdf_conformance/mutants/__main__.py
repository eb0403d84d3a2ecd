"""A mutant as a process: ``python -m eurdf_conformance.mutants NAME``.

The way of `protocol.serve` would do for those that read badly, but not for those that speak badly: there the module
that runs is not the one that they break.
"""

from __future__ import annotations

import sys

from eurdf_conformance.mutants import MUTANTS
from eurdf_conformance.protocol import serve


def main(name: str) -> None:
    """Serve a mutant over standard input and output."""
    with MUTANTS[name].deviation():
        serve.main(f"eurdf_conformance.mutants:{name}")


if __name__ == "__main__":
    main(sys.argv[1])
