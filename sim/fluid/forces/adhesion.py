"""Adhesion of the fluid to solids (Akinci et al. 2013a).

a_i = -beta sum_b V_b A(r) x_ib / r,    A(r) = (-4 r^2 / h^2 + 6 r / h - 2)^(1/4) from h/2 to h             eq. 6, 7
V_b the volume of a boundary sample; a solid is a half-space full of them, at distance y from whose surface
a = -beta G(y) n,    G(y) = pi int_max(y, h/2)^h A(r) (r^2 - y^2) dr.
beta follows from the work per area that it takes to part fluid of density rho0 from a flat surface,
W = rho0 int_0^h y a(y) dy. A drop meets the surface at the angle theta of W = sigma (1 + cos theta) (Young, Dupre).
"""

import numpy as np

from sim.device.arrays import Vec4Array, real, vec3
from sim.device.compiler import ti
from sim.fluid.boundary.calibration import SAMPLE_DEPTH, sample_volume, sample_weight
from sim.fluid.forces.force import ForceBySolids
from sim.fluid.layout import DISTANCE, VOLUME, Samples, Walls
from sim.fluid.system import FluidSystem

_Q = 0.5 + (np.arange(4000) + 0.5) / 8000
_STEP = 1.0 / 8000


def adhesion_host(q: np.ndarray) -> np.ndarray:
    """A at distances q h."""
    return np.clip(2.0 * (2.0 * q - 1.0) * (1.0 - q), 0.0, None) ** 0.25


def wall_adhesion_host(q: np.ndarray) -> np.ndarray:
    """G / h^3 at distances q h from a wall, by quadrature."""
    weight = adhesion_host(_Q) * _STEP
    return np.array([np.pi * float((weight * (y < _Q) * (_Q**2 - y * y)).sum()) for y in np.atleast_1d(q)])


def _fit() -> tuple[tuple[float, float], tuple[float, ...]]:
    """Coefficients of q^2 and 1 of G / h^3 up to h/2, and beyond of a polynomial of q over (1 - q)^2."""
    weight = adhesion_host(_Q) * _STEP
    q = 0.5 + (np.arange(200) + 0.5) / 400
    far = (1.0 - q) ** 2
    beyond = np.polyfit(q, wall_adhesion_host(q) / far, 5, w=far)
    return (-np.pi * float(weight.sum()), np.pi * float((weight * _Q**2).sum())), tuple(beyond.tolist())


NEAR, FAR = _fit()


class Adhesion(ForceBySolids):
    """The force on the particles of a system; `samples` and `solids` are beta [m/s^2 over m^3] against either."""

    def __init__(self, system: FluidSystem):
        super().__init__(system)
        self.samples, self.solids = adhesion_strengths(system)

    @classmethod
    def applies(cls, system: FluidSystem) -> bool:
        return system.boundary.sampled > 0 or system.boundary.shapes.count > 0

    def accelerate(self) -> None:
        system = self.system
        boundary = system.boundary
        _accelerate(
            system.count,
            system.h,
            self.samples,
            self.solids,
            system.particles.position,
            system.particles.acceleration,
            boundary.sampled > 0,
            boundary.near_samples,
            boundary.faces.lists,
        )


def adhesion_strengths(system: FluidSystem) -> tuple[float, float]:
    """beta [m/s^2 over m^3] against samples of sheets, one on each square of the spacing, and against solids."""
    spec, h = system.spec, system.h
    spacing, wanted = spec.spacing, spec.adhesion / spec.rest_density
    depth = SAMPLE_DEPTH * spacing / h
    y = (np.arange(400) + 0.5) / 400
    wall = float((y * wall_adhesion_host(y)).mean()) * h**5
    away = depth + y * (1.0 - depth)
    # Of a plane of samples: 2 pi Y int_Y^h A dr at the distance Y from it.
    pull = np.array([2.0 * np.pi * Y * float((adhesion_host(_Q) * (_Q > Y)).sum()) * _STEP for Y in away]) * h**2
    sheet = float(((away - depth) * pull).mean()) * (1.0 - depth) * h**2
    sheet *= sample_weight(spacing, h) * sample_volume(spacing, h) / spacing**2
    return wanted / sheet, wanted / wall


@ti.func
def adhesion(q: real) -> real:
    """A at the distance q h (Akinci et al. 2013a, eq. 7)."""
    return ti.sqrt(ti.sqrt(ti.max(2.0 * (2.0 * q - 1.0) * (1.0 - q), 0.0)))


@ti.func
def wall_adhesion(q: real) -> real:
    """G / h^3 at the distance q h from a wall."""
    y = ti.math.clamp(q, 0.0, 1.0)
    far = ti.cast(0.0, real)
    for c in ti.static(FAR):
        far = far * y + c
    return ti.select(y < 0.5, NEAR[0] * y * y + NEAR[1], far * (1.0 - y) * (1.0 - y))


@ti.func
def face_adhesion(distance: real, strength: real, h: real) -> real:
    """Acceleration towards a half-space at this distance [m]; strength: beta [m/s^2 over m^3]."""
    return strength * h * h * h * wall_adhesion(distance / h)


@ti.kernel
def _accelerate(
    count: ti.i32,
    h: real,
    sample_strength: real,
    solid_strength: real,
    position: Vec4Array,
    acceleration: Vec4Array,
    has_samples: ti.template(),
    samples: Samples,
    walls: Walls,
):
    inverse_h = 1.0 / h
    for i in range(count):
        x = position[i].xyz
        a = vec3(0.0)
        if ti.static(has_samples):
            for k in range(samples.size[i]):
                b = samples.sample[samples.index[samples.begin[i] + k]]
                d = x - b.xyz
                r = ti.max(d.norm(), 1e-6 * h)
                a -= sample_strength * b[VOLUME] * adhesion(r * inverse_h) / r * d
        for e in range(walls.begin[i], walls.begin[i] + walls.size[i]):
            one = walls.face[e]
            a -= walls.weight[e] * face_adhesion(one[DISTANCE], solid_strength, h) * one.xyz
        acceleration[i].xyz += a
