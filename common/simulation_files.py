"""What a simulation leaves in its folder: which frames, `bodies.csv`, the table of its rigid bodies, and `sources.csv`,
when its particles came, and from where."""

from __future__ import annotations

import csv
import math
from bisect import bisect_right
from collections.abc import Container, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

SOURCES = "sources.csv"


class BadTable(Exception):
    """A `bodies.csv` or `sources.csv` that is not the table that a simulation writes."""


class BodyState(NamedTuple):
    """A rigid body in a frame; world coordinates, SI units."""

    position: tuple[float, ...]
    """Of the centre of mass [m]."""
    rotation: tuple[float, ...]
    """Since it was placed, a unit quaternion (w, x, y, z)."""
    velocity: tuple[float, ...]
    """Of the centre of mass [m/s]."""
    angular_velocity: tuple[float, ...]
    """[rad/s]"""


class BodyTable:
    """The rows of a folder's `bodies.csv` by frame. Each is read once; those that a run adds meanwhile, when they are
    asked for. With `frames`, no others are kept.

    Its methods raise OSError where the file cannot be read, and BadTable for one that is something else.
    """

    def __init__(self, folder: Path, frames: Container[int] | None = None):
        self.path = folder / "bodies.csv"
        self._wanted = frames
        self._read = 0
        self._names: list[str] | None = None
        self._times: dict[int, float] = {}
        self._bodies: dict[int, dict[str, BodyState]] = {}

    def bodies(self, frame: int) -> dict[str, BodyState]:
        """The bodies of a frame by name; empty where the table has none."""
        if frame not in self._bodies:
            self._read_on()
        return self._bodies.get(frame, {})

    def times(self) -> dict[int, float]:
        """Times of the frames that have bodies [s]."""
        self._read_on()
        return self._times

    def _read_on(self) -> None:
        try:
            with self.path.open(newline="", encoding="utf-8") as file:
                file.seek(self._read)
                reader = csv.DictReader(file, self._names)
                if "frame" not in (reader.fieldnames or ()):
                    raise ValueError("there is no column frame")
                for row in reader:
                    self._take(row)
                self._names, self._read = list(reader.fieldnames or ()), file.tell()
        except (ValueError, KeyError, TypeError, csv.Error) as error:
            raise BadTable(f"{self.path} is not a table of rigid bodies: {error!r}") from error

    def _take(self, row: dict[str, str]) -> None:
        frame = int(row["frame"])
        if self._wanted is None or frame in self._wanted:
            self._times[frame] = float(row["time"])
            self._bodies.setdefault(frame, {})[row["body"]] = BodyState(
                *(tuple(float(row[name]) for name in names) for names in _COLUMNS)
            )


_COLUMNS = (("x", "y", "z"), ("qw", "qx", "qy", "qz"), ("vx", "vy", "vz"), ("wx", "wy", "wz"))


@dataclass(frozen=True)
class Sources:
    """When particles came, and from where, by rows of `sources.csv`: each is about those from an identity on, up to the
    next row's."""

    first: tuple[int, ...]
    """Identities, ascending."""
    time: tuple[float, ...]
    """[s]"""
    index: tuple[int, ...]
    """Into `names`."""
    names: tuple[str, ...]
    """Of fluid bodies and emitters, in the order of their first rows."""

    def rows(self, ids: Iterable[int]) -> list[int]:
        """The row of each of some particles; raises BadTable where one has none."""
        found = [bisect_right(self.first, number) - 1 for number in ids]
        if found and min(found) < 0:
            raise BadTable(f"{SOURCES} is not about all particles")
        return found


def read_sources(folder: Path) -> Sources:
    """Those of a folder; raises OSError where they cannot be read, and BadTable for something else."""
    path = folder / SOURCES
    try:
        with path.open(newline="", encoding="utf-8") as file:
            table = [(int(row["id"]), float(row["time"]), row["source"]) for row in csv.DictReader(file)]
        first, time, source = zip(*table, strict=True) if table else ((), (), ())
        if list(first) != sorted(set(first)) or not all(map(math.isfinite, time)):
            raise ValueError("rows are not in order")
    except (ValueError, KeyError, TypeError, csv.Error) as error:
        raise BadTable(f"{path} is not a table of the sources of particles: {error!r}") from error
    names = {name: index for index, name in enumerate(dict.fromkeys(source))}
    return Sources(first, time, tuple(names[name] for name in source), tuple(names))


def frames_of_files(folder: Path) -> set[int]:
    """The frames of which there are particles or cloth in the folder of a simulation."""
    files = (path for pattern in ("fluid_*.ply", "cloth_*.ply") for path in folder.glob(pattern))
    return {int(path.stem.rpartition("_")[2]) for path in files}
