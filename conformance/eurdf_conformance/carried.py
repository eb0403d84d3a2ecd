"""Files of the repository that are kept outside this package, and that its wheel carries."""

from pathlib import Path

_PACKAGE = Path(__file__).parent


def carried(name: str) -> Path:
    """Where such a file is: in the installed package, or in the checkout.

    Args:
        name: Its path from the root of the repository.
    """
    installed = _PACKAGE / name
    return installed if installed.is_file() else _PACKAGE.parents[1] / name
