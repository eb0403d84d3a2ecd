"""A module that cannot be imported, for one that it imports."""

import no_such_package  # noqa: F401
