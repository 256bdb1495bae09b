"""What is refused of the first step: by a run, and by a check, as far as it is known before anything is built."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from scene.settings import Refused, given
from sim.run.failure import FIXED_MARGIN, MOST_STEPS, beyond_limit, find_fault, short_step
from sim.run.placing.placed_scene import PlacedScene
from sim.spec import SimulationSpec

if TYPE_CHECKING:
    from sim.cloth.model import PlacedSheet
    from sim.cloth.spec import Cloth
    from sim.fluid.measure import Measure
    from sim.fluid.spec import Fluid
    from sim.run.world import World

Limits = dict[str, float]
"""Largest steps [s] by what limits them."""


def refuse_steps(placed: PlacedScene, velocity: np.ndarray) -> None:
    """Raise Refused for steps that a run would refuse at its start; velocity: of the particles [m/s], shape [n, 3].

    Forces on particles may limit steps further.
    """
    fastest = float(np.linalg.norm(velocity, axis=1).max(initial=0.0))
    fluid, step = placed.spec.fluid, placed.spec.step
    if fluid is not None:
        _refuse_sound(fluid, fastest)
    if placed.sheets and placed.spec.cloth is not None:
        refuse_cloth_steps(placed.spec, placed.spec.cloth, _explicit_step(placed, placed.spec.cloth))
        for item in placed.sheets:
            refuse_jumps(item, 0.0)
    limits = _of_bodies(placed) | (_of_fluid(placed, fluid, fastest) if fluid is not None and len(velocity) else {})
    if not limits:
        return
    term, limit = min(limits.items(), key=lambda item: item[1])
    if step.fixed is not None and step.fixed > FIXED_MARGIN * limit:
        raise beyond_limit(step.fixed, FIXED_MARGIN * limit)
    if step.fixed is None and limit < 1.0 / (placed.spec.fps * MOST_STEPS):
        raise Refused(
            f"{term} allows steps of {limit:.3g} s only, so that a frame would need "
            f"{1 / (placed.spec.fps * limit):,.0f} of them (at most {MOST_STEPS:,})",
            remedy="use lower speeds, larger particles or bodies, or more frames per second",
        )


def refuse_beginning(world: World, measure: Measure | None, fps: float) -> None:
    """Raise Refused where the state that a run begins with is at fault, or its steps would be too short or too long."""
    fault = find_fault(world, measure, 0.0)
    if fault is not None:
        raise Refused(fault.what, remedy="check speeds, densities and sizes of the scene")
    if world.cloth:
        stable = getattr(world.cloth.integrator, "stable", math.inf)
        refuse_cloth_steps(world.spec, world.cloth.settings, stable)
    limit = world.step_limit(measure)
    short = short_step(world, measure, limit, fps)
    if short is not None:
        raise Refused(short.what, remedy=short.remedy)
    fixed = world.spec.step.fixed
    if fixed is not None and fixed > FIXED_MARGIN * limit:
        raise beyond_limit(fixed, FIXED_MARGIN * limit)


def _refuse_sound(fluid: Fluid, fastest: float) -> None:
    """Raise Refused where the fluid begins faster [m/s] than the speed of sound that the scene gives."""
    from sim.fluid import load_solver

    solver = load_solver(fluid.method)
    sound = solver.speed_of_sound_given(fluid)
    if sound is not None and fastest > sound:
        raise Refused(
            f"the fluid begins at {fastest:.3g} m/s, faster than sound ({sound:.3g} m/s)",
            location=(*fluid.solver_path.split("."), solver.SPEED_OF_SOUND),
            remedy="raise it to ten times the greatest speed, leave it out, or let the fluid begin more slowly",
        )


def refuse_cloth_steps(spec: SimulationSpec, cloth: Cloth, stable: float = math.inf) -> None:
    """Raise Refused for steps longer than cloth may take, and for cloth that would need too many explicit ones, of
    `stable` [s] at most, in each."""
    step, most = spec.step, cloth.max_step
    if step.fixed is not None and step.fixed > most:
        raise Refused(
            f"a fixed step of {step.fixed:.3g} s is longer than those of cloth may be ({most:.3g} s)",
            location=("step", "fixed"),
            remedy="use a shorter one, or raise cloth.max_step",
        )
    if stable == math.inf:
        return
    from sim.cloth.integrators.symplectic_euler import MOST_SUBSTEPS

    longest = min(step.fixed or most, step.maximum or most, 1.0 / spec.fps)
    if longest > stable * MOST_SUBSTEPS:
        raise Refused(
            f"the stiffness of the cloth allows explicit steps of {stable:.2g} s only, so that a step of "
            f"{longest:.3g} s would need {longest / stable:,.0f} of them (at most {MOST_SUBSTEPS:,})",
            location=("cloth", "integrator"),
            remedy="use implicit_euler, a lower stretch_stiffness or bend_stiffness, a larger spacing, "
            "or a shorter cloth.max_step",
        )


def _explicit_step(placed: PlacedScene, settings: Cloth) -> float:
    """The longest explicit step of the cloth [s]; infinite where it takes none."""
    from sim.cloth import load_integrator
    from sim.cloth.fabric.mesh import Elastic
    from sim.cloth.model import shells_of

    stable_step = getattr(load_integrator(settings.integrator, settings.model), "stable_step", None)
    if stable_step is None:
        return math.inf
    held = np.concatenate([item.held for item in placed.sheets])
    sheets, fabrics = [item.sheet for item in placed.sheets], [item.fabric for item in placed.sheets]
    mesh = Elastic(sheets, fabrics, held, shells=shells_of(placed.sheets))
    return stable_step(mesh, settings)


def refuse_jumps(item: PlacedSheet, time: float) -> None:
    """Raise Refused where pins take a sheet that begins at `time` [s] elsewhere at once."""
    from sim.cloth.fabric.pins import refuse_jump

    size = float(np.ptp(item.fabric.points, axis=0).max())
    for part in item.pinned:
        refuse_jump(item.name, part, item.begins[part.points], size, time)


def _of_bodies(placed: PlacedScene) -> Limits:
    """Of bodies that obey forces, as they begin."""
    if not placed.obstacles.dynamic:
        return {}
    from sim.rigid.dynamics.time_step_limits import TERMS, step_limits

    began = [(item.size, item.dynamic.now) for item in placed.obstacles.dynamic.values()]
    pace = max(float(np.linalg.norm(now.velocity)) / size for size, now in began)
    spin = max(float(np.linalg.norm(now.angular_velocity)) for _, now in began)
    longest = given(placed.spec.rigid).max_step
    return {TERMS[term]: limit for term, limit in step_limits(longest, pace, spin).items()}


def _of_fluid(placed: PlacedScene, fluid: Fluid, fastest: float) -> Limits:
    """Of particles the fastest of which begins at a speed [m/s], without what they do to one another."""
    from sim.fluid import load_solver
    from sim.fluid.model import fastest_signal
    from sim.fluid.time_step_limits import fall_limit, tension_limit

    half = 0.5 * fluid.support_radius
    limits = {"the surface tension": tension_limit(half, fluid)}
    if load_solver(fluid.method).WEAKLY_COMPRESSIBLE:
        sound = fastest_signal(fluid, placed.gravity, placed.drop, placed.fastest)
        return limits | {f"sound of {sound:.3g} m/s": placed.spec.step.cfl * half / (sound + fastest)}
    return limits | {"gravity": fall_limit(half, float(np.linalg.norm(placed.gravity)))}
