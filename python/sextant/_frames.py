"""Tables in the form in which the user has tables."""

from __future__ import annotations

import sys
from typing import Any

from ._native import Table

Like = Any


def as_like(table: Table, sample: Like) -> Any:
    """Give `table` in the form of `sample`: a data frame of the same library, or a dict of arrays."""
    library = type(sample).__module__.partition(".")[0]
    if library == "pandas":
        pandas = sys.modules["pandas"]
        return pandas.DataFrame({name: table[name] for name in table.column_names})
    if library == "polars":
        return sys.modules["polars"].DataFrame(table)
    if library == "pyarrow":
        return sys.modules["pyarrow"].table(table)
    if isinstance(sample, dict):
        if all(type(column).__module__.partition(".")[0] == "numpy" for column in sample.values()):
            return {name: table[name] for name in table.column_names}
        return table.to_dict()
    return table


def without_rows(sample: Like) -> Like:
    """Give a sample of the same form without rows."""
    library = type(sample).__module__.partition(".")[0]
    if library in ("pandas", "polars"):
        return sample.head(0)
    if library == "pyarrow":
        return sample.slice(0, 0)
    if isinstance(sample, dict):
        return {name: column[:0] for name, column in sample.items()}
    return None
