"""What cloth knows of the shapes of solids does not depend on when it looks."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sim.bodies.obstacles import find_obstacles
from sim.coupling.cloth_solids import find_solids
from sim.spec import SimulationSpec


def test_a_run_that_goes_on_has_the_same_shapes_to_the_bit():
    """Normals of what is round were found where bodies were when a run began, and differed by rounding."""
    turning = {"shape": {"type": "sphere", "radius": 0.1}, "motion": "prescribed", "angular_velocity": [1, 2, 3]}
    spec = SimulationSpec.model_validate({"fps": 24, "rigid": {"bodies": {"ball": turning}}})
    first, later = (find_solids(spec, find_obstacles(spec, Path()), time) for time in (0.0, 0.7))
    assert np.array_equal(first.made, later.made)
    assert not np.allclose(first.points, later.points)
