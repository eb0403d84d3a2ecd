"""The conformance corpus of Extended URDF. README.md in FOLDER explains its files."""

from pathlib import Path

#: The folder with `index.json`, the cases and the schemas.
FOLDER = Path(__file__).parent
