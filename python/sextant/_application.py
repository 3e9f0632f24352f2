"""Programs of nodes, robots and sinks."""

from __future__ import annotations

from ._native import Announcement, Delivery, DriveEnd, Port, RadioEvent, SendReport, Sensed, SweepAnswer


class Application:
    """A program of one station: it reacts to what happens there, and acts through its port.

    Write the methods that you need; the others are never called, and cost nothing. Each station needs an object of its own.
    An exception ends the run with its traceback; what was recorded until then is kept.

    Attributes
    ----------
    has_task : bool
        Whether the simulation goes on until the program calls ``port.finish()``.

    Examples
    --------
    A message floods the network: each node relays the first copy after a random wait.

    >>> import sextant
    >>> class Flooder(sextant.Application):
    ...     def __init__(self, is_origin):
    ...         self.is_origin, self.heard_s = is_origin, None
    ...     def started(self, port):
    ...         if self.is_origin:
    ...             self.heard_s = port.now_s
    ...             port.send(b"fire in room 7")
    ...     def delivered(self, delivery, port):
    ...         if self.heard_s is None:
    ...             self.heard_s = port.now_s
    ...             port.after(port.random.uniform(0.0, 1.0))
    ...     def timer(self, timer, port):
    ...         port.send(b"fire in room 7")
    """

    has_task: bool = False

    def started(self, port: Port) -> None:
        """The simulation begins."""

    def ended(self, port: Port) -> None:
        """The simulation ends. It is too late to send anything."""

    def timer(self, timer: int, port: Port) -> None:
        """A timer is due that ``port.after(seconds, timer)`` set."""

    def delivered(self, delivery: Delivery, port: Port) -> None:
        """A frame for this station was received."""

    def sent(self, report: SendReport, port: Port) -> None:
        """A frame that was given to ``port.send`` has ended."""

    def radio(self, event: RadioEvent, port: Port) -> None:
        """The radio says something that the program commands with ``port.radio()``, in a network with ``mac.program``.

        Without this method, frames that are received are ``delivered``.
        """

    def sensed(self, sensed: Sensed, port: Port) -> None:
        """A sensor of the node says something."""

    def drive_ended(self, end: DriveEnd, port: Port) -> None:
        """A drive of the robot is over."""

    def swept(self, network: int, answers: list[SweepAnswer], port: Port) -> None:
        """The sector sweep is over that ``port.sweep()`` began."""

    def announced(self, announcement: Announcement, port: Port) -> None:
        """A frame was received of a sweep with which another station announces itself."""

    def listened(self, network: int, port: Port) -> None:
        """The time to listen is over that ``port.listen(seconds)`` began."""
