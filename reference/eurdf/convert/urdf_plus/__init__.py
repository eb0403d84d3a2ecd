"""URDF+, of generalized_rbda."""
