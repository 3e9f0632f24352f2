"""Errors, signals, threads and processes."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import textwrap
import threading
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import SCENARIOS

import sextant


def test_an_error_of_a_scenario_names_key_value_and_place(tmp_path: Path) -> None:
    text = (SCENARIOS / "smoke.toml").read_text().replace("seed = ", "sead = ")
    path = tmp_path / "wrong.toml"
    path.write_text(text)
    with pytest.raises(sextant.ScenarioError) as caught:
        sextant.Scenario(path)
    error = caught.value
    assert (error.key, error.found) == ("sead", "sead")
    assert error.allowed and "`seed`" in error.allowed
    assert error.file == str(path)
    line, column = error.line, error.column
    assert line is not None and text.splitlines()[line - 1].startswith("sead") and column == 1


def test_an_error_has_all_errors() -> None:
    with pytest.raises(sextant.ScenarioError) as caught:
        sextant.Scenario.template("survey", **{"robots.0.speed_m_per_s": -1.0, "channel.max_range_m": -2.0})
    keys = {error.key for error in caught.value.errors}
    assert keys == {"robots[0].speed_m_per_s", "channel.max_range_m"}
    found = {error.found for error in caught.value.errors}
    assert found == {"-1", "-2"}


@pytest.mark.parametrize("value", [object(), None, {1, 2}, b"octets"])
def test_a_value_that_is_no_setting_is_refused(value: object) -> None:
    with pytest.raises((TypeError, ValueError, sextant.ScenarioError)):
        sextant.Scenario.template("survey", **{"channel.max_range_m": value})


def test_nothing_that_is_not_ours_is_replaced(survey: sextant.Scenario, tmp_path: Path) -> None:
    path = tmp_path / "mine.txt"
    path.write_text("mine")
    with pytest.raises(OSError, match="mine.txt"):
        survey.run(record=path)
    assert path.read_text() == "mine"


LONG = """
import sys, sextant
scenario = sextant.Scenario(sys.argv[1], **{"duration_s": 1.0e6})
def told(work, done, steps):
    print(work, flush=True)
try:
    scenario.run(progress=told, record=sys.argv[2])
except KeyboardInterrupt:
    print("stopped", flush=True)
"""


@pytest.mark.skipif(os.name != "posix", reason="signals are those of POSIX")
def test_ctrl_c_ends_a_run_and_keeps_the_recording(tmp_path: Path) -> None:
    record = tmp_path / "run.mcap"
    scenario = SCENARIOS / "mac" / "poisson-star.toml"
    process = subprocess.Popen(
        [sys.executable, "-c", LONG, str(scenario), str(record)], stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline().strip()
    process.send_signal(signal.SIGINT)
    rest, _ = process.communicate(timeout=60)
    assert rest.splitlines()[-1] == "stopped"
    assert process.returncode == 0
    assert record.exists() and not list(tmp_path.glob("*.part"))


def test_an_exception_of_the_progress_ends_the_run(survey: sextant.Scenario) -> None:
    def fails(work: str, done: int, steps: int) -> None:
        raise LookupError("of progress")

    long = sextant.Scenario(SCENARIOS / "mac" / "poisson-star.toml", **{"duration_s": 1.0e6})
    with pytest.raises(LookupError, match="of progress"):
        long.run(progress=fails)


def places(seed: int) -> dict[str, list[object]]:
    """The map of a small survey."""
    made = sextant.Scenario.template("survey", seed=seed).run().maps["ml-tm"].places
    return made.to_dict()  # type: ignore[no-any-return]


def test_two_runs_at_once_are_those_of_one_after_the_other() -> None:
    found: dict[int, dict[str, list[object]]] = {}
    threads = [threading.Thread(target=lambda seed=seed: found.update({seed: places(seed)})) for seed in (1, 2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == {seed: places(seed) for seed in (1, 2)}


@pytest.mark.parametrize("method", [method for method in multiprocessing.get_all_start_methods() if method != "forkserver"])
def test_processes_that_fork_or_spawn_run_too(method: str) -> None:
    expected = places(1)
    with multiprocessing.get_context(method).Pool(2) as pool:
        assert pool.map(places, [1, 1]) == [expected, expected]


def test_the_command_is_that_of_the_program(command: Callable[..., str]) -> None:
    assert command("--version").strip() == f"sextant {sextant.__version__}"
    done = subprocess.run([sys.executable, "-m", "sextant", "run"], capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "Usage" in done.stderr


def test_the_module_is_imported_without_numpy() -> None:
    program = textwrap.dedent(
        """
        import sys
        sys.modules["numpy"] = None
        import sextant
        run = sextant.Scenario.template("survey").run()
        print(len(run.stops.to_list("x_m")), len(run.maps["ml-tm"].places.to_dict()["node"]))
        """
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split()[1] == "36"
