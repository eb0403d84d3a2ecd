"""``eurdf certify``: `certify` is the entry point, `run` does what the arguments ask, `output` shows the result."""
