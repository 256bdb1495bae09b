"""What a run would refuse of the first step, as far as it is known before anything is built that steps."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from scene.settings import Refused
from sim.run.failure import FIXED_MARGIN, MOST_STEPS, beyond_limit
from sim.run.world import World
from sim.spec import SimulationSpec

if TYPE_CHECKING:
    from sim.cloth.model import PlacedSheet

Limits = dict[str, float]
"""Largest steps [s] by what limits them."""


def refuse_steps(world: World, velocity: np.ndarray) -> None:
    """Raise Refused for steps that a run would refuse at its start; velocity: of the particles [m/s], shape [n, 3].

    Forces on particles may limit steps further.
    """
    fastest = float(np.linalg.norm(velocity, axis=1).max(initial=0.0))
    fluid, step = world.spec.fluid, world.spec.step
    sound = fluid.wcsph.speed_of_sound if fluid is not None and fluid.solver == "wcsph" else "auto"
    if sound != "auto" and fastest > sound:
        raise Refused(
            f"the fluid begins at {fastest:.3g} m/s, faster than sound ({sound:.3g} m/s)",
            location=("fluid", "wcsph", "speed_of_sound"),
            remedy="raise it to ten times the greatest speed, leave it out, or let the fluid begin more slowly",
        )
    if world.sheets:
        refuse_cloth_steps(world.spec, _explicit_step(world))
        for item in world.sheets:
            refuse_jumps(item, 0.0)
    limits = _of_bodies(world) | (_of_fluid(world, fastest) if len(velocity) else {})
    if not limits:
        return
    term, limit = min(limits.items(), key=lambda item: item[1])
    if step.fixed is not None and step.fixed > FIXED_MARGIN * limit:
        raise beyond_limit(step.fixed, FIXED_MARGIN * limit)
    if step.fixed is None and limit < 1.0 / (world.spec.fps * MOST_STEPS):
        raise Refused(
            f"{term} allows steps of {limit:.3g} s only, so that a frame would need "
            f"{1 / (world.spec.fps * limit):,.0f} of them (at most {MOST_STEPS:,})",
            remedy="use lower speeds, larger particles or bodies, or more frames per second",
        )


def refuse_cloth_steps(spec: SimulationSpec, stable: float = math.inf) -> None:
    """Raise Refused for steps longer than cloth may take, and for cloth that would need too many explicit ones, of
    `stable` [s] at most, in each."""
    step, most = spec.step, spec.cloth.max_step
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


def _explicit_step(world: World) -> float:
    """The longest explicit step of the cloth [s]; infinite where it takes none."""
    from sim.cloth import load_integrator
    from sim.cloth.fabric.mesh import Elastic

    settings = world.spec.cloth
    stable_step = getattr(load_integrator(settings.integrator), "stable_step", None)
    if stable_step is None:
        return math.inf
    held = np.concatenate([item.held for item in world.sheets])
    mesh = Elastic([item.sheet for item in world.sheets], [item.fabric for item in world.sheets], held)
    return stable_step(mesh, settings)


def refuse_jumps(item: PlacedSheet, time: float) -> None:
    """Raise Refused where pins take a sheet that begins at `time` [s] elsewhere at once."""
    from sim.cloth.fabric.pins import refuse_jump

    size = float(np.ptp(item.fabric.points, axis=0).max())
    for part in item.pinned:
        refuse_jump(item.name, part, item.begins[part.points], size, time)


def _of_bodies(world: World) -> Limits:
    """Of bodies that obey forces, as they begin."""
    if not world.obstacles.dynamic:
        return {}
    from sim.rigid.dynamics.time_step_limits import step_limits

    began = [(item.size, item.motion.now) for item in world.obstacles.dynamic.values()]
    pace = max(float(np.linalg.norm(now.velocity)) / size for size, now in began)
    spin = max(float(np.linalg.norm(now.angular_velocity)) for _, now in began)
    named = {"rigid step": "rigid.max_step", "spin": "the spin of a body", "travel": "the speed of a body"}
    return {named[term]: limit for term, limit in step_limits(world.spec.rigid.max_step, pace, spin).items()}


def _of_fluid(world: World, fastest: float) -> Limits:
    """Of particles the fastest of which begins at a speed [m/s], without what they do to one another."""
    from sim.fluid.model import fastest_signal
    from sim.fluid.time_step_limits import fall_limit, tension_limit

    fluid, half = world.spec.fluid, 0.5 * world.spec.fluid.support_radius
    limits = {"the surface tension": tension_limit(half, fluid)}
    if fluid.solver == "wcsph":
        sound = fastest_signal(fluid, world.gravity, world.drop, world.fastest)
        return limits | {f"sound of {sound:.3g} m/s": world.spec.step.cfl * half / (sound + fastest)}
    return limits | {"gravity": fall_limit(half, float(np.linalg.norm(world.gravity)))}
