"""OpenVDB: how full of fluid and foam the cells of a grid are, in a file a frame, for programs that draw volumes.

Each particle gives its volume to the eight grid points around it by trilinear weights: the sums of volumes and of their
moments are those of the particles.
"""

from __future__ import annotations

import math
import os
import platform
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from common.attributes import SHARE
from render.blender import versions
from render.blender.session import bpy
from render.content.ply import TriangleMesh
from render.errors import RenderError, Unusable
from render.export.clouds import Cloud, bare_clouds
from render.job import Job, Report

TILE = 32
"""Edge of what is handed to OpenVDB at once, in cells."""
CORNERS = [(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)]


def export_volumes(job: Job, path: Path, report: Report) -> dict[str, Any]:
    """Write NAME_00042.vdb for each frame, beside `path`, NAME.vdb; returns the summary.

    Raises RenderError, and Unusable for files that cannot be read and Blenders without OpenVDB or NumPy.
    """
    if job.particles is None:
        raise Unusable("--export: .vdb files are made of particles\n  fix: give --particles with their radius")
    vdb = versions.openvdb()
    if vdb is None:
        raise Unusable("this Blender has no OpenVDB or no NumPy for Python\n  fix: leave --blender out")
    voxel = job.voxel or 2 * job.particles
    parts: dict[Path, Path] = {}
    try:
        for frame in job.frames():
            whole = path.with_name(f"{path.stem}_{frame:05d}{path.suffix}")
            parts[whole] = path.with_name(f".{whole.stem}.part{path.suffix}")
            grids = [grid for cloud in bare_clouds(job) for grid in _grids(vdb, cloud, frame, voxel)]
            vdb.write(str(parts[whole]), grids=grids, metadata={"frame": frame, "fps": job.fps})
            report({"frame": frame, "wall_s": 0.0})
        for whole, part in parts.items():
            part.replace(whole)
    except OSError as error:
        raise RenderError(f"cannot write {path}: {error.strerror or error}") from error
    finally:
        for part in parts.values():
            part.unlink(missing_ok=True)
    return {
        "versions": {"blender": bpy.app.version_string, "python": platform.python_version()},
        "frames": {"first": job.first, "last": job.last, "count": len(job.frames())},
        "bytes": sum(map(os.path.getsize, parts)),
        "warnings": [],
        "wall_s": {},
    }


def _grids(vdb: Any, cloud: Cloud, frame: int, voxel: float) -> Iterator[Any]:
    """Of foam, its density; of the fluid, also what is known of it: means in cells, weighted by volumes."""
    import numpy as np

    points = cloud.read(frame)
    cells, number, weight = _shares(points, voxel)
    volume = _volumes(points, own_cell=cloud.kind == "fluid")[np.arange(len(number)) // len(CORNERS)] * weight
    total = np.bincount(number, volume, len(cells))
    foam = cloud.kind == "foam"
    yield _grid(vdb, vdb.FloatGrid(), "foam" if foam else "density", cells, total / voxel**3, voxel)
    if foam:
        return
    known = {"velocity": np.stack([points.columns[name] for name in ("vx", "vy", "vz")], axis=1)}
    if points.has("age"):
        known["age"] = np.asarray(points.columns["age"])[:, None]
    for index, name in enumerate(cloud.sources.names if cloud.sources else ()):
        known[f"{SHARE}{name}"] = (np.asarray(points.columns["source"]) == index)[:, None]
    for name, values in known.items():
        spread = np.repeat(values.astype(float), len(CORNERS), axis=0) * volume[:, None]
        sums = np.stack([np.bincount(number, column, len(cells)) for column in spread.T], axis=1)
        means = sums / np.maximum(total, math.ulp(0.0))[:, None]
        empty = vdb.Vec3SGrid() if means.shape[1] == 3 else vdb.FloatGrid()
        yield _grid(vdb, empty, name, cells, means.squeeze(axis=1) if means.shape[1] == 1 else means, voxel)


def _shares(points: TriangleMesh, voxel: float) -> tuple[Any, Any, Any]:
    """Cells that points share in, shape [m, 3]; of each point in turn, for its CORNERS, the number of the cell and the
    weight, shape [8 n]."""
    import numpy as np

    place = np.stack([np.asarray(points.columns[axis], float) for axis in "xyz"], axis=1) / voxel
    low = np.floor(place).astype(np.int64)
    corner = np.array(CORNERS)
    weight = np.abs(1 - corner - (place - low)[:, None]).prod(axis=2).ravel()
    every = (low[:, None] + corner).reshape(-1, 3)
    cells, number = np.unique(every, axis=0, return_inverse=True)
    return cells, number.ravel(), weight


def _volumes(points: TriangleMesh, *, own_cell: bool) -> Any:
    """Of points [m^3]: the cells of the lattice that particles begin in, or balls."""
    import numpy as np

    radius = np.asarray(points.columns["radius"], float)
    return (8 if own_cell else 4 / 3 * math.pi) * radius**3


def _grid(vdb: Any, grid: Any, name: str, cells: Any, values: Any, voxel: float) -> Any:
    """Fill a grid tile by tile, so that what is far off costs no more than what is near."""
    import numpy as np

    grid.name = name
    grid.transform = vdb.createLinearTransform(voxelSize=voxel)
    if name in ("density", "foam"):
        grid.gridClass = vdb.GridClass.FOG_VOLUME
    tile = cells // TILE
    starts, number = np.unique(tile, axis=0, return_inverse=True)
    order = np.argsort(number.ravel(), kind="stable")
    ends = np.cumsum(np.bincount(number.ravel(), minlength=len(starts)))
    for start, rows in zip(starts, np.split(order, ends[:-1]), strict=False):
        dense = np.zeros((TILE, TILE, TILE, *values.shape[1:]), np.float32)
        dense[tuple((cells[rows] - start * TILE).T)] = values[rows]
        grid.copyFromArray(dense, ijk=tuple(int(index) for index in start * TILE))
    return grid
