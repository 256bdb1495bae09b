"""Tables as CSV files; those of the segments (steps.csv, bodies.csv, probes.csv) as tables of the film."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, TextIO

from scene.settings import Refused

TABLES = ("steps.csv", "probes.csv", "bodies.csv")


def concatenate(parts: Sequence[Path], whole: Path) -> bool:
    """Write the rows of all `parts` that exist, in order, to `whole`; False where there is none.

    A column that only some parts have is empty in the rows of the others. Raises Refused for what is no table of a run.
    """
    present = [part for part in parts if part.exists()]
    columns: dict[str, None] = {}
    for part in present:
        with part.open(newline="", encoding="utf-8") as file:
            found = _first_row(file)
        if "time" not in found:
            raise Refused(f"{part} is not a table of a run", remedy="delete it, and simulate its frames again")
        columns.update(dict.fromkeys(found))
    if not columns:
        return False
    with whole.open("w", newline="", encoding="utf-8") as target:
        writer = csv.DictWriter(target, list(columns), restval="", lineterminator="\n")
        writer.writeheader()
        for part in present:
            with part.open(newline="", encoding="utf-8") as file:
                writer.writerows(csv.DictReader(file))
    return True


def _first_row(file: TextIO) -> list[str]:
    try:
        return next(csv.reader(file), [])
    except (ValueError, csv.Error):
        return []


def write(path: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Write rows that all have the columns of the first; None is empty."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def numbers(table: Path, columns: Iterable[str]) -> dict[str, list[float]]:
    """Those of the `columns` that the table has, as numbers; NaN for what is none."""
    with table.open(newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file)
        found: dict[str, list[float]] = {name: [] for name in columns if name in (reader.fieldnames or ())}
        for row in reader:
            for name, values in found.items():
                values.append(_number(row[name]))
    return found


def _number(text: str | None) -> float:
    try:
        return float(text or "nan")
    except ValueError:
        return math.nan
