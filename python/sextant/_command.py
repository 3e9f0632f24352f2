"""The command ``sextant``: the program itself, in this package."""

from __future__ import annotations

import os
import shutil
import sys

from . import _native


def main() -> int:
    """Run the command line of this process, and return its exit code."""
    script = shutil.which(sys.argv[0]) or os.path.abspath(sys.argv[0])
    return _native.main(script, sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
