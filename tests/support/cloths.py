"""Cloth of a scene, stepped without files: what tests of its physics share."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tests.support.passing import passed
from tests.support.stepping import advance

if TYPE_CHECKING:
    from sim.cloth.model import ClothModel

G = 9.81
INTEGRATORS = ("implicit_euler", "symplectic_euler", "xpbd")
HANGING = [{"axis": [0, 0, 1], "angle": -90}]
"""Turns a sheet so that its left side is on top."""


def sheet(size: tuple[float, float], **settings: Any) -> dict[str, Any]:
    return {"shape": {"type": "sheet", "size": size}, **settings}


def rope(length: float, cells: int, **settings: Any) -> dict[str, Any]:
    """A strip one cell wide that resists neither shear nor bending: two ropes side by side, each of half its width."""
    edge = length / cells
    return sheet((length, edge), spacing=edge, shear_stiffness=0, bend_stiffness=0, **settings)


def part(
    sheets: dict[str, Any], *, gravity: tuple[float, float, float] = (0, -G, 0), threads: int = 1, **cloth: Any
) -> ClothModel:
    """The sheets of a scene as placed; `cloth` are the settings beside them."""
    from sim.device import runtime

    runtime.start(threads=threads, arch="cpu", serial=threads == 1)
    from sim.cloth.fabric.state import ClothState
    from sim.cloth.model import ClothModel, find_sheets
    from sim.cloth.spec import Cloth

    settings = Cloth.model_validate({"sheets": sheets, **cloth})
    return ClothModel(find_sheets(settings, Path("/")), np.array(gravity), settings, ClothState(), 0.0)


def step(part: ClothModel, seconds: float, dt: float, each: Callable[[float], None] | None = None) -> None:
    """Step for a time [s] by dt [s]; calls `each` with the time after each step."""
    for k in range(1, round(seconds / dt) + 1):
        part.advance(dt, k * dt)
        if each:
            each(k * dt)


def places(part: ClothModel, name: str | None = None) -> np.ndarray:
    """Positions of the points of a sheet, or of the first [m], shape [n, 3]."""
    return part.vertices(name or part.sheets[0].name)[0]


def set_motion(part: ClothModel, *, position: np.ndarray | None = None, velocity: np.ndarray | None = None) -> None:
    """Put all points elsewhere [m], or let them move [m/s], shape [n, 3]."""
    if position is not None:
        part.mesh.points.position.from_numpy(np.ascontiguousarray(position, dtype=np.float64))
        part.mesh.place.from_numpy(np.ascontiguousarray(position, dtype=np.float64))
    if velocity is not None:
        part.mesh.points.velocity.from_numpy(np.ascontiguousarray(velocity, dtype=np.float64))


def period(times: np.ndarray, values: np.ndarray) -> float:
    """Mean time between upward crossings of zero, each found by a straight line [s]."""
    up = np.flatnonzero((values[:-1] < 0) & (values[1:] >= 0))
    crossings = times[up] - values[up] * (times[up + 1] - times[up]) / (values[up + 1] - values[up])
    return float(np.diff(crossings).mean())


def scene(sheets: dict[str, Any], bodies: dict[str, Any], **settings: Any):
    """The world of a scene with cloth and rigid bodies."""
    from sim.device import runtime
    from sim.run.reporting.counts import Counts
    from sim.run.world import World
    from sim.spec import SimulationSpec

    runtime.start(threads=1, arch="cpu", serial=True)
    cloth = {"sheets": sheets, **settings.pop("cloth", {})}
    spec = SimulationSpec.model_validate({"fps": 24, "rigid": {"bodies": bodies}, "cloth": cloth, **settings})
    world = World(spec, Path("/"))
    world.build(None, {}, Counts(), print, 0.0, going_on=False)
    return world


def passages(world, seconds: float, dt: float) -> int:
    """Step for a time [s]; returns how many pairs met on the way, by the checker of `tests.support.passing`."""
    mesh = world.cloth.mesh
    triangles = np.concatenate([mesh.triangles, world.cloth.solids.triangles + mesh.count])
    moving = np.arange(mesh.total) < mesh.count
    before, total = mesh.points.position.to_numpy(), 0
    for k in range(1, round(seconds / dt) + 1):
        advance(world, dt, k * dt)
        after = mesh.points.position.to_numpy()
        total += passed(before, after, triangles, moving)
        before = after
    return total


def passages_in_a_run(spec: dict[str, Any], folder: Path, frames: int) -> tuple[int, int]:
    """Run a scene of cloth alone up to a frame, in a folder; returns how many pairs met on the way, by the checker of
    `tests.support.passing`, and the last frame that was good, which is an earlier one where the run stops. What was
    taken back, since the run repeated the frame, does not count.
    """
    from sim.run.failure import Stopped
    from sim.run.output import Output
    from sim.run.stepping import Run
    from sim.spec import SimulationSpec

    settings = SimulationSpec.model_validate(spec)
    run = Run(settings, folder, threads=1, arch="cpu", warn=lambda _: None)
    run.start()
    mesh = run.world.cloth.mesh
    before, time, here, total = mesh.points.position.to_numpy(), 0.0, 0, 0

    def look() -> None:
        nonlocal before, time, here
        after = run.world.cloth.mesh.points.position.to_numpy()
        if run.clock.time > time:
            here += passed(before, after, mesh.triangles)
        elif run.clock.time < time:
            here = 0
        before, time = after, run.clock.time

    def done() -> None:
        nonlocal here, total
        look()
        total, here = total + here, 0

    run.before_step = look
    with contextlib.suppress(Stopped):
        run.frames(frames, Output(folder, settings), write_first=True, done=done)
    return total, run.last_good.clock.frame


def energy(world: Any) -> float:
    """Of bodies and cloth [J]."""
    cloth = world.cloth.measure()
    found = cloth.kinetic_energy + cloth.potential_energy + cloth.elastic_energy
    if world.rigid:
        rigid = world.rigid.measure()
        found += rigid.kinetic_energy + rigid.potential_energy
    return found


def extremes(world: Any, seconds: float, dt: float) -> tuple[float, float, float]:
    """The least energy in a time [s], that of the start, and the greatest [J]."""
    least = most = first = energy(world)
    for k in range(1, round(seconds / dt) + 1):
        advance(world, dt, k * dt)
        found = energy(world)
        assert np.isfinite(found)
        least, most = min(least, found), max(most, found)
    return least, first, most
