"""Arrays of particles hold the same, whether there was room for more particles or not."""

from __future__ import annotations

import numpy as np
import pytest

pytestmark = pytest.mark.usefixtures("taichi")


@pytest.mark.parametrize("room", [3, 100])
def test_what_comes_has_zero_where_nothing_is_given(room):
    """Otherwise a run and one that goes on from its state, which has less room, would differ."""
    from sim.device.arrays import Declared, Particles, numpy_real

    declared = [Declared("place", "vec4", "m"), Declared("past", "real", "", saved=False)]
    particles = Particles(declared, room)
    particles.load({"place": np.full((3, 4), 2, numpy_real)})
    particles.past.fill(5)
    particles.extend({"place": np.full((2, 4), 3, numpy_real)})
    assert particles.numpy("place")[:, 0].tolist() == [2, 2, 2, 3, 3]
    assert particles.numpy("past").tolist() == [5, 5, 5, 0, 0]


def test_two_that_declare_the_same_name_are_refused():
    from sim.device.arrays import Declared, Particles

    with pytest.raises(ValueError, match="declared twice: search"):
        Particles([Declared("search", "vec4", "m/s"), Declared("search", "vec4", "kg/m^3")], 4)
