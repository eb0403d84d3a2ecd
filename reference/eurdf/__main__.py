"""``python -m eurdf`` is the command ``eurdf``."""

import sys

from eurdf.commands.main import main

if __name__ == "__main__":
    sys.exit(main())
