"""A frame of a simulation, as arrays."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from common.ply import columns, read_mesh, read_points
from scene.settings import Refused


@dataclass(frozen=True)
class Body:
    """A solid in a frame; world coordinates, SI units."""

    position: np.ndarray
    """Of the centre of mass [m], float64, shape [3]."""
    rotation: np.ndarray
    """Since it was placed, a unit quaternion (w, x, y, z), float64, shape [4]."""
    velocity: np.ndarray
    """Of the centre of mass [m/s], float64, shape [3]."""
    angular_velocity: np.ndarray
    """[rad/s], float64, shape [3]."""


@dataclass(frozen=True)
class Sheet:
    """A piece of cloth in a frame; world coordinates, SI units."""

    vertices: np.ndarray
    """Positions [m], float32, shape [n, 3]."""
    velocities: np.ndarray
    """[m/s], float32, shape [n, 3]."""
    triangles: np.ndarray
    """Indices of vertices, int32, shape [m, 3]."""


class BodyTable:
    """The rows of a `bodies.csv` by frame. Each is read once; those that a run adds meanwhile, when they are asked
    for."""

    def __init__(self, folder: Path):
        self._path = folder / "bodies.csv"
        self._read = 0
        self._names: Sequence[str] | None = None
        self._rows: dict[int, list[dict[str, str]]] = {}

    def of(self, frame: int) -> list[dict[str, str]]:
        """Rows of a frame, by the names of columns."""
        if frame not in self._rows:
            self._read_on()
        return self._rows.get(frame, [])

    def times(self) -> dict[int, float]:
        """Of all frames that have bodies [s]."""
        self._read_on()
        return {frame: float(rows[0]["time"]) for frame, rows in self._rows.items()}

    def _read_on(self) -> None:
        with self._path.open(newline="", encoding="utf-8") as file:
            file.seek(self._read)
            reader = csv.DictReader(file, self._names)
            for row in reader:
                self._rows.setdefault(int(row["frame"]), []).append(row)
            self._names, self._read = reader.fieldnames, file.tell()


@dataclass(frozen=True)
class Frame:
    """One frame in the folder of a run; its arrays are read when they are asked for. Raises OSError and
    common.ply.BadPly where files are missing or are other than a run writes them."""

    number: int
    """From 0, the initial state."""
    time: float
    """[s]"""
    folder: Path
    """Where the files of the run are."""
    _kept: TemporaryDirectory | None = field(default=None, repr=False, compare=False)
    """The folder, where it is to be removed with the last frame that is in it."""
    _table: BodyTable | None = field(default=None, repr=False, compare=False)
    """What frames of one run share."""

    @cached_property
    def fluid(self) -> np.ndarray | None:
        """The particles, records with x, y, z [m], vx, vy, vz [m/s], density [kg/m^3] and id, shape [n], sorted by id;
        None in a scene without fluid."""
        path = self.folder / f"fluid_{self.number:05d}.ply"
        return read_points(path) if path.exists() else None

    @cached_property
    def positions(self) -> np.ndarray:
        """Of the particles [m], float32, shape [n, 3]; n is 0 in a scene without fluid."""
        return self._of_particles("xyz")

    @cached_property
    def velocities(self) -> np.ndarray:
        """Of the particles [m/s], float32, shape [n, 3]."""
        return self._of_particles(("vx", "vy", "vz"))

    def _of_particles(self, names: str | tuple[str, ...]) -> np.ndarray:
        return np.empty((0, 3), np.float32) if self.fluid is None else columns(self.fluid, names)

    @cached_property
    def bodies(self) -> dict[str, Body]:
        """The solids by name."""
        rows = (self._table or BodyTable(self.folder)).of(self.number)
        return {row["body"]: Body(*(np.array([float(row[name]) for name in names]) for names in _BODY)) for row in rows}

    @cached_property
    def cloth(self) -> dict[str, Sheet]:
        """The sheets by name."""
        end = f"_{self.number:05d}.ply"
        files = {path.name.removeprefix("cloth_").removesuffix(end): path for path in self.folder.glob(f"cloth_*{end}")}
        return {name: _sheet(path) for name, path in sorted(files.items())}


_BODY = (("x", "y", "z"), ("qw", "qx", "qy", "qz"), ("vx", "vy", "vz"), ("wx", "wy", "wz"))


def _sheet(path: Path) -> Sheet:
    points, triangles = read_mesh(path)
    return Sheet(columns(points, "xyz"), columns(points, ("vx", "vy", "vz")), triangles)


def frames(folder: Path | str) -> Iterator[Frame]:
    """The frames that a run left in a folder: that of `tidemill run`, or results/NAME/QUALITY/simulation/000.

    Raises OSError where there was no run, and Refused where only a run of an older version can tell their times.
    """
    folder = Path(folder)
    table = BodyTable(folder)
    times = table.times()
    files = (path for pattern in ("fluid_*.ply", "cloth_*.ply") for path in folder.glob(pattern))
    more = {int(path.stem.rpartition("_")[2]) for path in files} - set(times)
    if more:
        fps = json.loads((folder / "summary.json").read_text(encoding="utf-8")).get("fps")
        if fps is None:
            raise Refused(
                f"{folder / 'summary.json'} is of an older version and has no fps", remedy="simulate it again"
            )
        times |= {number: number / fps for number in more}
    for number, time in sorted(times.items()):
        yield Frame(number, time, folder, _table=table)
