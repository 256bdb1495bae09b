"""A frame of a simulation, as arrays."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from common.ply import columns, read_mesh, read_points
from common.simulation_files import BodyTable, frames_of_files
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


@dataclass(frozen=True)
class Frame:
    """One frame in the folder of a run; its arrays are read when they are asked for. Raises OSError,
    common.ply.BadPly and common.simulation_files.BadTable where files are missing or are other than a run writes
    them."""

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
        states = (self._table or BodyTable(self.folder)).bodies(self.number)
        return {name: Body(*map(np.array, state)) for name, state in states.items()}

    @cached_property
    def cloth(self) -> dict[str, Sheet]:
        """The sheets by name."""
        end = f"_{self.number:05d}.ply"
        files = {path.name.removeprefix("cloth_").removesuffix(end): path for path in self.folder.glob(f"cloth_*{end}")}
        return {name: _sheet(path) for name, path in sorted(files.items())}


def _sheet(path: Path) -> Sheet:
    points, triangles = read_mesh(path)
    return Sheet(columns(points, "xyz"), columns(points, ("vx", "vy", "vz")), triangles)


def frames(folder: Path | str) -> Iterator[Frame]:
    """The frames that a run left in a folder: that of `tidemill run`, or results/NAME/QUALITY/simulation/000.

    Raises OSError where there was no run, BadTable for a table of bodies that is none, and Refused where only a run of
    an older version can tell their times.
    """
    folder = Path(folder)
    table = BodyTable(folder)
    times = dict(table.times())
    more = frames_of_files(folder) - set(times)
    if more:
        fps = json.loads((folder / "summary.json").read_text(encoding="utf-8")).get("fps")
        if fps is None:
            raise Refused(
                f"{folder / 'summary.json'} is of an older version and has no fps", remedy="simulate it again"
            )
        times |= {number: number / fps for number in more}
    for number, time in sorted(times.items()):
        yield Frame(number, time, folder, _table=table)
