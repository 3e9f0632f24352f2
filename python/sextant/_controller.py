"""Controllers of robots."""

from __future__ import annotations

from abc import ABC, abstractmethod

from ._native import Command, Robot


class Controller(ABC):
    """Drives a robot: asked for a command at the start, and whenever the last one is over.

    It knows what a real robot knows: its odometry, its range sensors and what it heard. Keep what you need in `self`. Use
    ``robot.random`` for random numbers: it depends on the seed of the run and on the robot, so that a run can be repeated.

    An exception ends the run with its traceback; what was recorded until then is kept.

    Examples
    --------
    A robot that drives a square and listens at its corners.

    >>> import sextant
    >>> class Square(sextant.Controller):
    ...     def __init__(self):
    ...         self.corners = [(4.0, 1.0), (4.0, 4.0), (1.0, 4.0), (1.0, 1.0)]
    ...     def next(self, robot):
    ...         if robot.outcome in ("arrived", "blocked"):
    ...             return robot.listen()
    ...         if not self.corners:
    ...             return robot.finish()
    ...         return robot.drive_to(*self.corners.pop(0))
    >>> run = sextant.Scenario.template("survey").run(controller=Square())
    >>> len(run.stops)
    4
    """

    @abstractmethod
    def next(self, robot: Robot) -> Command:
        """Decide what the robot does next.

        Parameters
        ----------
        robot : Robot
            What the robot knows: ``outcome`` of the last command (``"started"``, ``"arrived"``, ``"blocked"`` or
            ``"listened"``), ``heard`` at the last stop, ``pose`` by odometry, ``contact`` with an obstacle, ``time_s``,
            ``node_count``; ``clearance(direction_rad)`` and ``ranges()`` of its range sensors.

        Returns
        -------
        Command
            What ``robot.drive_to(x_m, y_m)``, ``robot.drive_arc(length_m, turn_rad)``, ``robot.listen()``,
            ``robot.sweep()`` or ``robot.finish()`` returns.
        """
