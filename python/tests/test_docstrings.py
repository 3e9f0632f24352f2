"""What ``help`` and an editor say of what programs and controllers are given."""

import ast
from pathlib import Path

import pytest
import sextant

STUBS = ast.parse((Path(sextant.__file__).parent / "_native.pyi").read_text())


@pytest.mark.parametrize("name", ["Robot", "Port", "Radio"])
def test_each_method_says_the_same_in_help_and_in_an_editor(name):
    (stub,) = [item for item in STUBS.body if isinstance(item, ast.ClassDef) and item.name == name]
    members = [item for item in stub.body if isinstance(item, ast.FunctionDef)]
    assert len(members) > 10
    for member in members:
        in_editor = ast.get_docstring(member)
        in_help = getattr(getattr(sextant, name), member.name).__doc__
        assert in_editor and in_help, f"{name}.{member.name} has no docstring"
        assert in_help.split() == in_editor.split(), f"{name}.{member.name}"
