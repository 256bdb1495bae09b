"""Which scenes take one thread, however many there are: where loops are short, threads wait for one another longer than
they work.

Measured by `tests/benchmarks/one_thread.py`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sim.run.placing.placed_scene import PlacedScene

PARTICLES = 5000
PARTICLES_OF_SHORT_STEPS = 2000
"""Where steps take few loops, as with weakly compressible fluids."""
POINTS = 15_000
"""Of cloth."""
BODIES = 1000
"""That obey forces."""


def takes_one_thread(scene: PlacedScene, particles: int) -> bool:
    """Whether a scene with so many particles is small, and stays so: emitters fill any."""
    fluid = scene.spec.fluid
    if fluid is not None:
        from sim.fluid import load_solver

        short = load_solver(fluid.method).WEAKLY_COMPRESSIBLE
        if fluid.emitters or particles >= (PARTICLES_OF_SHORT_STEPS if short else PARTICLES):
            return False
    points = sum(len(item.fabric.points) for item in scene.sheets)
    return points < POINTS and len(scene.obstacles.dynamic) < BODIES
