"""What solids add to the density of a particle grows no faster than it can come nearer to them.

With u(s) of one plane, which grows the faster the nearer it is, a particle that comes nearer by v dt gets at most
-u'(s) v dt more, by the slope where it is then: of what moves itself pressure is told at once. Of a face that is there
where none was it is told of that much in each step, at the speed of the particle and 0.15 sqrt(g d) beside.
"""

from __future__ import annotations

import numpy as np
import pytest

from sim.fluid.boundary.half_space import half_space_fit, own_share_host
from tests.verification.test_half_spaces import SPACING, UP, H, vectors

pytestmark = pytest.mark.usefixtures("taichi")
FALL = 9.81 * SPACING
DISTANCES = np.linspace(0.05, 0.9, 40) * SPACING


def share(distance: np.ndarray) -> np.ndarray:
    return own_share_host(distance, half_space_fit(SPACING, H), H)


def placed(told: np.ndarray, speed: float, since: float | None, lapse: float, ahead: float):
    """Faces of points over a plane that go down at this speed [m/s], and what pressure is then told of."""
    import taichi as ti

    from sim.arrays import numpy_real, real
    from sim.fluid.boundary.faces import Faces
    from sim.fluid.boundary.shapes import Shapes, half_space

    count = len(DISTANCES)
    faces = Faces(Shapes([half_space(UP, 0.0)], np.zeros(3), SPACING, H), SPACING, H, H)
    here, velocity = vectors(DISTANCES[:, None] * UP), vectors(np.tile(-speed * UP, (count, 1)))
    known, slack = (ti.ndarray(real, count) for _ in range(2))
    known.from_numpy(told.astype(numpy_real))
    faces.find(here, count)
    faces.place(here, velocity, count, ahead, slack=slack, told=known, since=since, lapse=lapse, fall=FALL)
    return faces.excess.to_numpy()[:count], known.to_numpy()


@pytest.mark.parametrize("speed", [0.01, 1.0, 10.0])
def test_what_comes_nearer_feels_it_at_once(speed):
    """In a step of up to 0.2 d, and where it will be after one."""
    step = min(0.2 * SPACING / speed, 1e-3)
    before = share(DISTANCES + speed * step)
    assert placed(before, speed, step, step, 0.0)[0] == pytest.approx(0.0, abs=1e-6)
    assert placed(share(DISTANCES), speed, None, step, step)[0] == pytest.approx(0.0, abs=1e-6)


def test_a_face_that_was_not_there_is_told_of_gradually():
    """By its slope over the way of a fall that lasts as long as the step, and the whole of it in the end."""
    step, whole = 1e-3, share(DISTANCES)
    slope = -np.gradient(share(np.linspace(0, 1, 2001) * SPACING), SPACING / 2000)
    way = 0.15 * np.sqrt(FALL) * step
    told = np.minimum(whole, np.interp(DISTANCES, np.linspace(0, 1, 2001) * SPACING, slope) * way)
    excess, known = placed(np.zeros(len(DISTANCES)), 0.0, step, step, 0.0)
    assert known == pytest.approx(told, rel=0.01, abs=1e-5)
    assert excess == pytest.approx(whole - told, rel=0.01, abs=1e-5)
    for _ in range(200):
        excess, known = placed(known, 0.0, step, step, 0.0)
    assert excess == pytest.approx(0.0, abs=1e-6)


def test_what_is_new_is_told_of_all():
    from sim.fluid.boundary.growth import UNTOLD

    excess, known = placed(np.full(len(DISTANCES), UNTOLD), 0.0, 0.0, 0.0, 0.0)
    assert excess == pytest.approx(0.0, abs=1e-6)
    assert known == pytest.approx(share(DISTANCES), rel=1e-3, abs=1e-5)
