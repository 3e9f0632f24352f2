"""The examples in the documentation of the package run, and its types are checked."""

from __future__ import annotations

import doctest
import importlib
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest

import sextant

PYTHON = Path(__file__).resolve().parents[1]
MODULES = ["sextant"] + [
    f"sextant.{module.name}"
    for module in pkgutil.iter_modules(sextant.__path__)
    if module.name not in ("__main__", "_native")
]


@pytest.mark.parametrize("name", MODULES)
def test_the_examples_run(name: str) -> None:
    done = doctest.testmod(importlib.import_module(name), optionflags=doctest.ELLIPSIS | doctest.IGNORE_EXCEPTION_DETAIL)
    assert done.failed == 0


def test_some_modules_have_examples() -> None:
    finder = doctest.DocTestFinder(exclude_empty=True)
    found = [test for name in MODULES for test in finder.find(importlib.import_module(name)) if test.examples]
    assert len(found) >= 4


def test_the_types_are_strict() -> None:
    pytest.importorskip("mypy")
    if not (PYTHON / "sextant" / "_native.pyi").is_file():
        pytest.skip("the stub of the native module is not here")
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "-p", "sextant"],
        cwd=PYTHON,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
