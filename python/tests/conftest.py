"""What the tests share."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import sextant

REPOSITORY = Path(__file__).resolve().parents[2]
SCENARIOS = REPOSITORY / "scenarios"


@pytest.fixture(scope="session")
def survey() -> sextant.Scenario:
    """A small survey of one robot."""
    return sextant.Scenario.template("survey", seed=3)


@pytest.fixture(scope="session")
def surveyed(survey: sextant.Scenario) -> sextant.Run:
    """The same, run."""
    return survey.run()


@pytest.fixture(scope="session")
def command() -> Callable[..., str]:
    """Runs the command line of the package, and gives what it prints."""

    def run(*words: object) -> str:
        done = subprocess.run(
            [sys.executable, "-m", "sextant", *map(str, words)], capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run
