"""Programs of stations that command their radio, as straight code."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass

from ._application import Application
from ._native import Port, RadioEvent, TimerKey

#: The timer of a program that waits.
_WAITING = 65535


@dataclass(frozen=True)
class Wait:
    """What a program waits for: see :func:`wait`."""

    kinds: tuple[str, ...]
    seconds: float | None


def wait(*kinds: str, seconds: float | None = None) -> Wait:
    """Wait for the next event of the radio of one of these kinds, for some seconds, or for what comes first.

    ``yield wait(..)`` is the event, or ``None`` after the time. Events that nobody waits for are passed over.
    """
    if not kinds and seconds is None:
        raise ValueError("nothing to wait for; needed: kinds of events, or seconds")
    return Wait(kinds, seconds)


class RadioProgram(Application):
    """A program of a station that commands its radio, as straight code: ``run`` yields what it waits for.

    It needs a network with ``mac.program``. Each station needs an object of its own.

    Examples
    --------
    A node sends a reading each second, whatever is on air.

    >>> import sextant
    >>> class Reading(sextant.RadioProgram):
    ...     def run(self, port):
    ...         radio = port.radio()
    ...         while True:
    ...             yield sextant.wait(seconds=1.0)
    ...             packet = radio.offer(4)
    ...             radio.transmit(b"23 C", packet=packet)
    ...             yield sextant.wait("sent")
    ...             radio.done(packet)
    """

    _running: Generator[Wait, RadioEvent | None, None] | None = None
    _wait: Wait | None = None
    _timeout: TimerKey | None = None

    def run(self, port: Port) -> Generator[Wait, RadioEvent | None, None]:
        """The program: a generator that yields what :func:`wait` makes."""
        raise NotImplementedError("write `run` as a generator that yields `sextant.wait(..)`")

    def started(self, port: Port) -> None:
        self._running = self.run(port)
        self._go_on(None, port)

    def timer(self, timer: int, port: Port) -> None:
        if timer == _WAITING:
            self._timeout = None
            self._go_on(None, port)

    def radio(self, event: RadioEvent, port: Port) -> None:
        if self._wait is not None and event.kind in self._wait.kinds:
            if self._timeout is not None:
                port.cancel(self._timeout)
                self._timeout = None
            self._go_on(event, port)

    def _go_on(self, event: RadioEvent | None, port: Port) -> None:
        self._wait = None
        if self._running is None:
            return
        try:
            self._wait = self._running.send(event)
        except StopIteration:
            self._running = None
            return
        if self._wait.seconds is not None:
            self._timeout = port.after(self._wait.seconds, _WAITING)
