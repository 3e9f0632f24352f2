"""Progress of long work."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

Progress = Callable[[str, int, int], object]


class _Line:
    """Calls the user's function, or writes one line to standard error at most ten times a second."""

    def __init__(self, told: Progress | None) -> None:
        self._told = told
        self._next = 0.0
        self._width = 0

    def __call__(self, work: str, done: int, steps: int) -> None:
        if self._told is not None:
            self._told(work, done, steps)
            return
        now = time.monotonic()
        if now < self._next:
            return
        self._next = now + 0.1
        share = 100 * done // steps if steps else 0
        line = f"{work}: {done} of {steps} ({share} %)"
        self._width = max(self._width, len(line))
        sys.stderr.write("\r" + line.ljust(self._width))
        sys.stderr.flush()

    def close(self) -> None:
        """Clear the line."""
        if self._width:
            sys.stderr.write("\r" + " " * self._width + "\r")
            sys.stderr.flush()


@contextmanager
def shown(progress: bool | Progress) -> Iterator[_Line | None]:
    """What is told of the progress, if anything is; the line is cleared at the end."""
    if progress is False:
        yield None
        return
    line = _Line(None if progress is True else progress)
    try:
        yield line
    finally:
        line.close()
