"""How far settings can go before a simulation breaks, by bisection, beside what theory says.

    python -m tests.stress.limits [NAME ...]

prints a Markdown table. Limits are looked for between bounds in powers, to 5 %.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sim.spec import CFL
from tests.support import bodies, cloths
from tests.support.floating import EDGE, box_in_pool, track
from tests.support.particles import read_table

PRECISION = 1.05
ASIDE = (0.0, 1.1e-3, 2.3e-3, 3.7e-3, 4.9e-3)
"""Where balls begin, off the first [m]."""


@dataclass(frozen=True)
class Limit:
    """A value that `stable` holds for up to somewhere, or from somewhere where `least`; bounds of where to look."""

    about: str
    setting: str
    default: float
    stable: Callable[[float], bool]
    bounds: tuple[float, float]
    theory: float | None = None
    source: str = ""
    least: bool = False

    def find(self) -> tuple[float, bool]:
        """The last stable value, and whether it is that of the bounds: nothing broke."""
        safe, broken = self.bounds if not self.least else self.bounds[::-1]
        assert self.stable(safe), f"{self.about}: {safe:g} is not stable"
        if self.stable(broken):
            return broken, True
        while max(safe, broken) / min(safe, broken) > PRECISION:
            middle = float(np.sqrt(safe * broken))
            safe, broken = (middle, broken) if self.stable(middle) else (safe, middle)
        return safe, False

    def room(self, found: float) -> float:
        """How many times the default is away from what was found."""
        return self.default / found if self.least else found / self.default


def _simulated(data: dict[str, Any], last: int, **unchecked: float) -> tuple[int, Path]:
    """Exit status and folder of a run, whose `step` has settings that a scene may not."""
    from scene.settings import Refused
    from sim.segment import simulate
    from sim.spec import SimulationSpec

    spec = SimulationSpec.model_validate(data)
    spec = spec.model_copy(update={"step": spec.step.model_copy(update=unchecked)})
    out = Path(tempfile.mkdtemp())
    try:
        return simulate(spec, out, out, first=0, last=last, arch="cpu", threads=1, quiet=True), out
    except Refused:
        return 2, out


def _water(solver: str, fps: float, size: list[float], water: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {
        "fps": fps,
        "containers": {"tank": {"type": "box", "size": size}},
        "fluid": {"solver": solver, "particle_radius": 0.01, "bodies": {"water": water}},
    } | more


def _up_to(data: dict[str, Any], last: int, calm: Callable[[np.ndarray], bool]) -> Callable[[float], bool]:
    """Whether, with a CFL number, a scene ends, its steps are calm, and nothing has to be repeated."""

    def stable(cfl: float) -> bool:
        status, out = _simulated(data, last, cfl=cfl)
        return status == 0 and calm(read_table(out / "steps.csv")) and not _retried(out)

    return stable


def _basin(solver: str) -> Callable[[float], bool]:
    """A column of water breaks in a box, where sound bounds the step: energy does not grow."""

    def calm(steps: np.ndarray) -> bool:
        energy = steps["kinetic_energy"] + steps["potential_energy"]
        drop = energy[0] - steps["potential_energy"].min()
        return bool(energy.max() <= energy[0] + 0.02 * drop)

    column = {"shape": {"type": "box", "size": [0.2, 0.3, 0.2]}, "position": [-0.1, 0.15, 0]}
    return _up_to(_water(solver, 50, [0.4, 0.6, 0.2], column), 25, calm)


def _thrown(solver: str) -> Callable[[float], bool]:
    """Balls of water that are thrown through a box, one after the other, without gravity, so that their speed alone
    bounds the step: they get no faster as a whole. Where one alone breaks, its particles' places in a blow decide."""

    def calm(steps: np.ndarray) -> bool:
        energy = steps["kinetic_energy"]
        return bool(energy.max() <= 1.02 * energy[0])

    def ball(aside: float) -> dict[str, Any]:
        place = [-0.08 + aside, 0.3, aside / 3]
        return {"shape": {"type": "sphere", "radius": 0.1}, "position": place, "velocity": [5, 0, 0]}

    thrown = [_up_to(_water(solver, 10, [0.4, 0.6, 0.4], ball(aside), gravity=[0, 0, 0]), 5, calm) for aside in ASIDE]
    return lambda cfl: all(stable(cfl) for stable in thrown)


def _retried(out: Path) -> bool:
    from workflow.stages.film.summaries import read

    return read(out)["counts"]["retries"] > 0


def _sheet() -> Any:
    """Free, hardly strained, without damping."""
    made = cloths.part(
        {"sheet": cloths.sheet((0.3, 0.3), spacing=0.05, stretch_stiffness=100, bend_stiffness=1e-4, damping=0)},
        integrator="symplectic_euler",
        gravity=(0, 0, 0),
    )
    x = cloths.places(made)
    noise = np.random.default_rng(1).normal(size=x.shape)
    cloths.set_motion(made, position=x + 1e-7 * noise)
    return made


def _strain(made: Any) -> float:
    measure = made.measure()
    return measure.kinetic_energy + measure.elastic_energy


def _symplectic(share: float) -> bool:
    """The energy of small vibrations stays within a hundred times what it is at first."""
    from sim.cloth.integrators.symplectic_euler import longest_step

    made = _sheet()
    dt = share * longest_step(made.mesh)
    made.integrator.stable = dt
    before = _strain(made)
    cloths.step(made, 400 * dt, dt)
    return bool(np.isfinite(_strain(made)) and _strain(made) < 100 * before)


def _highest_frequency() -> float:
    """2 / w over the bound of Gershgorin, w^2 the greatest eigenvalue of M^-1 K, by differences of forces."""
    from sim.cloth.integrators.symplectic_euler import longest_step

    made = _sheet()
    mesh = made.mesh
    x0 = mesh.placed[: mesh.count].copy()
    ends, stiffness = mesh.ends, mesh.stiffness
    size = 3 * mesh.count
    matrix = np.zeros((size, size))
    d = x0[ends[:, 1]] - x0[ends[:, 0]]
    n = d / np.linalg.norm(d, axis=1, keepdims=True)
    for (i, j), k, along in zip(ends, stiffness, n, strict=True):
        block = k * np.outer(along, along)
        for a, b, sign in ((i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)):
            matrix[3 * a : 3 * a + 3, 3 * b : 3 * b + 3] += sign * block
    weight = np.repeat(1 / np.sqrt(mesh.mass), 3)
    greatest = np.linalg.eigvalsh(weight[:, None] * matrix * weight).max()
    return 2 / np.sqrt(greatest) / longest_step(mesh)


def _tower(step: float) -> bool:
    """Five boxes on one another stand for two seconds."""
    boxes = {f"box{k}": bodies.box((0.2, 0.2, 0.2), position=[0, 0.1 + 0.2 * k, 0]) for k in range(5)}
    made = bodies.part({"floor": bodies.ground()} | boxes)
    bodies.step(made, 2.0, dt=step)
    return bool(np.abs(made.position[:, 0]).max() < 0.02 and made.position[:, 1].max() > 0.88)


def _heavy(ratio: float) -> bool:
    """A box of so many times its mass lies on a box for two seconds, and sinks by less than a hundredth of it."""
    low = bodies.box((0.2, 0.2, 0.2), position=[0, 0.1, 0], density=1000)
    high = bodies.box((0.2, 0.2, 0.2), position=[0, 0.3, 0], density=1000 * ratio)
    made = bodies.part({"floor": bodies.ground(), "low": low, "high": high})
    bodies.step(made, 2.0)
    return bool(np.abs(made.position[:, 1].max() - 0.3) < 0.002 and np.abs(made.position[:, 0]).max() < 0.02)


def _light(ratio: float) -> bool:
    """A box that much lighter than water comes up, never leaps out, and after 0.7 s bobs by less than half of its
    height about where Archimedes has it."""
    status, out = _simulated(box_in_pool("dfsph", ratio), 45)
    if status or _retried(out):
        return False
    height = track(out, "y")
    level = 0.3 + ratio * EDGE**3 / 0.4**2
    afloat = level + (0.5 - ratio) * EDGE
    return bool(np.abs(height[-10:] - afloat).max() < EDGE / 2 and height.max() < level + 2 * EDGE)


def limits() -> dict[str, Limit]:
    courant = "Courant, Friedrichs and Lewy 1928: half the support in a step"
    return {
        "wcsph": Limit("CFL number, WCSPH", "step.cfl", 0.4, _basin("wcsph"), (0.2, 6.4), 1.0, courant),
        "iisph": Limit("CFL number, IISPH", "step.cfl", CFL["iisph"], _thrown("iisph"), (0.2, 6.4), 1.0, courant),
        "pcisph": Limit("CFL number, PCISPH", "step.cfl", 0.4, _thrown("pcisph"), (0.2, 6.4), 1.0, courant),
        "dfsph": Limit("CFL number, DFSPH", "step.cfl", CFL["dfsph"], _thrown("dfsph"), (0.2, 6.4), 1.0, courant),
        "symplectic": Limit(
            "step of symplectic Euler over Gershgorin's bound",
            "cloth.symplectic_euler.share",
            0.69,
            _symplectic,
            (0.3, 4.0),
            _highest_frequency(),
            "2 / w, w the highest frequency of the sheet's matrix",
        ),
        "tower": Limit("step with which five boxes stand [s]", "rigid.max_step", 0.004, _tower, (0.002, 0.25)),
        "heavy": Limit("mass of a box on a box", "rigid.bodies.NAME.density", 1.0, _heavy, (1.0, 1e3)),
        "light": Limit(
            "density of a body over water", "rigid.bodies.NAME.density", 1.0, _light, (1e-4, 0.5), least=True
        ),
    }


def rows(names: Sequence[str]) -> list[str]:
    found = ["| what | setting | default | breaks beyond | theory | room |", "| --- | --- | --- | --- | --- | --- |"]
    for name, limit in limits().items():
        if names and name not in names:
            continue
        value, open_end = limit.find()
        theory = f"{limit.theory:.3g} ({limit.source})" if limit.theory else ""
        mark = "not up to " if open_end and not limit.least else "not down to " if open_end else ""
        found.append(
            f"| {limit.about} | `{limit.setting}` | {limit.default:g} | {mark}{value:.3g} | {theory} "
            f"| {limit.room(value):.3g} |"
        )
        print(found[-1], file=sys.stderr, flush=True)
    return found


if __name__ == "__main__":
    print("\n".join(rows(sys.argv[1:])))
