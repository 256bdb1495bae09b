"""What is points in files: foam, and the fluid's particles where they are asked for."""

from __future__ import annotations

from array import array
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from common.simulation_files import BadTable, Sources, read_sources
from render.content.changing.foam import build_points
from render.content.ply import TriangleMesh, read_cloud
from render.content.scene import Scene
from render.errors import Unusable
from render.job import Job

PARTICLES = SimpleNamespace(type="matte", color=(0.16, 0.47, 0.69))
"""Look of the fluid's particles."""
NUMBERS = {
    **{name: name for name in ("life", "kind", "density", "age", "source")},
    "id": "particle_id",
}
"""Columns that become attributes of the points, and their names: what is called `id`, Blender exports to no file."""
WHOLE = ("kind", "id", "source")
"""Those of whole numbers."""


@dataclass(frozen=True)
class Cloud:
    """Points by their name in the file, and the files that they are read from."""

    name: str
    material: Any
    folder: Path
    kind: str
    """How the names of the files begin, as in `foam_00042.ply`."""
    radius: float | None = None
    """Of all points [m], where the files have none of each."""
    sources: Sources | None = None
    """When points came, and from where; None where the files do not tell."""
    fps: float = 24.0
    """Frames per simulated second [Hz]."""

    def read(self, frame: int) -> TriangleMesh:
        """The points of a frame, with their radius [m], and age [s] and the number of their source where these are
        known; raises Unusable for a file that cannot be read."""
        cloud = read_cloud(self.folder / f"{self.kind}_{frame:05d}.ply")
        columns = dict(cloud.columns)
        if self.radius is not None:
            columns["radius"] = array("f", [self.radius]) * cloud.vertex_count()
        if self.sources is not None and cloud.has("id"):
            try:
                rows = self.sources.rows(map(int, columns["id"]))
            except BadTable as error:
                raise Unusable(f"{self.folder}: {error}\n  fix: simulate it again") from None
            columns["age"] = array("f", (max(frame / self.fps - self.sources.time[row], 0.0) for row in rows))
            columns["source"] = array("i", (self.sources.index[row] for row in rows))
        return replace(cloud, columns=columns)

    def build(self, name: str, source: TriangleMesh) -> Any:
        """A bpy mesh of points, with all attributes that they have."""
        mesh = build_points(name, source)
        for column, attribute in NUMBERS.items():
            if source.has(column):
                whole = column in WHOLE
                values = array("i" if whole else "f", map(int if whole else float, source.columns[column]))
                mesh.attributes.new(attribute, "INT" if whole else "FLOAT", "POINT").data.foreach_set("value", values)
        return mesh


def clouds_of(scene: Scene, job: Job) -> tuple[Cloud, ...]:
    """The points of a job's animation."""
    looks = {"foam": scene.foam_look(), "particles": PARTICLES}
    return tuple(
        replace(cloud, material=scene.make_material(cloud.name, looks[cloud.name])) for cloud in bare_clouds(job)
    )


def bare_clouds(job: Job) -> Iterator[Cloud]:
    """The same without materials."""
    if job.foam is not None:
        yield Cloud("foam", None, Path(job.foam), "foam")
    if job.particles is not None:
        folder = Path(job.simulation)
        yield Cloud("particles", None, folder, "fluid", job.particles, _sources(folder), job.fps)


def _sources(folder: Path) -> Sources | None:
    """Those of a simulation, which one of an earlier version has not told."""
    try:
        return read_sources(folder)
    except FileNotFoundError:
        return None
    except BadTable as error:
        raise Unusable(f"{error}\n  fix: delete it, and simulate again") from None
