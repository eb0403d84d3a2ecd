"""Robots in the formats of others as mechanisms: each import says what it lost."""
