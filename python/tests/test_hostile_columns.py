"""Columns with gaps, and columns of Arrow that are not what their type says."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from test_hostile_values import alone

import sextant


def column(values: Any) -> list[Any]:
    """A column as the package reads it."""
    return sextant.table({"x": values}).to_list("x")


MASKED = {
    "floats": ([1.0, 2.0, 3.0], "float64"),
    "floats of 32 bits": ([1.0, 2.0, 3.0], "float32"),
    "whole numbers": ([1, 2, 3], "int64"),
    "whole numbers without a sign": ([1, 2, 3], "uint8"),
    "truths": ([True, False, True], "bool"),
    "texts": (["a", "b", "c"], "U1"),
    "objects": (["a", "b", "c"], "object"),
}


@pytest.mark.parametrize("kind", MASKED)
def test_masked_cells_of_numpy_are_empty(kind: str) -> None:
    values, dtype = MASKED[kind]
    masked = np.ma.array(values, dtype=dtype, mask=[False, True, False])
    assert column(masked) == [values[0], None, values[2]]
    assert column(masked[1:]) == [None, values[2]]
    assert column(masked[::-1]) == [values[2], None, values[0]]
    assert column(np.ma.array(values, dtype=dtype)) == values
    assert column(np.ma.array(values, dtype=dtype, mask=True)) == [None] * 3


def test_masked_cells_of_structured_arrays_are_empty() -> None:
    rows = np.ma.zeros(3, dtype=[("node", "U1"), ("stop", "i8"), ("rssi_dbm", "f8")])
    rows["node"], rows["stop"], rows["rssi_dbm"] = ["a", "b", "c"], [1, 2, 3], [-1.0, -2.0, -3.0]
    rows[1] = np.ma.masked
    rows["rssi_dbm"][2] = np.ma.masked
    assert sextant.table(rows).to_dict() == {"node": ["a", None, "c"], "stop": [1, None, 3], "rssi_dbm": [-1.0, None, None]}


def test_a_masked_place_is_no_place() -> None:
    stops = {"stop": [1, 2], "x_m": np.ma.array([0.0, 7.0], mask=[False, True]), "y_m": [0.0, 0.0]}
    with pytest.raises(sextant.LogError) as caught:
        sextant.Log(stops, {"node": ["a"], "stop": [1], "received": [1]})
    assert (caught.value.row, caught.value.column) == (1, "x_m")


def test_a_masked_strength_is_not_measured() -> None:
    stops = {"stop": [1, 2], "x_m": [0.0, 1.0], "y_m": [0.0, 0.0]}
    heard = {"node": ["a", "a"], "stop": [1, 2], "received": [1, 1], "rssi_dbm": np.ma.array([-60.0, 999.0], mask=[0, 1])}
    assert sextant.Log(stops, heard).receptions.to_list("rssi_dbm") == [-60.0, None]


def test_times_that_are_masked_or_unknown_are_empty() -> None:
    times = np.array(["2024-01-01", "NaT", "2024-01-03"], dtype="datetime64[s]")
    known = sextant.table({"t": times})
    masked = sextant.table({"t": np.ma.array(times, mask=[True, False, False])})
    pa = pytest.importorskip("pyarrow")
    assert pa.table(known)["t"].null_count == 1
    assert pa.table(masked)["t"].to_pylist()[:2] == [None, None]


@pytest.mark.parametrize("time", ["3000-01-01", "1000-01-01"])
def test_times_that_nanoseconds_cannot_tell_are_refused(time: str) -> None:
    with pytest.raises(ValueError, match="column `t`.*1678 to 2262"):
        sextant.table({"t": np.array([time], dtype="datetime64[D]")})


@pytest.mark.parametrize("with_pyarrow", [True, False])
def test_gaps_of_pandas_are_empty(with_pyarrow: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    pandas = pytest.importorskip("pandas")
    if not with_pyarrow:
        import sys

        monkeypatch.setitem(sys.modules, "pyarrow", None)
    columns = {
        "whole": ([1, None, 3], "Int64"),
        "small": ([1, None, 3], "UInt8"),
        "real": ([1.5, None, 3.5], "Float64"),
        "truth": ([True, None, False], "boolean"),
        "text": (["a", None, "c"], "object"),
        "named": (["a", None, "c"], "category"),
    }
    series = {name: pandas.Series(values, dtype=dtype) for name, (values, dtype) in columns.items()}
    expected = {name: values for name, (values, _) in columns.items()}
    assert sextant.table(series).to_dict() == expected
    assert sextant.table(pandas.DataFrame(series)).to_dict() == expected
    # Types without gaps stay as they are.
    assert column(pandas.Series([1, 2], dtype="Int64")) == [1, 2]
    assert column([1, pandas.NA, 3]) == [1, None, 3]
    assert column(["a", pandas.NA, "c"]) == ["a", None, "c"]


def test_gaps_of_polars_are_empty() -> None:
    polars = pytest.importorskip("polars")
    frame = polars.DataFrame({"a": [1, None, 3], "b": [None, 2.5, None], "c": ["x", None, ""]})
    assert sextant.table(frame).to_dict() == frame.to_dict(as_series=False)


def test_lists_with_gaps() -> None:
    assert column([1, None, float("nan")]) == [1, None, None]
    assert column([None, None]) == [None, None]
    assert column(["a", None, float("nan"), ""]) == ["a", None, None, ""]
    with pytest.warns(UserWarning, match="masked"):
        assert column([1.5, np.ma.masked, 2.5]) == [1.5, None, 2.5]


LARGE = [2**64 - 1, 2**64 - 2, 7]


@pytest.mark.parametrize("form", [list, lambda values: np.array(values, dtype="uint64")])
def test_addresses_of_64_bits_stay_apart(form: Callable[[list[int]], Any]) -> None:
    stops = {"stop": [1], "x_m": [0.0], "y_m": [0.0]}
    log = sextant.Log(stops, {"node": form(LARGE), "stop": [1, 1, 1], "received": [1, 1, 1]})
    assert log.nodes == [str(address) for address in LARGE]


@pytest.mark.parametrize("values", ["abc", b"abc", {"a": 1}, {1, 2}, frozenset({1}), bytearray(b"a")])
def test_what_is_no_column_is_refused(values: Any) -> None:
    with pytest.raises(TypeError, match="column `x`: a column is a"):
        column(values)


@pytest.mark.parametrize("shape", [(), (2, 2), (1, 1)])
def test_an_array_has_one_dimension(shape: tuple[int, ...]) -> None:
    with pytest.raises(TypeError, match="dimensions"):
        column(np.zeros(shape))


ARROW = """
import pyarrow as pa
def buffers(kind, *parts, length):
    return pa.Array.from_buffers(kind, length, [None if part is None else pa.py_buffer(part) for part in parts])
def wrong(array, row, *words):
    stops = {"stop": [1], "x_m": [0.0], "y_m": [0.0]}
    table = lambda: pa.table({"n": list(range(len(array))), "node": array})
    for make in (lambda: sextant.table({"node": array}), lambda: sextant.table(table()), lambda: sextant.Log(stops, table())):
        try:
            made = make()
        except sextant.LogError as error:
            assert error.column == "node", error.column
            assert error.row == row, (error.row, row, str(error))
            assert all(word in str(error) for word in words), str(error)
        else:
            raise AssertionError(f"{made!r} was taken")
import struct
"""


@pytest.mark.parametrize("kind", ["string", "large_string"])
def test_text_that_is_not_utf8_is_refused_with_its_row(kind: str) -> None:
    alone(
        ARROW
        + f"""
ends = struct.pack("<4{'i' if kind == 'string' else 'q'}", 0, 1, 3, 4)
bad = buffers(pa.{kind}(), None, ends, b"a\\xff\\xfec", length=3)
wrong(bad, 1, "ff fe", "UTF-8")
wrong(bad.slice(1), 0, "ff fe")
wrong(pa.chunked_array([pa.array(["x", "y"], pa.{kind}()), bad]), 3, "ff fe")
# A letter that two cells share.
wrong(buffers(pa.{kind}(), None, struct.pack("<3{'i' if kind == 'string' else 'q'}", 0, 1, 2), "é".encode(), length=2), 0, "c3")
good = buffers(pa.{kind}(), None, ends, b"abbc", length=3)
assert pa.table(sextant.table({{"node": good.slice(1)}}))["node"].to_pylist() == ["bb", "c"]
"""
    )


def test_text_in_views_that_is_not_utf8_is_refused() -> None:
    alone(
        ARROW
        + """
if hasattr(pa, "string_view"):
    bad = pa.array([b"fine", b"a\\xff", b"\\xfe" * 40], pa.binary_view())
    for kind, rows in ((pa.string_view(), 1),):
        parts = bad.buffers()
        wrong(pa.Array.from_buffers(kind, 3, parts), rows, "61 ff")
"""
    )


@pytest.mark.parametrize("key", ["int8", "int16", "int32", "int64", "uint8", "uint64"])
def test_an_index_without_an_entry_is_refused_with_its_row(key: str) -> None:
    alone(
        ARROW
        + f"""
entries = pa.array(["a", "b"])
def of(indices):
    return pa.DictionaryArray.from_arrays(pa.array(indices, pa.{key}()), entries, safe=False)
for indices, row in (([0, 2], 1), ([1, 100, 0], 1)) + ((([0, 1, -1], 2),) if "{key}"[0] == "i" else ()):
    wrong(of(indices), row, "index " + str(indices[row]), "2 entries")
assert pa.table(sextant.table({{"node": of([1, None, 0])}}))["node"].to_pylist() == ["b", None, "a"]
wrong(pa.DictionaryArray.from_arrays(pa.array([0], pa.{key}()), pa.array([], pa.string()), safe=False), 0, "0 entries")
"""
    )


def test_an_entry_that_is_not_utf8_is_refused_with_its_first_row() -> None:
    alone(
        ARROW
        + """
entries = buffers(pa.string(), None, struct.pack("<3i", 0, 1, 2), b"a\\xff", length=2)
wrong(pa.DictionaryArray.from_arrays(pa.array([0, 0, 1, 1], pa.int32()), entries), 2, "ff")
"""
    )


def test_gaps_of_dictionaries_are_empty() -> None:
    alone(
        """
import pyarrow as pa
stops = pa.table({"stop": [1], "x_m": [0.0], "y_m": [0.0]})
def strengths(column):
    return sextant.Log(stops, pa.table({"node": ["a", "b"], "stop": [1, 1], "received": [1, 1], "rssi_dbm": column})).receptions.to_list("rssi_dbm")
# Numbers in a dictionary, a gap among its entries, and no entries at all.
assert strengths(pa.array([-60.0, None]).dictionary_encode()) == [-60.0, None]
assert strengths(pa.DictionaryArray.from_arrays(pa.array([0, 1], pa.int8()), pa.array([-60.0, None]))) == [-60.0, None]
nothing = pa.DictionaryArray.from_arrays(pa.array([None, None], pa.int8()), pa.array([], pa.string()))
robots = pa.table({"stop": [1, 2], "x_m": [0.0, 1.0], "y_m": [0.0, 0.0], "robot": nothing})
refused(lambda: sextant.Log(robots, pa.table({"node": ["a"], "stop": [1], "received": [1]})), sextant.LogError)
names = pa.DictionaryArray.from_arrays(pa.array([0, 1], pa.int8()), pa.array(["a", None]))
refused(lambda: sextant.Log(stops, pa.table({"node": names, "stop": [1, 1], "received": [1, 1]})), sextant.LogError)
"""
    )


def test_runs_are_written_out() -> None:
    alone(
        """
import pyarrow as pa
runs = pa.RunEndEncodedArray.from_arrays(pa.array([2, 3, 5], pa.int32()), pa.array(["a", None, "b"]))
assert sextant.table({"node": runs}).to_list("node") == ["a", "a", None, "b", "b"]
assert sextant.table({"node": runs.slice(1, 3)}).to_list("node") == ["a", None, "b"]
for ends in ([2, 1, 5], [0, 3, 5], [-1, 3, 5]):
    refused(lambda: sextant.table({"node": pa.RunEndEncodedArray.from_arrays(pa.array(ends, pa.int32()), pa.array(["a", "b", "c"]))}))
"""
    )


def test_columns_of_types_that_mean_nothing_are_errors_only_where_they_are_needed() -> None:
    alone(
        """
import datetime
import pyarrow as pa
stops = pa.table({"stop": [1], "x_m": [0.0], "y_m": [0.0]})
odd = {
    "list": pa.array([[1], [2]]), "struct": pa.array([{"a": 1}, {"a": 2}]), "date": pa.array([datetime.date(2024, 1, 1)] * 2),
    "binary": pa.array([b"a", b"b"]), "duration": pa.array([datetime.timedelta(1)] * 2),
}
for column in odd.values():
    heard = {"node": ["a", "b"], "stop": [1, 1], "received": [1, 1]}
    assert len(sextant.Log(stops, pa.table({**heard, "odd": column})).nodes) == 2
    for needed in ("node", "received", "rssi_dbm"):
        try:
            sextant.Log(stops, pa.table({**heard, needed: column}))
        except sextant.LogError as error:
            assert (error.column, error.row) == (needed, 0), (needed, str(error))
        else:
            raise AssertionError((needed, column.type))
# A column of nothing is empty.
assert len(sextant.Log(stops, pa.table({**heard, "rssi_dbm": pa.nulls(2)})).receptions) == 2
union = pa.UnionArray.from_sparse(pa.array([0, 1], pa.int8()), [pa.array([1, 2]), pa.array(["a", "b"])])
assert "union" in refused(lambda: sextant.Log(stops, pa.table({**heard, "odd": union})), sextant.LogError).lower()
"""
    )


def test_rows_that_are_missing_as_a_whole_are_empty() -> None:
    alone(
        """
import pyarrow as pa
rows = pa.array([{"x": 1, "y": "a"}, None, {"x": 3, "y": "c"}])
for data in (rows, pa.chunked_array([rows]), rows.slice(1)):
    assert sextant.table(data).to_dict() == {"x": [1, None, 3][-len(data):], "y": ["a", None, "c"][-len(data):]}
"""
    )


def test_slices_and_masks_with_offsets_are_read_from_their_place() -> None:
    alone(
        """
import pyarrow as pa
numbers = pa.array([None if i % 3 == 0 else float(i) for i in range(40)])
texts = pa.array([None if i % 5 == 0 else "é" * i for i in range(40)])
for start, length in ((0, 40), (3, 10), (9, 20), (39, 1), (40, 0)):
    part = pa.table({"a": numbers, "b": texts}).slice(start, length)
    assert sextant.table(part).to_dict() == part.to_pydict()
    assert sextant.table({"a": numbers.slice(start, length), "b": texts.slice(start, length)}).to_dict() == part.to_pydict()
assert sextant.table(pa.table({"a": pa.chunked_array([], pa.float64())})).to_dict() == {"a": []}
assert len(sextant.table(pa.table({}))) == 0
"""
    )


@pytest.mark.parametrize("levels", [100, 20_000])
def test_types_of_arrow_that_are_nested_deep_are_refused(levels: int) -> None:
    # The type is made as the interface says, because the library that usually does has limits of its own.
    alone(
        f"""
import ctypes
class Schema(ctypes.Structure):
    pass
Release = ctypes.CFUNCTYPE(None, ctypes.POINTER(Schema))
Schema._fields_ = [
    ("format", ctypes.c_char_p), ("name", ctypes.c_char_p), ("metadata", ctypes.c_char_p), ("flags", ctypes.c_int64), ("n_children", ctypes.c_int64),
    ("children", ctypes.POINTER(ctypes.POINTER(Schema))), ("dictionary", ctypes.POINTER(Schema)), ("release", Release), ("private", ctypes.c_void_p),
]
kept = []
@Release
def release(schema):
    schema.contents.release = Release()
inner = Schema(b"l", b"item", None, 2, 0, None, None, release, None)
for _ in range({levels}):
    children = (ctypes.POINTER(Schema) * 1)(ctypes.pointer(inner))
    kept += [inner, children]
    inner = Schema(b"+l", b"item", None, 2, 1, children, None, release, None)
capsule = ctypes.pythonapi.PyCapsule_New
capsule.restype, capsule.argtypes = ctypes.py_object, [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
class Deep:
    def __arrow_c_array__(self, requested_schema=None):
        array = ctypes.create_string_buffer(80)
        kept.append(array)
        return capsule(ctypes.addressof(inner), b"arrow_schema", None), capsule(ctypes.addressof(array), b"arrow_array", None)
assert "deep" in refused(lambda: sextant.table({{"x": Deep()}}), ValueError)
assert "deep" in refused(lambda: sextant.table(Deep()), ValueError)
"""
    )


def test_streams_of_deep_types_and_what_is_no_capsule_are_refused() -> None:
    alone(
        """
import pyarrow as pa
kind = pa.int64()
for _ in range(70):
    kind = pa.list_(kind)
assert "deep" in refused(lambda: sextant.table(pa.table({"x": pa.array([], kind)})), ValueError)
stream = pa.table({"x": [1]}).__arrow_c_stream__()
class Once:
    def __arrow_c_stream__(self, requested_schema=None): return stream
assert len(sextant.table(Once())) == 1
refused(lambda: sextant.table(Once()))
for odd in (None, 5, (), (1, 2), stream, (stream, stream)):
    class Odd:
        def __arrow_c_array__(self, requested_schema=None): return odd
        __arrow_c_stream__ = __arrow_c_array__
    refused(lambda: sextant.table(Odd()))
class Raising:
    def __arrow_c_stream__(self, requested_schema=None): raise LookupError("of the user")
assert "of the user" in refused(lambda: sextant.table(Raising()), LookupError)
"""
    )
