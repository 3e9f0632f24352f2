"""Values that are odd or hostile: a clear exception or the right result, and never the end of the interpreter."""

from __future__ import annotations

import subprocess
import sys
import textwrap

import pytest

PREAMBLE = """
import sextant
def refused(call, *kinds):
    try:
        made = call()
    except Exception as error:
        assert not kinds or isinstance(error, kinds), (type(error), error)
        return str(error)
    raise AssertionError(f"{made!r} was taken")
"""


def alone(program: str) -> None:
    """Runs a program in an interpreter of its own, so that one that dies is a failed test."""
    text = PREAMBLE + textwrap.dedent(program)
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, f"exit code {done.returncode}\n{done.stderr[-3000:]}"


NESTED = {
    "a dict in itself": "value = {}; value['a'] = value",
    "a list in itself": "value = []; value.append(value)",
    "a list and a dict in each other": "value = []; value.append({'a': value})",
    "20 000 lists": "value = []\nfor _ in range(20_000): value = [value]",
    "20 000 dicts": "value = {}\nfor _ in range(20_000): value = {'a': value}",
    "20 000 tuples": "value = ()\nfor _ in range(20_000): value = (value,)",
    "what is its own list": "class Own:\n    def tolist(self): return self\nvalue = Own()",
    "what is its own path": "class Own:\n    def __fspath__(self): return self\nvalue = Own()",
    "a sequence in itself": (
        "import collections.abc\n"
        "class Own(collections.abc.Sequence):\n"
        "    def __len__(self): return 1\n"
        "    def __getitem__(self, at):\n"
        "        if at: raise IndexError\n"
        "        return self\n"
        "value = Own()"
    ),
}

TAKERS = {
    "a scenario": "sextant.Scenario({'a': value})",
    "a setting": "sextant.Scenario.template('survey', **{'a.b': value})",
    "a replaced setting": "sextant.Scenario.template('survey').replace(a=value)",
    "an axis": "sextant.sweep('absent.toml', {'a': [value]})",
    "a setting of a map": "sextant.Log({'stop': [1], 'x_m': [0.0], 'y_m': [0.0]}, {'node': ['a'], 'stop': [1], 'received': [1]}).map(settings={'a': value})",
}


@pytest.mark.parametrize("what", NESTED)
def test_what_is_nested_without_an_end_is_refused(what: str) -> None:
    calls = "\n".join(f"assert 'deep' in refused(lambda: {call}, ValueError), {taker!r}" for taker, call in TAKERS.items())
    alone(NESTED[what] + "\n" + calls)


def test_a_mapping_in_itself_is_refused() -> None:
    alone("value = {}; value['a'] = value; assert 'deep' in refused(lambda: sextant.Scenario(value), ValueError)")


def test_64_levels_are_read_and_65_are_not() -> None:
    alone(
        """
        def lists(levels):
            value = []
            for _ in range(levels - 1):
                value = [value]
            return value
        # The key is unknown, which is an error of the scenario: the value was read.
        refused(lambda: sextant.Scenario.template("survey", odd=lists(64)), sextant.ScenarioError)
        refused(lambda: sextant.Scenario.template("survey", odd=lists(65)), ValueError)
        """
    )


def test_a_list_that_is_many_times_in_itself_is_refused() -> None:
    alone(
        """
        value = ["x" * 100_000] * 10
        for _ in range(30):
            value = [value] * 10
        assert "MiB" in refused(lambda: sextant.Scenario({"a": value}), ValueError)
        """
    )


@pytest.mark.parametrize("close", [True, False])
@pytest.mark.parametrize(("opened", "closed"), [("[", "]"), ("{a=", "}")])
def test_text_that_is_nested_deep_is_refused(opened: str, closed: str, close: bool) -> None:
    alone(
        f"""
        text = {opened!r} * 100_000 + "1" + ({closed!r} * 100_000 if {close} else "")
        refused(lambda: sextant.Scenario.from_text("x = " + text), sextant.ScenarioError)
        refused(lambda: sextant.Scenario.from_text("a." * 100_000 + "b = 1"), sextant.ScenarioError)
        refused(lambda: sextant.Scenario.from_text("[" + "a." * 100_000 + "b]"), sextant.ScenarioError)
        import subprocess, sys
        done = subprocess.run([sys.executable, "-m", "sextant", "check", "absent.toml", "--set", "x=" + text[:60_000]])
        assert done.returncode == 2, done.returncode
        """
    )


CHANGED = {
    "by a value": "class Value:\n    def tolist(self):\n        data.update({str(len(data)): 1})\n        return 1",
    "by a path": "class Value:\n    def __fspath__(self):\n        data.clear()\n        return 'x'",
}


@pytest.mark.parametrize("how", CHANGED)
def test_a_dict_that_changes_while_it_is_read_is_refused(how: str) -> None:
    alone(
        CHANGED[how]
        + """
for make in (lambda: sextant.Scenario(data), lambda: sextant.Scenario({"a": data}), lambda: sextant.Scenario({"a": [data]})):
    data = {"a": Value(), "b": 1, "c": 2}
    assert "changed" in refused(make, RuntimeError)
"""
    )


def test_a_list_that_grows_while_it_is_read_is_refused() -> None:
    alone(
        """
        class Value:
            def tolist(self):
                data.append(self)
                return 1
        data = [Value()]
        assert "changed" in refused(lambda: sextant.Scenario({"a": data}), RuntimeError)
        """
    )


def test_columns_that_change_while_they_are_read_are_refused() -> None:
    alone(
        """
        class Column:
            def __iter__(self):
                data["more"] = [1]
                return iter([1])
        data = {"a": Column(), "b": [1]}
        assert "changed" in refused(lambda: sextant.table(data), RuntimeError)
        class Number:
            def __float__(self):
                data.clear()
                return 1.0
        data = {"a": [Number()], "b": [1]}
        assert "changed" in refused(lambda: sextant.table(data), RuntimeError)
        """
    )


def test_threads_that_change_a_dict_do_no_harm() -> None:
    alone(
        """
        import threading, time
        data = {str(i): i for i in range(2000)}
        class Slow:
            def __fspath__(self):
                time.sleep(0.001)
                return "x"
        data["slow"] = Slow()
        stop = time.monotonic() + 1.0
        def change():
            while time.monotonic() < stop:
                data["new"] = 1
                data.pop("new", None)
        thread = threading.Thread(target=change)
        thread.start()
        while time.monotonic() < stop:
            refused(lambda: sextant.Scenario(data))
        thread.join()
        """
    )


def test_a_mapping_that_lies_is_refused() -> None:
    alone(
        """
        import collections.abc
        class Lying(collections.abc.Mapping):
            def __init__(self, items): self.given = items
            def __getitem__(self, key): raise LookupError("of the user")
            def __iter__(self): return iter(["a"])
            def __len__(self): return 1
            def items(self): return self.given
        for items in ([("a",)], [1], [("a", 1, 2)], [(1, 2)], [(None, 1)], 5, [("\\ud800", 1)]):
            refused(lambda: sextant.Scenario(Lying(items)))
        class Raising(Lying):
            def items(self): raise LookupError("of the user")
        assert "of the user" in refused(lambda: sextant.Scenario(Raising([])), LookupError)
        """
    )


def test_text_of_subclasses_is_not_taken_for_code() -> None:
    alone(
        """
        import enum
        class Number(int):
            def __str__(self): return "1\\nsead = 2"
            __repr__ = __str__
        class Level(enum.IntEnum):
            HIGH = 7
        for number, seed in ((Number(5), 5), (Level.HIGH, 7)):
            made = sextant.Scenario.template("survey", **{"robots.0.listen_s": number})
            assert f"listen_s = {seed}" in made.text, made.text
        """
    )


NO_WHOLE_NUMBERS = ["True", "False", "1.0", "1.5", "'2'", "float('nan')", "[1]", "1j", "b'1'"]


@pytest.mark.parametrize("value", ["0", "-1", "1025", "1500", "2**32", "2**64", "2**64 + 1", "10**5000", *NO_WHOLE_NUMBERS])
def test_a_number_of_threads_that_the_command_line_refuses_is_refused(value: str) -> None:
    alone(
        f"""
        survey = sextant.Scenario.template("survey")
        stops = {{"stop": [1, 2], "x_m": [0.0, 1.0], "y_m": [0.0, 0.0]}}
        heard = {{"node": ["a", "a"], "stop": [1, 2], "received": [1, 1]}}
        calls = [
            lambda n: survey.run(threads=n),
            lambda n: sextant.Log(stops, heard).map(threads=n),
            lambda n: sextant.Log(stops, heard).maps(threads=n),
            lambda n: sextant.map_log(stops, heard, threads=n),
            lambda n: sextant.sweep("absent.toml", threads=n),
        ]
        for call in calls:
            text = refused(lambda: call({value}), ValueError, TypeError)
            assert "`threads`" in text and "from 1 to 1024" in text, text
            assert len(text) < 500
        """
    )


def test_the_most_threads_are_taken() -> None:
    alone("assert len(sextant.Scenario.template('survey').run(threads=2).maps) == 2")


@pytest.mark.parametrize("value", ["-1", "2**64", *NO_WHOLE_NUMBERS])
def test_a_seed_is_a_whole_number_of_64_bits(value: str) -> None:
    alone(
        f"""
        survey = sextant.Scenario.template("survey")
        for call in (lambda: survey.run(seed={value}), lambda: survey.replace(seed={value}), lambda: sextant.Scenario("absent", seed={value})):
            text = refused(call, ValueError, TypeError)
            assert "`seed`" in text and "from 0 to 18446744073709551615" in text, text
        assert survey.replace(seed=2**64 - 1).seed == 2**64 - 1
        """
    )


@pytest.mark.parametrize("value", ["0", "-1", "2**32", *NO_WHOLE_NUMBERS])
def test_a_number_of_runs_is_a_whole_number(value: str) -> None:
    alone(f"assert '`runs`' in refused(lambda: sextant.sweep('absent.toml', runs={value}), ValueError, TypeError)")


@pytest.mark.parametrize("values", ["'csma'", "{'a': 1}", "{1, 2}", "frozenset({1})", "b'ab'", "5"])
def test_the_values_of_an_axis_have_an_order(values: str) -> None:
    alone(f"assert 'axis' in refused(lambda: sextant.sweep('absent.toml', {{'a': {values}}}), TypeError)")


def test_options_of_logs_are_of_their_types() -> None:
    alone(
        """
        stops = {"stop": [1], "x_m": [0.0], "y_m": [0.0]}
        heard = {"node": ["a"], "stop": [1], "received": [1]}
        for options in ({"pan": -1}, {"pan": 65536}, {"pan": True}, {"packet_interval": True}, {"packet_interval": float("nan")}, {"lora": 1}):
            refused(lambda: sextant.Log(stops, heard, **options), ValueError, TypeError)
        for value in (-1.0, 0.0, float("nan"), float("inf")):
            refused(lambda: sextant.Log(stops, heard).map(near_stops=value))
        """
    )


def test_programs_that_give_odd_answers_end_the_run_with_an_exception() -> None:
    alone(
        """
        deep = []
        for _ in range(20_000):
            deep = [deep]
        class Odd(sextant.Controller):
            def __init__(self, answer): self.answer = answer
            def next(self, robot): return self.answer(robot)
        answers = [
            lambda robot: deep, lambda robot: None, lambda robot: robot.ranges(count=2**31), lambda robot: robot.ranges(count=0),
            lambda robot: robot.ranges(count=True), lambda robot: robot.drive_to(float("nan"), 0.0), lambda robot: robot.clearance(0.0, -1.0),
        ]
        survey = sextant.Scenario.template("survey")
        for answer in answers:
            refused(lambda: survey.run(controller=Odd(answer)), TypeError, ValueError)
        """
    )
