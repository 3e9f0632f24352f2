"""``python -m sextant`` is the command ``sextant``."""

import sys

from ._command import main

sys.exit(main())
