"""A robot to look at and to move, with its loops closed: in a browser, and as a picture."""

from eurdf.public_names import public_names as _public_names

__getattr__, __dir__ = _public_names(__name__, __file__)
