"""Scenarios and runs."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from . import _native as inner
from ._application import Application
from ._controller import Controller
from ._map import Map
from ._native import Table
from ._progress import Progress, shown

Path = str | os.PathLike[str]


class Scenario:
    """A simulation: the world, the radios, who moves and who sends, and the maps to make.

    It is checked when it is made, and does not change: :meth:`replace` gives another one.

    Parameters
    ----------
    source : path, dict, or Scenario
        A TOML file, or its content as a dict. Files that a dict names are relative to the working folder.
    **settings
        Settings that override those of the source, by their dotted keys: ``**{"channel.max_range_m": 8.0}``, and ``seed``.

    Raises
    ------
    ScenarioError
        With the key, what was found and what is allowed; `errors` has all errors.

    Examples
    --------
    >>> import sextant
    >>> scenario = sextant.Scenario.template("survey", seed=3)
    >>> scenario.seed
    3
    >>> scenario.replace(**{"robots.0.speed_m_per_s": -1.0})
    Traceback (most recent call last):
    ...
    sextant.ScenarioError: ...
    """

    __slots__ = ("_native",)

    _native: inner.Scenario

    def __init__(self, source: Path | Mapping[str, Any] | Scenario, /, **settings: Any) -> None:
        if isinstance(source, Scenario):
            self._native = source._native.with_settings(settings)
        elif isinstance(source, Mapping):
            self._native = inner.Scenario.of_mapping(source, settings)
        elif isinstance(source, (str, os.PathLike)):
            self._native = inner.Scenario.load(os.fspath(source), settings)
        else:
            kind = type(source).__name__
            raise TypeError(f"a scenario is made of a path, a dict or a Scenario, not of {kind}")

    @classmethod
    def _of(cls, native: inner.Scenario) -> Scenario:
        made = cls.__new__(cls)
        made._native = native
        return made

    @classmethod
    def from_text(cls, text: str, /, **settings: Any) -> Scenario:
        """Make a scenario of the text of a TOML file."""
        return cls._of(inner.Scenario.parse(text, settings))

    @classmethod
    def template(cls, name: str = "survey", /, **settings: Any) -> Scenario:
        """Make one of the scenarios to begin with, which ``sextant init`` writes.

        Parameters
        ----------
        name : str
            ``survey``, ``building``, ``ranges``, ``mac``, ``mmwave``, ``distributed``, ``search`` or ``seek``.
        **settings
            As for :class:`Scenario`.
        """
        return cls._of(inner.Scenario.template(name, settings))

    @property
    def name(self) -> str:
        """Name of the scenario."""
        return self._native.name

    @property
    def seed(self) -> int:
        """Seed of all random numbers."""
        return self._native.seed

    @property
    def text(self) -> str:
        """The scenario as TOML, with all settings in it; the seed is not part of it."""
        return self._native.text

    @property
    def robots(self) -> list[str]:
        """Names of the robots."""
        return self._native.robots

    @property
    def warnings(self) -> list[str]:
        """What is likely a mistake, although it can be simulated."""
        return self._native.warnings

    def link(self, a: str, b: str, *, network: str | None = None) -> dict[str, Any]:
        """Explain the link between two stations, item by item, as ``sextant explain-link`` does.

        Parameters
        ----------
        a, b : str
            Names of nodes, robots (at their start) or sinks, or places ``"x,y"`` or ``"x,y,z"`` (m).
        network : str, optional
            The network; the default is the first one that both are in.

        Returns
        -------
        dict
            ``distance_m``, ``path`` (losses in dB by distance, obstacles and reflections), ``shadowing``, ``directions`` (power and
            reception each way), ``rays`` where there are any.

        Examples
        --------
        >>> import sextant
        >>> link = sextant.Scenario.template("mac").link("n0", "sink")
        >>> sorted(link)[:3]
        ['directions', 'distance_m', 'ends']
        """
        return self._native.link(a, b, network)

    def graph(self, *, network: str | None = None, least: float = 0.01) -> Table:
        """Give the graph of a network: a row for each link over which frames are received.

        Parameters
        ----------
        network : str, optional
            The network; the default is the first one.
        least : float
            Links with a smaller probability are left out.

        Returns
        -------
        Table
            ``from``, ``to`` (nodes, sinks, robots at their start), ``distance_m``, ``received_dbm``, and ``probability`` that a frame is
            received if nobody else sends. networkx takes it:
            ``networkx.from_pandas_edgelist(graph.to_pandas(), "from", "to", edge_attr=True, create_using=networkx.DiGraph)``.
        """
        return self._native.graph(network, least)

    def replace(self, **settings: Any) -> Scenario:
        """Make the same scenario with other settings."""
        return Scenario(self, **settings)

    def run(
        self,
        *,
        seed: int | None = None,
        record: Path | None = None,
        progress: bool | Progress = False,
        controller: Controller | None = None,
        controllers: Mapping[str, Controller] | None = None,
        applications: Mapping[str, Application] | Callable[[str], Application | None] | None = None,
        threads: int | None = None,
        force: bool = False,
    ) -> Run:
        """Simulate the scenario, make its maps, and run its applications.

        The interpreter is free meanwhile: other threads go on. The same scenario and seed give the same results at any number of
        threads.

        Parameters
        ----------
        seed : int, optional
            Another seed than that of the scenario.
        record : path, optional
            Record the run to this MCAP file. An earlier recording is replaced; another file only with `force`.
        progress : bool or callable
            Show the progress on standard error, or call this with the name of the work, the steps done and all steps.
        controller : Controller, optional
            Drives the only robot that surveys.
        controllers : dict of str to Controller, optional
            Drive the robots with these names.
        applications : dict of str to Application, or callable, optional
            Programs of the nodes, robots or sinks with these names; a callable gives the program of each node, or None.
        threads : int, optional
            The number of threads; the default is one for each core.
        force : bool
            Replace a file that is not an earlier recording.

        Returns
        -------
        Run

        Raises
        ------
        RunError
            The run failed.
        KeyboardInterrupt
            Ctrl-C; the recording is finished first.
        Exception
            Whatever a program of yours raised; the recording is finished first.

        Examples
        --------
        >>> import sextant
        >>> run = sextant.Scenario.template("survey").run(seed=1)
        >>> sorted(run.summary)[:3]
        ['gathering', 'maps', 'scenario']
        """
        scenario = self if seed is None else self.replace(seed=seed)
        native = scenario._native
        if controller is not None:
            if controllers is not None:
                raise TypeError("give either `controller` or `controllers`")
            surveyors = native.surveyors
            if len(surveyors) != 1:
                raise ValueError(f"`controller` is for one robot that surveys; robots that do: {surveyors}; use `controllers`")
            controllers = {surveyors[0]: controller}
        if callable(applications):
            made = {name: applications(name) for name in native.node_names}
            applications = {name: program for name, program in made.items() if program is not None}
        with shown(progress) as told:
            run = native.run(
                None if record is None else os.fspath(record),
                told,
                None if controllers is None else dict(controllers),
                None if applications is None else dict(applications),
                threads,
                force,
            )
        return Run(run)

    def __repr__(self) -> str:
        return repr(self._native)

    def _repr_html_(self) -> str:
        return f"<pre>{_escaped(repr(self))}</pre>"

    def __reduce__(self) -> tuple[Any, ...]:
        return (_of_text, (self.text, self.seed))


def _of_text(text: str, seed: int) -> Scenario:
    return Scenario.from_text(text, seed=seed)


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


class _KeptRun:
    """What pickle keeps of a run: the results, without what the library has of them."""

    def __init__(self, state: dict[str, Any]) -> None:
        self.scenario = Scenario.from_text(state["text"], seed=state["seed"])._native
        self.summary = state["summary"]
        self.record = state["record"]
        self.interrupted = state["interrupted"]
        self.heard_text = state["heard_text"]
        self.maps = [(name, made._native) for name, made in state["maps"].items()]
        self._tables = state["tables"]

    def _table(self, name: str) -> Table:
        if self._tables is None:
            raise ValueError("the scenario has no survey")
        table: Table = self._tables[name]
        return table

    @property
    def stops(self) -> Table:
        return self._table("stops")

    @property
    def receptions(self) -> Table:
        return self._table("receptions")

    @property
    def nodes(self) -> Table:
        return self._table("nodes")

    def tables(self) -> list[tuple[str, Table]]:
        if self.record is None:
            raise ValueError("the run was not recorded; run with `record`")
        return inner.read(self.record, None, {}).tables()


def _kept_run(state: dict[str, Any]) -> Run:
    return Run(_KeptRun(state))


class Run:
    """A run that is over: what was simulated, heard and mapped.

    Attributes are read from it; it is made by :meth:`Scenario.run`. Pickle keeps all of them, but for the figures of its maps; the tables
    of a recording are read from its file.
    """

    __slots__ = ("_maps", "_native", "_summary")

    def __init__(self, native: inner.Run | _KeptRun) -> None:
        self._native = native
        self._summary: dict[str, Any] | None = None
        self._maps: dict[str, Map] | None = None

    @property
    def scenario(self) -> Scenario:
        """The scenario that was run."""
        return Scenario._of(self._native.scenario)

    @property
    def summary(self) -> dict[str, Any]:
        """All results, as ``sextant run --summary`` writes them: see the page on metrics in the guide."""
        if self._summary is None:
            self._summary = self._native.summary
        return self._summary

    @property
    def stops(self) -> Table:
        """Where the robots listened: ``stop``, ``t_s``, ``x_m``, ``y_m``, ``z_m``, and ``robot`` of several."""
        return self._native.stops

    @property
    def receptions(self) -> Table:
        """What was heard of each node at each stop: ``node``, ``stop``, ``received``, ``sent``, and what was measured."""
        return self._native.receptions

    @property
    def nodes(self) -> Table:
        """The true places of the nodes: ``node``, ``x_m``, ``y_m``, ``z_m``."""
        return self._native.nodes

    @property
    def maps(self) -> dict[str, Map]:
        """The maps of the run by their names, in the order of the scenario."""
        if self._maps is None:
            self._maps = {name: Map(native) for name, native in self._native.maps}
        return dict(self._maps)

    @property
    def tables(self) -> dict[str, Table]:
        """All tables of the recording by name, as ``sextant export`` writes them.

        Raises
        ------
        ValueError
            The run was not recorded.
        """
        return dict(self._native.tables())

    @property
    def packets(self) -> Table:
        """The packets one by one, where they were traced: ``recording.packets = true``, and ``record`` was given."""
        tables = self.tables
        if "mac_packets" not in tables:
            raise ValueError(
                'the packets were not traced; run with `**{"recording.packets": True}` and `record="run.mcap"`'
            )
        return tables["mac_packets"]

    @property
    def record(self) -> str | None:
        """The file of the recording, if there is one."""
        record = self._native.record
        return None if record is None else os.fspath(record)

    def __repr__(self) -> str:
        name = self.scenario.name
        maps = self._native.maps
        made = f"{len(maps)} map" + ("" if len(maps) == 1 else "s")
        stopped = ", interrupted" if self._native.interrupted else ""
        return f"sextant.Run({name!r}: {self._native.heard_text}, {made}{stopped})"

    def _repr_html_(self) -> str:
        parts = [f"<p>{_escaped(repr(self))}</p>"]
        for made in self.maps.values():
            parts.append(made._repr_html_())
        return "".join(parts)

    def _repr_svg_(self) -> str | None:
        first = next(iter(self.maps.values()), None)
        return None if first is None else first._repr_svg_()

    def __iter__(self) -> Iterator[Map]:
        return iter(self.maps.values())

    def __reduce__(self) -> tuple[Any, ...]:
        native = self._native
        try:
            tables = {"stops": native.stops, "receptions": native.receptions, "nodes": native.nodes}
        except ValueError:
            tables = None
        state = {
            "text": self.scenario.text,
            "seed": self.scenario.seed,
            "summary": self.summary,
            "record": None if native.record is None else os.path.abspath(native.record),
            "interrupted": native.interrupted,
            "heard_text": native.heard_text,
            "maps": self.maps,
            "tables": tables,
        }
        return (_kept_run, (state,))
