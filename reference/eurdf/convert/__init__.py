"""Robots in the formats of others: each format states what it loses."""

from eurdf.public_names import public_names as _public_names

__getattr__, __dir__ = _public_names(__name__, __file__)
