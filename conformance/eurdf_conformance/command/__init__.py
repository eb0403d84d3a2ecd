"""``eurdf certify``, which ``eurdf`` finds through an entry point: `certify` runs it, `output` shows its result."""
