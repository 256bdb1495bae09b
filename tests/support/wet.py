"""Cloth in water: what tests of the two share."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from plyfile import PlyData

from tests.support.particles import positions, read_frame, velocities
from tests.support.passing import went_through
from tests.support.stepping import advance

if TYPE_CHECKING:
    from sim.run.world import World

RHO, G, D = 1000.0, 9.81, 0.025


def scene(solver: str, water: dict[str, Any], sheet: dict[str, Any], **more: Any) -> dict[str, Any]:
    """One body of water and one sheet."""
    fluid = {"solver": solver, "particle_radius": D / 2, "bodies": {"water": water}}
    cloth = {"max_step": 0.004, "sheets": {"sheet": sheet}} | more.pop("cloth", {})
    return {"fps": 100, "fluid": fluid, "cloth": cloth} | more


def particle_mass() -> float:
    from sim.fluid import kernel

    return kernel.particle_mass(D, 2 * D, RHO)


def read_sheet(out: Path, frame: int, name: str = "sheet") -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points [m], velocities [m/s] and triangles of a sheet."""
    data = PlyData.read(out / f"cloth_{name}_{frame:05d}.ply")
    points = data["vertex"].data
    triangles = np.vstack(data["face"].data["vertex_indices"])
    return positions(points), velocities(points), triangles


def point_masses(points: np.ndarray, mass_per_area: float) -> np.ndarray:
    """Of a sheet that lies flat as placed: of half a cell to each side that there is [kg]."""
    width = 1.0
    for axis in (0, 2):
        lines = np.unique(points[:, axis].round(9))
        halves = np.gradient(lines)
        halves[[0, -1]] /= 2
        width = width * halves[np.searchsorted(lines, points[:, axis].round(9))]
    return mass_per_area * width


def below(water: np.ndarray, points: np.ndarray, triangles: np.ndarray) -> int:
    """How many particles [m], shape [n, 3], are under a sheet: within its outline, as seen from above, and lower than
    all of it there."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    number = 0
    for x, y, z in water:
        across = (b[:, 0] - a[:, 0]) * (c[:, 2] - a[:, 2]) - (b[:, 2] - a[:, 2]) * (c[:, 0] - a[:, 0])
        v = ((x - a[:, 0]) * (c[:, 2] - a[:, 2]) - (z - a[:, 2]) * (c[:, 0] - a[:, 0])) / across
        w = ((b[:, 0] - a[:, 0]) * (z - a[:, 2]) - (b[:, 2] - a[:, 2]) * (x - a[:, 0])) / across
        over = (v >= 0) & (w >= 0) & (v + w <= 1)
        heights = (a + v[:, None] * (b - a) + w[:, None] * (c - a))[over, 1]
        number += bool(len(heights)) and y < heights.min()
    return number


def leaks(data: dict[str, Any], seconds: float) -> tuple[int, World]:
    """Step for a time [s]; how often a particle went through the cloth, by the checker of `tests.support.passing`, and
    the world at the end."""
    from sim.run.stepping import Run
    from sim.spec import SimulationSpec

    run = Run(SimulationSpec.model_validate(data), Path(), threads=1, arch="cpu", warn=lambda _: None)
    run.start()
    world, time, number = run.world, 0.0, 0
    cloth, water = _points(world)
    while time < seconds:
        dt = min(world.step_limit(world.measure()), 0.01)
        time += dt
        advance(world, dt, time)
        cloth_after, water_after = _points(world)
        both = np.intersect1d(list(water), list(water_after))
        before, after = (
            np.concatenate([sheet, np.array([place[name] for name in both]).reshape(-1, 3)])
            for sheet, place in ((cloth, water), (cloth_after, water_after))
        )
        number += went_through(before, after, world.cloth.mesh.triangles, len(both))
        cloth, water = cloth_after, water_after
    return number, world


def _points(world: World) -> tuple[np.ndarray, dict[int, np.ndarray]]:
    """Of the cloth, and of particles by their identity [m]."""
    state = world.fluid.state()
    places = state.position[:, :3].astype(np.float64) + world.origin
    return world.cloth.mesh.points.position.to_numpy(), dict(zip(state.tag[:, 0].tolist(), places, strict=True))


def water_at(out: Path, frame: int) -> np.ndarray:
    return positions(read_frame(out, frame))
