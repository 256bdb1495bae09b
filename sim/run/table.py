"""Tables of a run as CSV files."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from common.files import whole


class Table:
    """A CSV file that grows by whole frames; rows are kept back until `flush`.

    `until`: go on after the rows of an earlier run up to this time [s], if there are any.
    """

    def __init__(self, path: Path, columns: Iterable[str], until: float | None = None):
        self.columns = list(columns)
        self._rows: list[list[Any]] = []
        kept = [] if until is None else _rows_until(path, self.columns, until)
        with whole(path) as stream:
            stream.write(_csv([self.columns, *kept]))
        self._stream = path.open("r+b", buffering=0)
        self.mark()

    def add(self, *values: Any) -> None:
        """Keep a row back, floats with nine digits, and empty where they are not finite."""
        self._rows.append([_short(value) for value in values])

    def drop(self) -> None:
        """Forget the rows since the last flush: their steps are to be repeated."""
        self._rows.clear()

    def mark(self) -> None:
        """Remember the present end, for `undo`."""
        self._size = self._stream.seek(0, os.SEEK_END)

    def flush(self) -> None:
        """Write the rows that were kept back."""
        left = memoryview(_csv(self._rows))
        while left:
            left = left[self._stream.write(left) :]
        self._rows.clear()

    def undo(self) -> None:
        """Take back what was flushed since the last mark, whole or not."""
        self._stream.truncate(self._size)
        self._stream.seek(self._size)

    def close(self) -> None:
        """Close the file; rows that are kept back are lost."""
        self._stream.close()


def write_table(path: Path, columns: Sequence[str], rows: Iterable[Iterable[Any]]) -> None:
    """Write a table that is whole or as it was, with floats as in a `Table`."""
    with whole(path) as stream:
        stream.write(_csv([columns, *([_short(value) for value in row] for row in rows)]))


def _rows_until(path: Path, columns: list[str], until: float) -> list[list[str]]:
    try:
        with open(path, newline="", encoding="utf-8") as stream:
            rows = list(csv.reader(stream))
        if not rows or rows[0] != columns:
            return []
        column, last = columns.index("time"), float(_short(until))
        return [row for row in rows[1:] if float(row[column]) <= last]
    except (OSError, ValueError, IndexError):
        return []


def _csv(rows: Iterable[Iterable[Any]]) -> bytes:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue().encode()


def _short(value: Any) -> Any:
    if isinstance(value, float | np.floating):
        return f"{value:.9g}" if np.isfinite(value) else ""
    return value
