"""Three scenes of rigid bodies for two engines, ours and MuJoCo: what is in them, and what is measured.

Nothing bounces in them (restitution 0), since MuJoCo has no coefficient of it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter, process_time
from typing import Any, Protocol

import numpy as np

from tests.support.bodies import G, ball, box, ground, part, turn
from tests.validation.domino_wave import Row

RADIUS = 0.1
ROLLING, SLIDING = (np.radians(20), 0.5), (np.radians(40), 0.12)
"""Slope [rad] and friction. A ball rolls if friction is at least 2/7 tan(slope): 0.10 and 0.24."""
ROLLS = 2.0
"""Time on the slope [s]."""

ROW = Row(number=20, height=0.4, thickness=0.05, pitch=0.16, friction=0.3)
WIDTH = 0.2
GRIP = 1.5
"""Friction of dominoes and ground: what strikes them above 2/3 of their height kicks their feet back."""
START = float(np.radians(10))
"""Tilt of the first domino; its balance is at 7.1 degrees."""
SEEN = float(np.radians(2))
"""The tilt at which a domino counts as struck."""
FALLS = 2.2
STEADY = 9
"""From this domino on the wave is within 5 % of its final speed."""

EDGE = 0.1
ACROSS = 5
"""Boxes along each side of the block that becomes a pile."""
APART = 0.18
"""From centre to centre: as they are turned in all directions, their diagonals of 0.173 must pass [m]."""
PILES = 12
"""With so many, three standard errors of the difference in mean height are about 14 % of it, in radius 6 %."""
SETTLES = 4.0
REST = 0.01
"""What is slower is at rest [m/s]: a box that falls by a hundredth of its edge is faster by far, at 0.14 m/s."""


class Engine(Protocol):
    @property
    def places(self) -> np.ndarray: ...
    @property
    def turns(self) -> np.ndarray: ...
    @property
    def velocities(self) -> np.ndarray: ...
    @property
    def kinetic_energy(self) -> float: ...
    @property
    def overlap(self) -> float: ...
    def advance(self, left: float) -> float: ...


@dataclass(frozen=True)
class Scene:
    """Bodies with a plane as the last of them, and the friction of that plane and any other body."""

    bodies: dict[str, Any]
    floor_friction: float


def scene(bodies: dict[str, Any], friction: float, floor_friction: float, slope: float = 0.0) -> Scene:
    """With `friction` of any two bodies; ours takes the geometric mean of two surfaces."""
    every = {name: {**body, "friction": friction, "restitution": 0.0} for name, body in bodies.items()}
    plane = ground(slope, friction=floor_friction**2 / friction, restitution=0.0)
    return Scene({**every, "ground": plane}, floor_friction)


def incline(slope: float, friction: float) -> Scene:
    """A ball that touches the slope."""
    place = [RADIUS * np.sin(slope), RADIUS * np.cos(slope), 0]
    return scene({"ball": ball(RADIUS, position=place)}, friction, friction, slope)


def dominoes() -> Scene:
    """The first tilted about its lower edge; along x, at x = 0 the edge about which the first turns."""
    row, bodies = ROW, {}
    for k in range(row.number):
        tilt = START if k == 0 else 0.0
        middle = np.array([row.height * np.sin(tilt) - row.thickness * np.cos(tilt), 0, 0]) / 2
        middle[1] = (row.thickness * np.sin(tilt) + row.height * np.cos(tilt)) / 2
        place = list(middle + np.array([k * row.pitch, 0, 0]))
        bodies[f"domino{k}"] = box((row.thickness, row.height, WIDTH), position=place, rotation=turn((0, 0, 1), -tilt))
    return scene(bodies, row.friction, GRIP)


def pile(seed: int) -> Scene:
    """A block of boxes, each turned at random, that falls in on itself."""
    random = np.random.default_rng(seed)
    bodies = {}
    for k in range(ACROSS**3):
        cell = np.array([k % ACROSS, k // ACROSS**2, k // ACROSS % ACROSS])
        place = APART * cell + [0, EDGE, 0] + random.uniform(-0.003, 0.003, 3)
        rotation = turn(tuple(random.normal(size=3)), random.uniform(0, np.pi))
        bodies[f"box{k}"] = box((EDGE,) * 3, position=list(place), rotation=rotation)
    return scene(bodies, 0.5, 0.5)


class Tidemill:
    """Ours, by steps as long as its limits allow."""

    def __init__(self, scene: Scene, *, threads: int = 2, **rigid: float):
        self.part = part(scene.bodies, threads=threads, **rigid)
        self._dynamic = self.part.dynamic

    def advance(self, left: float) -> float:
        dt = min(left, *self.part.step_limits(self.part.measure()).values())
        self.part.advance(dt, {})
        return dt

    @property
    def places(self) -> np.ndarray:
        return self.part.position[self._dynamic]

    @property
    def turns(self) -> np.ndarray:
        return self.part.rotation[self._dynamic]

    @property
    def velocities(self) -> np.ndarray:
        return self.part.velocity[self._dynamic]

    @property
    def kinetic_energy(self) -> float:
        return self.part.measure().kinetic_energy

    @property
    def overlap(self) -> float:
        return max(0.0, self.part.stats.get("overlap", 0.0))


def mujoco(scene: Scene, *, threads: int = 2, timestep: float = 1e-3) -> Engine:
    """The same bodies in MuJoCo, which is needed here only; `threads` are those of ours, which places them."""
    from tests.support.mujoco_bodies import MuJoCo

    return MuJoCo(scene.bodies, part(scene.bodies, threads=threads), scene.floor_friction, timestep)


def run(engine: Engine, seconds: float, look: Callable[[float], None] = lambda time: None) -> np.ndarray:
    """Step for a time [s], calling `look` with the time after each step; returns what the steps alone cost."""
    time, cost = 0.0, np.zeros(2)
    while time < seconds - 1e-9:
        begun = perf_counter(), process_time()
        time += engine.advance(seconds - time)
        cost += perf_counter() - begun[0], process_time() - begun[1]
        look(time)
    return cost


@dataclass(frozen=True)
class Found:
    """Quantities by name, wall and processor time of the steps [s], and a curve for a picture."""

    values: dict[str, float]
    cost: np.ndarray
    times: np.ndarray
    curve: np.ndarray


def way(slope: float, friction: float, time: Any) -> Any:
    """Down the slope, of a ball that starts at rest [m]."""
    rolls = friction >= 2 / 7 * np.tan(slope)
    pull = 5 / 7 * np.sin(slope) if rolls else np.sin(slope) - friction * np.cos(slope)
    return G * pull * np.square(time) / 2


def descend(engine: Engine, slope: float) -> Found:
    """The ball's way down the slope [m]."""
    down = np.array([np.cos(slope), -np.sin(slope), 0])
    start, times, ways = engine.places[0], [0.0], [0.0]

    def look(time: float) -> None:
        times.append(time)
        ways.append(float((engine.places[0] - start) @ down))

    cost = run(engine, ROLLS, look)
    return Found({"way": ways[-1]}, cost, np.array(times), np.array(ways))


def fall(engine: Engine) -> Found:
    """When each domino but the first is struck [s]; the speed of the wave where it is even [m/s], and the last time."""
    times, tilts, overlaps = [0.0], [_tilts(engine.turns)], [0.0]

    def look(time: float) -> None:
        times.append(time)
        tilts.append(_tilts(engine.turns))
        overlaps.append(engine.overlap)

    cost = run(engine, FALLS, look)
    moments, history = np.array(times), np.array(tilts)[:, 1:]
    struck = np.argmax(history > SEEN, axis=0)
    arrivals = [np.interp(SEEN, history[k - 1 : k + 1, n], moments[k - 1 : k + 1]) for n, k in enumerate(struck)]
    values = {**wave(np.array(arrivals)), "overlap": max(overlaps)}
    return Found(values, cost, np.arange(1, ROW.number), np.array(arrivals))


def wave(arrivals: np.ndarray) -> dict[str, float]:
    """Arrivals are of the second domino and those that follow."""
    steady = arrivals[STEADY - 1 :]
    return {"speed": ROW.pitch * (len(steady) - 1) / float(steady[-1] - steady[0]), "last": float(arrivals[-1])}


def _tilts(turns: np.ndarray) -> np.ndarray:
    """Of the boxes' own y axes, from the vertical [rad]."""
    return np.arccos(np.clip(1 - 2 * (turns[:, 1] ** 2 + turns[:, 3] ** 2), -1, 1))


def settle(engine: Engine) -> Found:
    """Of the heap: mean height, radius (r.m.s. from its own middle), boxes at rest, energies and overlap.

    Drift is how fast the boxes at rest move on the average over the last half second [m/s].
    """
    times, heights, overlaps = [0.0], [float(engine.places[:, 1].mean())], [0.0]

    def look(time: float) -> None:
        times.append(time)
        heights.append(float(engine.places[:, 1].mean()))
        overlaps.append(engine.overlap)

    cost = run(engine, SETTLES - 0.5, look)
    before = engine.places.copy()
    cost += run(engine, 0.5, lambda time: look(SETTLES - 0.5 + time))
    places, resting = engine.places, np.linalg.norm(engine.velocities, axis=1) < REST
    around = (places - places.mean(axis=0))[:, [0, 2]]
    mass = 1000.0 * EDGE**3
    values = {
        "height": heights[-1],
        "radius": float(np.sqrt((around**2).sum(axis=1).mean())),
        "resting": float(resting.mean()),
        "energy": engine.kinetic_energy / (len(places) * mass * G * heights[0]),
        "drift": float(np.median(np.linalg.norm(places - before, axis=1)[resting])) / 0.5,
        "overlap": engine.overlap,
        "deepest": max(overlaps),
    }
    return Found(values, cost, np.array(times), np.array(heights))


def apart(ours: np.ndarray, theirs: np.ndarray) -> tuple[float, float]:
    """The difference of the means of two samples, and three of its standard errors."""
    error = np.sqrt(ours.var(ddof=1) / len(ours) + theirs.var(ddof=1) / len(theirs))
    return float(ours.mean() - theirs.mean()), float(3 * error)
