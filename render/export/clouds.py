"""What is points in files: foam, and the fluid's particles where they are asked for."""

from __future__ import annotations

from array import array
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from render.content.changing.foam import build_points
from render.content.ply import TriangleMesh, read_cloud
from render.content.scene import Scene
from render.job import Job

PARTICLES = SimpleNamespace(type="matte", color=(0.16, 0.47, 0.69))
"""Look of the fluid's particles."""
NUMBERS = {"life": "life", "kind": "kind", "density": "density", "id": "particle_id"}
"""Columns that become attributes of the points, and their names: what is called `id`, Blender exports to no file."""
WHOLE = ("kind", "id")
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

    def read(self, frame: int) -> TriangleMesh:
        """The points of a frame, with their radius [m]; raises Unusable for a file that cannot be read."""
        source = read_cloud(self.folder / f"{self.kind}_{frame:05d}.ply")
        if self.radius is None:
            return source
        radius = array("f", [self.radius]) * source.vertex_count()
        return replace(source, columns={**source.columns, "radius": radius})

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
    found = []
    if job.foam is not None:
        found.append(Cloud("foam", scene.make_material("foam", scene.foam_look()), Path(job.foam), "foam"))
    if job.particles is not None:
        material = scene.make_material("particles", PARTICLES)
        found.append(Cloud("particles", material, Path(job.simulation), "fluid", job.particles))
    return tuple(found)
