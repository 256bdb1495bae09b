"""Rigid bodies of a scene, stepped without files: what tests of their physics share."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from sim.rigid.model import RigidModel

G = 9.81


def box(size: tuple[float, float, float], **body: Any) -> dict[str, Any]:
    return {"motion": "dynamic", "shape": {"type": "box", "size": size}, **body}


def ball(radius: float, **body: Any) -> dict[str, Any]:
    return {"motion": "dynamic", "shape": {"type": "sphere", "radius": radius}, **body}


def ground(slope: float = 0.0, **surface: Any) -> dict[str, Any]:
    """A plane through the origin that falls towards +x by `slope` [rad]."""
    return {"shape": {"type": "plane", "normal": [np.sin(slope), np.cos(slope), 0]}, **surface}


def turn(axis: tuple[float, float, float], radians: float) -> list[dict[str, Any]]:
    return [{"axis": axis, "angle": float(np.degrees(radians))}]


def part(
    bodies: dict[str, Any], *, gravity: tuple[float, float, float] = (0, -G, 0), threads: int = 1, **rigid: Any
) -> RigidModel:
    """The bodies, in the order given but for planes, which come last."""
    from sim.device import runtime

    runtime.start(threads=threads, arch="cpu", serial=threads == 1)
    from sim.bodies.obstacles import find_obstacles
    from sim.rigid.assemble import assemble
    from sim.rigid.body import RigidState
    from sim.rigid.model import RigidModel
    from sim.spec import SimulationSpec

    spec = SimulationSpec.model_validate({"gravity": gravity, "fps": 24, "rigid": {"bodies": bodies, **rigid}})
    made = assemble(spec, find_obstacles(spec, Path("/")))
    return RigidModel(made, np.array(gravity), spec.rigid, RigidState())


def bounces(part: RigidModel, seconds: float, below: float) -> list[float]:
    """How high [m] the first body's lowest point, `below` [m] its centre, comes after each time that it has met
    something, in a time [s]."""
    tops, before = [], [0.0, -1.0]

    def look(time: float) -> None:
        height, speed = part.position[0, 1], part.velocity[0, 1]
        if before[1] > 0 >= speed:
            tops.append(max(height, before[0]) - below)
        before[:] = height, speed

    step(part, seconds, look)
    return tops


def step(part: RigidModel, seconds: float, each: Callable[[float], None] | None = None, dt: float | None = None) -> int:
    """Step for a time [s], by `dt` [s] or as long as limits allow; calls `each` with the time; returns the number."""
    time, steps = 0.0, 0
    while time < seconds - 1e-12:
        longest = dt or min(part.step_limits(part.measure()).values())
        now = min(longest, seconds - time)
        part.advance(now, {})
        time += now
        steps += 1
        if each:
            each(time)
    return steps


def tilt(part: RigidModel, index: int = 0) -> float:
    """The angle [rad] between a body's own y axis and the vertical."""
    axis = part.movement(index).rotation @ part.bodies[index].shape.turn @ np.array([0.0, 1.0, 0.0])
    return float(np.arccos(np.clip(axis[1], -1, 1)))
