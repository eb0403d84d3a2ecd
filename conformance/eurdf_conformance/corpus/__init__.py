"""The cases, each with one error or none, described in ``cases/<topic>/<name>.yaml``."""
