"""What a run did not do as it was asked to in many of its steps, and what would help."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sim.cloth import INTEGRATORS
from sim.run.reporting.counts import Counts
from sim.spec import SimulationSpec

if TYPE_CHECKING:
    from sim.cloth.spec import Cloth
    from sim.fluid.spec import Fluid

MANY = 0.05
"""Share of the steps of a run from which on it is told that they ended at a cap."""
OFTEN = 0.01
"""The same of the ways of particles and points of cloth that were cut short."""


@dataclass(frozen=True)
class Work:
    """What a run has done: steps, and the sums over them of the numbers of particles and of points of cloth."""

    steps: int
    particle_steps: int
    point_steps: int


def shortfalls(spec: SimulationSpec, before: Counts, after: Counts, work: Work) -> Iterator[str]:
    """What is to be said of a run that has counted from `before` to `after`, without numbers that differ from segment
    to segment of a film; `spec` as it is at the end."""
    done = {name: getattr(after, name) - getattr(before, name) for name in vars(after)}
    if spec.fluid is not None:
        yield from _of_fluid(spec.fluid, done, work)
    if done["contacts_capped"] > MANY * work.steps and spec.rigid is not None:
        yield _capped(
            "the sweeps over contacts of rigid bodies",
            f"rigid.max_iterations ({spec.rigid.max_iterations})",
            "rigid.contact_error",
            "contacts_capped",
            "shorten steps by rigid.max_step",
        )
    if spec.cloth is not None:
        yield from _of_cloth(spec.cloth, done, work)


def _of_fluid(fluid: Fluid, done: dict[str, int], work: Work) -> Iterator[str]:
    from sim.fluid import load_solver

    solver = load_solver(fluid.method)
    if done["pressure_capped"] > MANY * work.steps and solver.CAP:
        yield _capped(
            "the pressure solver",
            f"{fluid.solver_path}.{solver.CAP} ({getattr(fluid.solver_settings, solver.CAP)})",
            " and ".join(f"{fluid.solver_path}.{name}" for name in solver.ERRORS),
            "pressure_capped",
            "shorten steps by step.cfl",
        )
    if done["viscosity_capped"] > MANY * work.steps:
        yield _capped(
            "the solver of implicit viscosity",
            f"fluid.implicit_viscosity.max_iterations ({fluid.implicit_viscosity.max_iterations})",
            "fluid.implicit_viscosity.error",
            "viscosity_capped",
            "shorten steps by step.maximum",
        )
    if done["particles_held_off"] > OFTEN * work.particle_steps:
        yield (
            "particles would have passed through thin solids again and again, and were brought back to their side "
            "(particles_held_off in summary.json): use smaller particles (fluid.particle_radius), thicker solids, or "
            "shorter steps (step.cfl)"
        )


def _of_cloth(cloth: Cloth, done: dict[str, int], work: Work) -> Iterator[str]:
    settings = cloth.implicit_euler
    if done["cloth_capped"] > MANY * work.steps:
        cap = f"cloth.implicit_euler.max_newton ({settings.max_newton}) or max_iterations ({settings.max_iterations})"
        error = "cloth.implicit_euler.velocity_error and force_error"
        if cloth.integrator not in INTEGRATORS:
            cap, error = "its cap", f"cloth.extra.{cloth.integrator}"
        yield _capped(
            "the solver of the cloth",
            cap,
            error,
            "cloth_capped",
            "shorten steps by cloth.max_step",
        )
    if done["cloth_held_back"] > OFTEN * work.point_steps:
        yield (
            "points of cloth would have passed through something again and again, and could not go all their way "
            "(cloth_held_back in summary.json): use shorter steps (cloth.max_step), slower solids, or thicker cloth"
        )


def _capped(what: str, cap: str, error: str, count: str, otherwise: str) -> str:
    return (
        f"{what} ended at {cap} in more than {100 * MANY:.0f} % of the steps, with a larger error than {error} "
        f"allow{'' if ' and ' in error else 's'} ({count} in summary.json): raise the cap, allow a larger error, or "
        f"{otherwise}"
    )
