"""The cases: one error each, or none. ``cases/<topic>/<name>.yaml`` says what one is, and how its files are made."""
