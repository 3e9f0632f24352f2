"""Checks that a wheel with the installed module stays small: `python wheel_size.py`."""

import importlib.util
import pathlib
import sys
import zlib

#: The largest size of a wheel (MB).
LARGEST_MB = 16.5

spec = importlib.util.find_spec("sextant._native")
if spec is None or spec.origin is None:
    sys.exit("sextant is not installed; install it with: pip install ./python")
# A wheel is compressed like this.
size_mb = len(zlib.compress(pathlib.Path(spec.origin).read_bytes(), 6)) / 1e6
print(f"the module takes {size_mb:.1f} MB of a wheel; allowed: {LARGEST_MB:.1f} MB")
sys.exit(size_mb > LARGEST_MB)
