"""``python -m eurdf`` is the command ``eurdf``."""

import sys

from eurdf.commands.start import start

if __name__ == "__main__":
    sys.exit(start())
