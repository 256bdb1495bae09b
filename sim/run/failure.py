"""When a step cannot be trusted, and what is said then."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from scene.settings import Refused, given
from sim.run.checkpoint import state_name

if TYPE_CHECKING:
    from sim.fluid.measure import Measure
    from sim.fluid.model import FluidModel
    from sim.fluid.spec import Fluid
    from sim.run.checkpoint import Clock
    from sim.run.world import World

MAX_RETRIES = 4
"""Each repeats the frame with half the step of the one before."""
DENSITY_LIMIT = 1.3
"""Densities above this many rest densities mean that particles were pushed into one another, or into a solid by others:
one that is alone is not, and is put right in a step."""
MOST_STEPS = 50_000
"""A frame that would need more steps than this is refused, or stops the run: it would seem to hang."""
NAMED = 10
"""At most so many particles are named in failure.json."""


@dataclass(frozen=True)
class Fault:
    """What makes a step invalid, and what would help."""

    what: str
    remedy: str
    repeatable: bool = True
    """Whether a smaller step may avoid it."""


class Stopped(Exception):
    """The run cannot go on; the process exits with 3, keeps the last good state and writes `report`."""

    def __init__(self, report: dict[str, Any]):
        super().__init__(report["detected"])
        self.report = report


class Interrupted(BaseException):
    """A signal asked the run to end. No KeyboardInterrupt: Python may die of one even after it was caught."""


def find_fault(world: World, measure: Measure | None, dt: float) -> Fault | None:
    """The first thing wrong after a step, from the counts that one pass over the particles left."""
    if world.rigid and not world.rigid.measure().finite:
        return Fault("a rigid body has values that are not finite", "use a smaller step (rigid.max_step)")
    if world.cloth and not world.cloth.measure().finite:
        return Fault("the cloth has values that are not finite", "use a smaller step (cloth.max_step)")
    if world.cloth and world.cloth.stuck:
        remedy = "use a smaller step (cloth.max_step), slower solids or pins, more room, or a thinner cloth"
        return Fault(f"solids or pins push {world.cloth.stuck} pairs of points or edges through cloth", remedy)
    if world.cloth and world.cloth.unsolved:
        remedy = (
            "use a smaller step (cloth.max_step), a lower stretch_stiffness, or more cloth.implicit_euler.max_newton"
        )
        return Fault("Newton's method for the cloth ended at its cap, far from balanced forces", remedy)
    if world.wet_cloth and world.wet_cloth.tightness.through:
        remedy = "use a smaller step (cloth.max_step), larger particles, or a cloth that folds less"
        return Fault(f"{world.wet_cloth.tightness.through} particles have no way but through the cloth", remedy)
    if measure is None or world.fluid is None or not world.fluid.count:
        return None
    settings, fastest = given(world.spec.fluid), world.fluid.fastest_signal
    fault = _particle_fault(world, settings, fastest, measure) or _fixed_step_fault(world, measure, dt)
    return replace(fault, repeatable=False) if fault and world.spec.step.fixed is not None else fault


def _particle_fault(world: World, fluid: Fluid, fastest: float, measure: Measure) -> Fault | None:
    smaller = _smaller_step(world, fluid)
    if measure.not_finite or not _finite(measure):
        return Fault(f"{measure.not_finite or 'some'} particles have values that are not finite", smaller)
    if measure.crowding_max > DENSITY_LIMIT * fluid.rest_density:
        ratio = measure.crowding_max / fluid.rest_density
        return Fault(f"the density rose to {ratio:.2f} times the rest density", smaller)
    if measure.too_fast:
        return _too_fast(fluid, measure.too_fast, fastest, smaller)
    if measure.beyond_walls:
        return Fault(f"{measure.beyond_walls} particles went through a wall", smaller)
    return None


def _smaller_step(world: World, fluid: Fluid) -> str:
    """What helps where particles were pushed too hard, by the fields of the scene's own solver."""
    from sim.fluid import load_solver

    steps = "step.cfl, or step.maximum" if world.spec.step.fixed is None else "step.fixed, or an adaptive one"
    return ", ".join([f"use a smaller step ({steps})", *_or_last(load_solver(fluid.method).remedies(fluid))])


def _or_last(texts: list[str]) -> list[str]:
    return [*texts[:-1], f"or {texts[-1]}"] if texts else []


def _too_fast(fluid: Fluid, number: int, fastest: float, smaller: str) -> Fault:
    from sim.fluid import load_solver

    solver = load_solver(fluid.method)
    if not solver.WEAKLY_COMPRESSIBLE:
        what = f"{number} particles are faster ({fastest:.3g} m/s) than anything in the scene can make them"
        return Fault(what, smaller)
    what = f"{number} particles are faster than sound ({fastest:.3g} m/s)"
    if not solver.SPEED_OF_SOUND:
        return Fault(what, smaller)
    return Fault(what, f"raise {fluid.solver_path}.{solver.SPEED_OF_SOUND} if such speeds are meant, else {smaller}")


def _finite(measure: Measure) -> bool:
    """Sums and extremes: an optimised comparison on the device may miss what is not a number."""
    numbers = (measure.v_max, measure.a_max, measure.kinetic_energy, measure.density_max, measure.compression_sum)
    return bool(np.isfinite([*numbers, *measure.momentum, *measure.position_sum]).all())


def _fixed_step_fault(world: World, measure: Measure, dt: float) -> Fault | None:
    fixed = world.spec.step.fixed
    limit = world.step_limit(measure)
    if fixed is not None and dt >= fixed > FIXED_MARGIN * limit:
        return Fault(
            f"the fixed step of {fixed:.3g} s is beyond the stability limit of {limit:.3g} s",
            f"use step.fixed below {limit:.2g} s, or leave it out for an adaptive step",
        )
    return None


FIXED_MARGIN = 2.5
"""A fixed step may pass the limit of an instant's peak force, but not the true limit of the integrator."""


def beyond_limit(fixed: float, limit: float) -> Refused:
    """The refusal of a fixed step [s] that is longer than one may be [s]."""
    return Refused(
        f"a fixed step of {fixed:.3g} s is beyond the stability limit of {limit:.3g} s",
        location=("step", "fixed"),
        remedy="use a shorter step, or leave it out for an adaptive one",
    )


def short_step(world: World, measure: Measure | None, limit: float, fps: float) -> Fault | None:
    """The fault of a step `limit` [s] under the shortest step that a frame is worth."""
    if world.spec.step.fixed is not None:
        return None
    shortest = 1.0 / (fps * MOST_STEPS)
    if limit >= shortest:
        return None
    term, remedy = world.limiting_term(measure)
    return Fault(
        f"{term} allows steps of {limit:.3g} s only, so that a frame would need {1 / (fps * limit):,.0f} of them "
        f"(at most {MOST_STEPS:,})",
        f"{remedy}, or more frames per second",
        repeatable=False,
    )


def report(world: World, clock: Clock, fault: Fault, good: Clock | None, retries: int) -> dict[str, Any]:
    """Contents of failure.json: what, when, which particles, the last good state, and what to change.

    `good` is None where not even the first frame could be written.
    """
    return {
        "detected": fault.what,
        "step": clock.step,
        "time": clock.time,
        "retries": retries,
        "particles": _suspects(world, world.fluid) if world.fluid else [],
        "last_good_frame": good.frame if good else None,
        "last_good_state": state_name(good.frame) if good else None,
        "change": fault.remedy,
    }


def _suspects(world: World, fluid: FluidModel) -> list[dict[str, Any]]:
    """The particles that stand out most, by identity; values that are not finite are given as text."""
    state = fluid.state()
    speed = np.linalg.norm(state.velocity[:, :3], axis=1)
    density = state.velocity[:, 3] / fluid.system.spec.rest_density
    positions = state.position[:, :3].astype(np.float64) + world.origin
    depths = (wall.offset - positions @ wall.normal for wall in world.obstacles.walls)
    depth = np.max([np.zeros(state.count), *depths], axis=0)
    limits = (density / DENSITY_LIMIT, speed / fluid.fastest_signal, 2 * depth / fluid.system.h)
    badness = np.nan_to_num(np.maximum.reduce(limits), nan=np.inf, posinf=np.inf)
    suspects = []
    for i in np.argsort(-badness, kind="stable")[:NAMED]:
        suspects.append(
            {
                "id": int(state.tag[i, 0]),
                "position": [_number(value) for value in positions[i]],
                "speed": _number(speed[i]),
                "density_ratio": _number(density[i]),
            }
        )
    return suspects


def _number(value: float) -> float | str:
    return float(value) if np.isfinite(value) else str(value)
