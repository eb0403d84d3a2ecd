"""``eurdf certify``.

`certify` is the entry point, and `run` does what the arguments ask: `suite_run` runs the suite, `replay` compares a
second run with a certificate, `output` shows the result.
"""
