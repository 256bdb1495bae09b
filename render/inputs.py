"""What the earlier stages left: the folders of the simulation and of the surface."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from common.simulation_files import BadTable, BodyState, BodyTable
from render.content.axes import Quaternion, Vector, triple, z_up, z_up_quaternion
from render.errors import Unusable


@dataclass(frozen=True)
class Box:
    """An upright box, in Blender's axes [m]."""

    low: Vector
    high: Vector

    @property
    def diagonal(self) -> float:
        return sum((b - a) ** 2 for a, b in zip(self.low, self.high, strict=True)) ** 0.5

    @property
    def center(self) -> Vector:
        return triple((a + b) / 2 for a, b in zip(self.low, self.high, strict=True))

    def grown(self, by: float) -> Box:
        """Larger by a length [m] on all sides."""
        return Box(triple(a - by for a in self.low), triple(b + by for b in self.high))

    def joined(self, other: Box) -> Box:
        """The smallest box around both."""
        return Box(triple(map(min, self.low, other.low)), triple(map(max, self.high, other.high)))

    def corners(self) -> list[Vector]:
        """All eight [m], the lowest first."""
        (x0, y0, z0), (x1, y1, z1) = self.low, self.high
        return [(x, y, z) for x in (x0, x1) for y in (y0, y1) for z in (z0, z1)]


@dataclass(frozen=True)
class Floor:
    """What the action stands on: the height of the floor [m], None where planes make none, and how far over it the
    middle of the thinnest cloth lies [m], None without cloth."""

    height: float | None = None
    cloth: float | None = None


@dataclass(frozen=True)
class Pose:
    """A rigid body in one frame, in Blender's axes: centre of mass [m], rotation (w, x, y, z),
    velocity [m/s] and angular velocity [rad/s]."""

    position: Vector
    rotation: Quaternion
    velocity: Vector
    angular_velocity: Vector


@dataclass(frozen=True)
class Inputs:
    """The files of a film."""

    simulation: Path
    surface: Path | None
    foam: Path | None = None
    wet: Path | None = None

    def extent(self) -> Box:
        """The box of the action over the whole film; raises Unusable without it."""
        path = self._summary
        try:
            extent = json.loads(path.read_text())["extent"]
            low, high = z_up(extent["min"]), z_up(extent["max"])
        except FileNotFoundError as error:
            raise Unusable(f"{path} is missing: it says how far the action reaches (extent: min, max)") from error
        except (OSError, ValueError, KeyError, TypeError) as error:
            what = f"{path} has no extent with min and max of three numbers each"
            raise Unusable(f"{what}\n  fix: delete it, and simulate its frames again") from error
        box = Box(triple(map(min, low, high)), triple(map(max, low, high)))
        if not 0 < box.diagonal < float("inf"):
            raise Unusable(f"{path}: the extent must have a size, found a diagonal of {box.diagonal} m")
        return box

    def floor(self) -> Floor:
        """What the action stands on; raises Unusable for a summary that says it otherwise."""
        try:
            return Floor(**json.loads(self._summary.read_text()).get("ground", {}))
        except (OSError, ValueError, TypeError, AttributeError) as error:
            what = f"{self._summary} has a ground without height and cloth"
            raise Unusable(f"{what}\n  fix: delete it, and simulate its frames again") from error

    def bodies(self) -> dict[str, Path]:
        """Meshes of the rigid bodies by name."""
        return self._named("body")

    def containers(self) -> dict[str, Path]:
        """Inner surfaces of the containers by name."""
        return self._named("container")

    def sheets(self) -> list[str]:
        """Names of the cloth sheets, of all frames."""
        found = (re.fullmatch(r"cloth_(.+)_\d+", path.stem) for path in self.simulation.glob("cloth_*.ply"))
        return sorted({match[1] for match in found if match})

    def sheet(self, name: str, frame: int) -> Path | None:
        """Mesh of a cloth sheet in a frame, if it is there then."""
        path = self.simulation / f"cloth_{name}_{frame:05d}.ply"
        return path if path.exists() else None

    def first_of_sheet(self, name: str) -> Path:
        """Mesh of a cloth sheet in the first frame that has it."""
        paths = self.simulation.glob(f"cloth_{name}_*.ply")
        return min(path for path in paths if re.fullmatch(rf"cloth_{re.escape(name)}_\d+", path.stem))

    def water(self, frame: int) -> Path | None:
        """The water's surface in a frame; None for a scene without fluid."""
        return None if self.surface is None else self.surface / f"surface_{frame:05d}.ply"

    def bubbles(self, frame: int) -> Path | None:
        """Foam, spray and bubbles of a frame; None for a scene without."""
        return None if self.foam is None else self.foam / f"foam_{frame:05d}.ply"

    def wetness(self, part: str, frame: int) -> Path | None:
        """What is wet of a part in a frame, as `body_NAME`; None where it is not there then, or nothing is wet."""
        path = None if self.wet is None else self.wet / f"wet_{part}_{frame:05d}.ply"
        return path if path is not None and path.exists() else None

    def wet_lattice(self) -> tuple[float, list[float]]:
        """Cell of the lattice of what is wet, and heights of the floors [m]; raises Unusable without them."""
        path = self.wet / "summary.json" if self.wet is not None else Path("summary.json")
        try:
            summary = json.loads(path.read_text())
            cell, floors = float(summary["cell"]), [float(height) for height in summary["floors"]]
        except (OSError, ValueError, KeyError, TypeError) as error:
            what = f"{path} does not say the cell and the floors of what is wet"
            raise Unusable(f"{what}\n  fix: delete its folder, and make it anew") from error
        if not cell > 0:
            raise Unusable(f"{path}: the cell must be positive, found {cell} m")
        return cell, floors

    def poses(self, frames: Iterable[int]) -> dict[int, dict[str, Pose]]:
        """Where the rigid bodies are, by frame and name; a body without a row is absent."""
        wanted: dict[int, dict[str, Pose]] = {frame: {} for frame in frames}
        table = BodyTable(self.simulation, frozenset(wanted))
        if not table.path.exists():
            return wanted
        try:
            for frame in table.times():
                wanted[frame] = {name: _pose(body) for name, body in table.bodies(frame).items()}
        except (OSError, BadTable) as error:
            raise Unusable(f"{error}\n  fix: delete it, and simulate its frames again") from error
        return wanted

    @property
    def _summary(self) -> Path:
        return self.simulation / "summary.json"

    def _named(self, kind: str) -> dict[str, Path]:
        paths = sorted(self.simulation.glob(f"{kind}_*.ply"))
        return {path.stem.removeprefix(f"{kind}_"): path for path in paths}


def _pose(body: BodyState) -> Pose:
    return Pose(
        position=z_up(body.position),
        rotation=z_up_quaternion(body.rotation),
        velocity=z_up(body.velocity),
        angular_velocity=z_up(body.angular_velocity),
    )
