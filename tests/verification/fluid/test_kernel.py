"""The kernel against its definition: unit integral, gradient by differences, half-spaces by quadrature."""

import numpy as np
import pytest
from scipy.integrate import quad

from sim.fluid.boundary.calibration import calibrate_wall, lack, sample_depth, sample_volume, sample_weight
from sim.fluid.kernel import (
    cubic_host,
    cubic_slope_host,
    halfspace_area_host,
    halfspace_volume_host,
    lattice,
    particle_mass,
)

H = 0.037


def plane_integral(z: float) -> float:
    """Integral of W over the plane at distance z: 2 pi int_z^h W(r) r dr."""
    return 2 * np.pi * quad(lambda r: float(cubic_host(r, H)) * r, z, H, points=[H / 2] if z < H / 2 else None)[0]


def test_the_kernel_integrates_to_one():
    total = 4 * np.pi * quad(lambda r: float(cubic_host(r, H)) * r * r, 0, H, points=[H / 2])[0]
    assert total == pytest.approx(1.0, rel=1e-9)


def test_the_gradient_is_the_derivative():
    r = np.linspace(0.01, 0.99, 197) * H
    step = 1e-6 * H
    difference = (cubic_host(r + step, H) - cubic_host(r - step, H)) / (2 * step)
    np.testing.assert_allclose(cubic_slope_host(r, H) * r, difference, rtol=1e-5, atol=1e-6 * abs(difference).max())


def test_device_functions_match_the_definition(taichi):
    ti = taichi
    from sim.fluid.kernel import cubic, cubic_slope, halfspace_area, halfspace_volume

    q = np.linspace(-1.2, 1.2, 241)
    x = ti.ndarray(ti.f32, len(q))
    values = ti.ndarray(ti.f32, (len(q), 4))
    x.from_numpy(q.astype(np.float32))

    @ti.kernel
    def evaluate(x: ti.types.ndarray(dtype=ti.f32, ndim=1), out: ti.types.ndarray(dtype=ti.f32, ndim=2)):
        for i in range(x.shape[0]):
            out[i, 0] = cubic(ti.abs(x[i]))
            out[i, 1] = cubic_slope(ti.abs(x[i]))
            out[i, 2] = halfspace_area(x[i])
            out[i, 3] = halfspace_volume(x[i])

    evaluate(x, values)
    got = values.to_numpy()
    norm = 8 / (np.pi * H**3)
    np.testing.assert_allclose(got[:, 0] * norm, cubic_host(abs(q) * H, H), rtol=2e-6, atol=1e-6 * norm)
    slope = cubic_slope_host(abs(q) * H, H)
    np.testing.assert_allclose(got[:, 1] * norm / H**2, slope, rtol=1e-5, atol=1e-5 * norm / H**2)
    area = np.array([plane_integral(min(abs(z), 1) * H) * H for z in q])
    np.testing.assert_allclose(got[:, 2], area, atol=2e-6)
    beyond = np.array([quad(lambda z: plane_integral(abs(z)), np.clip(s, -1, 1) * H, H, limit=200)[0] for s in q[::12]])
    np.testing.assert_allclose(got[::12, 3], beyond, atol=2e-6)
    np.testing.assert_allclose([halfspace_volume_host(s) for s in q], got[:, 3], atol=2e-6)


@pytest.mark.parametrize("ratio", [1.75, 2.0, 3.0])
def test_the_lattice_has_the_rest_density(ratio):
    spacing = H / ratio
    mass = particle_mass(spacing, H, 1000.0)
    density = mass * cubic_host(np.linalg.norm(lattice(spacing, H), axis=1), H).sum()
    assert density == pytest.approx(1000.0, rel=1e-12)
    # A sum over a lattice is the integral up to the order of the kernel's smoothness.
    assert mass == pytest.approx(1000.0 * spacing**3, rel=0.02)


@pytest.mark.parametrize("ratio", [1.75, 2.0, 2.5])
def test_a_wall_replaces_what_the_lattice_lacks(ratio):
    """Density and force of the outermost layer are those of a particle inside."""
    spacing = H / ratio
    mass = particle_mass(spacing, H, 1.0)
    points = lattice(spacing, H)
    kept = points[points[:, 1] > -spacing / 2]
    r = np.linalg.norm(kept, axis=1)
    wall = calibrate_wall(spacing, H)
    density = mass * cubic_host(r, H).sum() + wall.weight * halfspace_volume_host(wall.distance / H)
    assert density == pytest.approx(1.0, abs=1e-9)
    pairs = 2 * mass * (cubic_slope_host(r, H) * kept[:, 1]).sum()
    solid = wall.weight * halfspace_area_host(wall.distance / H) / H
    assert pairs == pytest.approx(-solid, rel=1e-6)


@pytest.mark.parametrize("ratio", [1.5, 2.0, 2.5, 3.0])
def test_samples_of_sheets_replace_what_the_lattice_lacks(ratio):
    """sum_b V_b W half a spacing off the sheet, with one sample of this depth and volume on each square of the
    spacing; V = 1 / sum W over the lattice itself (Akinci et al. 2012, eq. 4), times its weight."""
    spacing = H / ratio
    axis = np.arange(-6, 7) * spacing
    x, z = np.meshgrid(axis, axis)
    flat = np.column_stack((x.ravel(), np.zeros(x.size), z.ravel()))
    volume = sample_volume(spacing, H)
    assert volume * cubic_host(np.linalg.norm(flat, axis=1), H).sum() == pytest.approx(1.0, rel=1e-12)
    height = sample_depth(spacing, H) + 0.5 * spacing
    added = sample_weight(spacing, H) * volume * cubic_host(np.linalg.norm(flat - [0, height, 0], axis=1), H).sum()
    assert added == pytest.approx(lack(spacing, H).density, rel=1e-9)
