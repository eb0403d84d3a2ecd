"""What functions return. Results of batches, transmissions, conversion and viewing are beside their functions."""

from eurdf.public_names import public_names as _public_names

__getattr__, __dir__ = _public_names(__name__, __file__)
