"""What probes read of pressures and forces, where it is known: next to solids, on parts of bodies, in the mean."""

from __future__ import annotations

import csv
import itertools
from types import SimpleNamespace

import numpy as np
import pytest

D, RHO, G = 0.01, 1000.0, 9.81
SIZE, DEPTH = np.array([0.24, 0.2, 0.16]), 0.2
BLOCK = [0.08, 0.15, 0.16]
PLACES = {"block": -0.04, "wall": 0.12, "open": 0.04}
"""x [m] of a face of a body, of one of the container, and of open water."""
HEIGHTS = (0.0, 0.01, 0.03, 0.1)
ROW = (-0.06, -0.03, 0.0, 0.03, 0.06)
"""z [m] of probes side by side: fluid at rest holds some shear stress, so that one of them may read 10 % off."""


def row(name: str, x: float, y: float, zs: tuple[float, ...]) -> dict:
    """Probes side by side."""
    return {f"{name}_{k}": {"type": "pressure", "at": [x, y, z], "rate": 50, "mean": True} for k, z in enumerate(zs)}


def mean_of(found: dict, name: str, since: int) -> float:
    """Of a row of probes and the rows of the table from `since` on [Pa]."""
    values = [values[since:] for (probe, _), values in found.items() if probe.rpartition("_")[0] == name]
    return float(np.mean(values))


def read(out) -> dict[tuple[str, str], np.ndarray]:
    """Values by probe and quantity, shape [rows]."""
    found: dict[tuple[str, str], list[float]] = {}
    with (out / "probes.csv").open() as file:
        for row in csv.DictReader(file):
            found.setdefault((row["probe"], row["quantity"]), []).append(float(row["value"]))
    return {name: np.array(values) for name, values in found.items()}


def pool(probes: dict) -> dict:
    """A block in a corner of a pool at rest."""
    return {
        "fps": 50,
        "containers": {"tank": {"type": "box", "size": [0.24, 0.4, 0.16]}},
        "fluid": {
            "solver": "dfsph",
            "particle_radius": D / 2,
            "viscosity": 1e-3,
            "bodies": {"water": {"shape": {"type": "box", "size": SIZE.tolist()}, "position": [0, DEPTH / 2, 0]}},
        },
        "rigid": {"bodies": {"block": {"shape": {"type": "box", "size": BLOCK}, "position": [-0.08, 0.075, 0]}}},
        "probes": probes,
    }


@pytest.fixture(scope="module")
def at_rest(tmp_path_factory):
    """What probes read in a pool that comes to rest, in 0.5 s."""
    from sim.segment import simulate
    from sim.spec import SimulationSpec

    probes: dict = {}
    for (place, x), y in itertools.product(PLACES.items(), HEIGHTS):
        probes |= row(f"{place}{round(1000 * y)}", x, y, ROW)
    half = {"low": [-0.2, 0.02, -0.2], "high": [0.0, 0.12, 0.2]}
    probes["side"] = {"type": "force", "body": "block", "region": half, "rate": 50, "mean": True}
    probes["whole"] = {"type": "force", "body": "block", "rate": 50, "mean": True}
    folder = tmp_path_factory.mktemp("pool")
    spec = SimulationSpec.model_validate(pool(probes))
    assert simulate(spec, folder, folder / "out", first=0, last=25, arch="cpu", quiet=True, threads=1) == 0
    return read(folder / "out")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("place", "y"), [pair for pair in itertools.product(PLACES, HEIGHTS) if pair[0] == "open" or pair[1] > 0]
)
def test_pressure_is_that_of_the_depth_also_at_walls(at_rest, place, y):
    """p = rho g (H - y), on faces of a body and of the container, and on the floor: to a layer of 20. In the edge of a
    face and the floor there are particles in one quarter of the kernel only; there it reads up to 8 % less."""
    found = mean_of(at_rest, f"{place}{round(1000 * y)}", 20)
    assert found == pytest.approx(RHO * G * (DEPTH - y), abs=0.05 * RHO * G * DEPTH)


@pytest.mark.slow
def test_the_force_on_a_part_is_the_pressure_on_it(at_rest):
    """Between two heights: rho g (H - mean y) over the area of the block's one side that is in water, and in the region
    nothing else; to one of ten layers, which is in the region or not."""
    expected = RHO * G * (DEPTH - 0.07) * 0.1 * BLOCK[2]
    side, lift, whole = (
        at_rest[name][20:].mean() for name in (("side", "force_x"), ("side", "force_y"), ("whole", "force_x"))
    )
    assert side == pytest.approx(-expected, rel=0.1)
    assert abs(lift) < 0.05 * expected
    assert abs(side) < 0.8 * abs(whole)


def test_a_part_of_a_body_that_obeys_forces_is_refused():
    """All that acts on it is known as a whole only: films, and what moves it."""
    from scene.diagnostics.support import refuse_unsupported
    from scene.settings import Refused
    from sim.spec import SimulationSpec

    data = pool({"side": {"type": "force", "body": "block", "region": {"low": [0, 0, 0], "high": [1, 1, 1]}}})
    data["rigid"]["bodies"]["block"] |= {"motion": "dynamic", "density": 2000}
    with pytest.raises(Refused, match="which obeys forces") as refused:
        refuse_unsupported(SimulationSpec.model_validate(data))
    assert refused.value.location == ("probes", "side", "region")


def test_the_impulse_is_the_integral_of_the_force(simulate):
    """Told at the end as the sum over rows of force times the time between them, exactly but for how many digits there
    are in the table; a run in parts tells the same."""
    probes = {"push": {"type": "force", "body": "block", "rate": 50, "mean": True}}
    whole = simulate(pool(probes), 5, "whole", threads=1)
    found = read(whole)
    force, impulse = found["push", "force_y"], found["push", "impulse_y"]
    assert impulse[0] == 0
    np.testing.assert_allclose(np.diff(impulse), force[1:] / 50, rtol=1e-6)
    first = simulate(pool(probes), 2, "first", threads=1)
    rest = simulate(pool(probes), 5, "rest", first=3, state=first / "state_00002.npz", threads=1)
    np.testing.assert_array_equal(
        np.concatenate((read(first)["push", "impulse_y"], read(rest)["push", "impulse_y"])), impulse
    )


def test_a_linear_field_is_read_exactly_on_one_side_of_a_wall():
    """Moving least squares gives linear fields back, however particles lie: to rounding."""
    from sim.coupling.pressure_at import pressure_at

    rng = np.random.default_rng(1)
    points = rng.uniform([0, -1, -1], [1, 1, 1], (4000, 3)) * 0.04
    slope, level = np.array([3e4, -2e4, 1e4]), 5e3
    shapes = SimpleNamespace(count=0)
    system = SimpleNamespace(boundary=SimpleNamespace(shapes=shapes))
    view = SimpleNamespace(
        points=points,
        pressure=level + points @ slope,
        density=np.full(len(points), RHO),
        h=0.02,
        mass=RHO * D**3,
    )
    origin = np.zeros(3)
    for at in (np.zeros(3), np.array([0.0, 0.01, -0.005]), np.array([0.02, 0, 0])):
        assert pressure_at(view, system, origin, at) == pytest.approx(level + at @ slope, rel=1e-9)
    assert pressure_at(view, system, origin, np.array([-0.021, 0, 0])) == 0.0


def test_a_face_of_a_thin_wall_feels_its_own_side_only(simulate):
    """Two tanks of one plate's thickness, d / 2, apart, one filled twice as high as the other."""
    plate = {"shape": {"type": "box", "size": [D / 2, 0.3, 0.2]}, "position": [0, 0.15, 0]}
    deep = {"shape": {"type": "box", "size": [0.08, 0.2, 0.08]}, "position": [-0.04 - D / 4, 0.1, 0]}
    shallow = {"shape": {"type": "box", "size": [0.08, 0.1, 0.08]}, "position": [0.04 + D / 4, 0.05, 0]}
    probes = {}
    for name, x in (("deep", -D / 4 - 1e-4), ("shallow", D / 4 + 1e-4)):
        probes |= row(name, x, 0.02, (-0.03, -0.015, 0.0, 0.015, 0.03))
    scene = {
        "fps": 50,
        "containers": {"tank": {"type": "box", "size": [0.16 + D / 2, 0.4, 0.08]}},
        "fluid": {"solver": "dfsph", "particle_radius": D / 2, "viscosity": 1e-3, "bodies": {"a": deep, "b": shallow}},
        "rigid": {"bodies": {"plate": plate}},
        "probes": probes,
    }
    found = read(simulate(scene, 20, threads=1))
    for name, depth in (("deep", 0.18), ("shallow", 0.08)):
        assert mean_of(found, name, 10) == pytest.approx(RHO * G * depth, abs=0.05 * RHO * G * 0.2)
