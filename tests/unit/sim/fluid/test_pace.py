"""The step in which the first particle has gone its way, from speeds and accelerations of each."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.fluid.systems import load

WAY = 0.004


def test_the_step_is_that_of_the_first_particle(taichi):
    """v t + a t^2 = s, solved for each particle by its polynomial; none has both the greatest v and the greatest a."""
    from sim.fluid.boundary.boundary import Boundary
    from sim.fluid.boundary.shapes import Shapes
    from sim.fluid.spec import Fluid
    from sim.fluid.system import FluidSystem
    from sim.fluid.time_step_limits import displacement_limit

    speed, acceleration = np.array([3.0, 0.0, 1.5, 0.2]), np.array([9.81, 800.0, 300.0, 0.0])
    spec = Fluid(particle_radius=0.01)
    spacing, h = spec.spacing, spec.support_radius
    system = FluidSystem(spec, np.zeros(3), Boundary(Shapes([], np.zeros(3), spacing, h), spacing, h, h))
    axis = np.array([[0.6, 0.0, -0.8]])
    load(system, np.eye(4)[:, :3], speed[:, None] * axis, 1000.0, acceleration[:, None] * axis[:, ::-1])
    system.find_neighbors()
    roots = [np.roots([a, v, -WAY]).max() for v, a in zip(speed, acceleration, strict=True)]
    found = displacement_limit(WAY, system.measure(WAY, 1e3, 0.0, 1e3).pace)
    assert found == pytest.approx(min(roots), rel=1e-5)
    assert found > np.roots([acceleration.max(), speed.max(), -WAY]).max() * 1.05
