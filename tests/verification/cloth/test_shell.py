"""Cloth as a shell of finite elements against closed forms, on meshes of any kind."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.cantilevers import STATIC, cantilever
from tests.support.cloths import HANGING, INTEGRATORS, G, part, places, set_motion, sheet, step
from tests.support.in_time import in_time
from tests.support.triangulations import MESHES, triangulated, write


def shell(sheets: dict, **cloth):
    return part(sheets, model="fem", **cloth)


def on_mesh(kind, folder, *, cells=8, length=1.0, width=0.4, bent=None, **settings):
    points, triangles = triangulated(kind, length, width, cells)
    points = points if bent is None else bent(points)
    return {"shape": {"type": "mesh", "file": str(write(points, triangles, folder / "sheet.ply"))}, **settings}


def tube(points: np.ndarray) -> np.ndarray:
    return np.column_stack([np.sin(points[:, 0]), 1 - np.cos(points[:, 0]), points[:, 1]])


@pytest.mark.parametrize("bent", [None, tube])
def test_forces_are_the_slope_of_the_energy(tmp_path, bent):
    """Kernels give the energy, the host the forces."""
    from sim.cloth.shell.forces import pushes

    fabric = {"type": "denim", "warp": [0.6, 0, 0.8], "warp_bending": 1.0, "weft_bending": 2.0}
    made = shell({"a": on_mesh("turned by 30", tmp_path, bent=bent, fabric=fabric)})
    rng, start = np.random.default_rng(1), places(made)
    x = start + rng.normal(0, 0.02, start.shape)
    force, size = pushes(made.mesh.shell, x, 0 * x), 1e-6
    for i in rng.integers(0, len(x), 8):
        for axis in range(3):
            stored = []
            for sign in (1, -1):
                moved = x.copy()
                moved[i, axis] += sign * size
                set_motion(made, position=moved)
                stored.append(made.measure().elastic_energy)
            assert -(stored[0] - stored[1]) / (2 * size) == pytest.approx(
                force[i, axis], abs=1e-8 * np.abs(force).max()
            )


@pytest.mark.parametrize("bent", [None, tube])
def test_forces_and_damping_turn_and_push_nothing_as_a_whole(tmp_path, bent):
    from sim.cloth.shell.forces import pushes

    fabric = {"warp_bending": 1.0, "weft_bending": 2.0}
    made = shell({"a": on_mesh("irregular", tmp_path, bent=bent, fabric=fabric)})
    rng, whole = np.random.default_rng(2), made.mesh.shell
    x = places(made) + rng.normal(0, 0.02, places(made).shape)
    v = rng.normal(0, 1, x.shape)
    elastic, force = pushes(whole, x, 0 * x), pushes(whole, x, v)
    most = np.abs(force).max()
    assert np.abs(force.sum(axis=0)).max() < 1e-12 * most
    assert np.abs(np.cross(x, force).sum(axis=0)).max() < 1e-12 * most
    assert ((force - elastic) * v).sum() < 0
    turning = pushes(whole, x, np.cross([1.0, 2.0, 3.0], x))
    assert np.abs(turning - elastic).max() < 1e-12 * most


@pytest.mark.parametrize("kind", MESHES)
def test_the_patch_test(tmp_path, kind):
    """Stretched alike everywhere, and bent alike everywhere, inner points feel no force; and what is stored is that of
    the plane (Irons 1966)."""
    from sim.cloth.shell.forces import pushes

    fabric = {"warp_stiffness": 900, "weft_stiffness": 300, "poisson_ratio": 0.2, "shear_stiffness": 100}
    made = shell({"a": on_mesh(kind, tmp_path, cells=12, width=1.0, fabric=fabric | {"warp": [0.6, 0, 0.8]})})
    x, whole = places(made), made.mesh.shell
    stretched = x @ np.array([[1.1, 0.2, 0.05], [0, 1, 0], [-0.03, 0.1, 0.95]])
    room = np.minimum(x[:, [0, 2]], 1 - x[:, [0, 2]]).min(axis=1)
    force = pushes(whole, stretched, 0 * x)
    assert np.abs(force[room > 1e-9]).max() < 1e-12 * np.abs(force).max()
    curvature = np.array([0.3, -0.2, 0.5])
    rise = (curvature[0] * x[:, 0] ** 2 + curvature[1] * x[:, 2] ** 2 + 2 * curvature[2] * x[:, 0] * x[:, 2]) / 2
    moments = whole.bending.bent(np.column_stack([0 * rise, rise, 0 * rise]))
    force = whole.bending.spread(moments)
    # On right triangles to rounding; on others as far as the correction is symmetric.
    share = np.abs(force[room > 0.3]).max() / np.abs(force).max()
    assert share < (1e-10 if "diagonal" in kind else 0.5 if kind == "irregular" else 0.1)
    inner, corners = room > 1e-9, whole.membrane.corners
    area = np.bincount(corners.ravel(), np.repeat(whole.membrane.area / 3, 3))[inner].sum()
    density = 0.5 * (moments[inner] ** 2).sum() / area
    exact = 0.5 * 1e-4 * (curvature[0] ** 2 + curvature[1] ** 2 + 2 * curvature[2] ** 2)
    assert density == pytest.approx(exact, rel=1e-9 if kind == "one diagonal" else 0.02)


def test_a_strip_stretches_and_contracts_as_its_fabric_says():
    """Strain = stress / E_warp; contraction = nu strain. Small strains: in large ones the law is that of St. Venant and
    Kirchhoff."""
    fabric = {"warp_stiffness": 1000, "weft_stiffness": 400, "poisson_ratio": 0.3, "shear_stiffness": 50}
    weight, load = 1e-3, 1e3
    made = shell({"strip": sheet((2.0, 0.2), spacing=0.02, rotation=HANGING, pins=["left"], mass_per_area=weight,
                                 fabric=fabric, bend_stiffness=0)}, gravity=(0, -load, 0), **STATIC)  # fmt: skip
    step(made, 6.0, 0.3)
    x = places(made)
    assert np.ptp(x[:, 1]) / 2.0 - 1 == pytest.approx(weight * load * 2.0 / (2 * 1000), rel=0.01)
    middle = np.abs(x[:, 1]) < 0.011
    assert 1 - np.ptp(x[middle, 2]) / 0.2 == pytest.approx(0.3 * weight * load * 1.0 / 1000, rel=0.01)


@pytest.mark.parametrize("direction", [0, 30, 90])
def test_what_is_stored_by_stretching_turns_with_the_warp(direction):
    """Energy per area = (C_11 e_1^2 + 2 C_12 e_1 e_2 + C_22 e_2^2 + G g^2) / 2 in the axes of the fabric."""
    angle = np.radians(direction)
    fabric = {"warp_stiffness": 1000, "weft_stiffness": 400, "poisson_ratio": 0.3, "shear_stiffness": 50,
              "warp": [np.cos(angle), 0, np.sin(angle)]}  # fmt: skip
    made = shell({"a": sheet((1.0, 1.0), spacing=0.1, fabric=fabric)})
    size = 1e-4
    moved = places(made) * [1 + size, 1, 1]
    set_motion(made, position=moved)
    along, across, turned = np.cos(angle) ** 2, np.sin(angle) ** 2, 2 * np.cos(angle) * np.sin(angle)
    free = 1 - 0.3**2 * 400 / 1000
    density = (1000 * along**2 + 400 * across**2 + 2 * 0.3 * 400 * along * across) / free + 50 * turned**2
    assert made.measure().elastic_energy == pytest.approx(density * size**2 / 2, rel=1e-3)


@pytest.mark.parametrize("load", [*in_time(5), 0.1, 1, 20])
def test_a_heavy_elastica(tmp_path, load):
    drop, reach = cantilever("both diagonals", tmp_path, load, 20)
    assert (drop, reach) == (pytest.approx(1, abs=0.02), pytest.approx(1, abs=0.02))


@pytest.mark.parametrize("kind", MESHES)
def test_the_sag_does_not_depend_on_the_mesh(tmp_path, kind):
    """Springs are 4 to 11 % off (`docs/accuracy.md`)."""
    drop, reach = cantilever(kind, tmp_path, 5, 20)
    assert (drop, reach) == (pytest.approx(1, abs=0.01), pytest.approx(1, abs=0.01))


@pytest.mark.slow
@pytest.mark.parametrize("kind", MESHES)
def test_nor_does_a_small_one(tmp_path, kind):
    drop, _ = cantilever(kind, tmp_path, 0.1, 40)
    assert drop == pytest.approx(1, abs=0.01)


def test_warp_and_weft_bend_by_their_own_stiffness(tmp_path):
    """A strip along the warp and one along the weft, each as the elastica of its stiffness."""
    weight, load = 0.2, 1.0
    stiff = weight * G / load
    for warp, own, other in (([1, 0, 0], "warp_bending", "weft_bending"), ([0, 0, 1], "weft_bending", "warp_bending")):
        fabric = {own: stiff, other: 10 * stiff, "bias_bending": 6 * stiff, "warp": warp}
        drop, _ = cantilever("both diagonals", tmp_path, load, 20, fabric=fabric)
        assert drop == pytest.approx(1, abs=0.01)


def test_the_order_in_the_spacing_is_two(tmp_path):
    """Of the middle of a strip that both ends carry, 5 w L^4 / (384 B)."""
    errors = []
    for cells in (8, 16, 32):
        points, triangles = triangulated("both diagonals", 1.0, 0.25, cells)
        file = str(write(points, triangles, tmp_path / "strip.ply"))
        ends = [[x, 0, z] for x, z in points if min(x, 1 - x) < 1e-9]
        weight, bend = 1e-3, 0.1
        strip = {"shape": {"type": "mesh", "file": file}, "pins": [{"at": ends}], "mass_per_area": weight,
                 "stretch_stiffness": 1.0, "bend_stiffness": bend, "thickness": 1e-4}  # fmt: skip
        made = shell({"strip": strip}, **STATIC)
        step(made, 9.0, 0.3)
        x = places(made)
        middle = np.abs(x[:, 0] - 0.5) < 1e-6
        errors.append(abs(-x[middle, 1].mean() / (5 * weight * G / (384 * bend)) - 1))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (orders > 1.8).all(), (errors, orders)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_what_is_rolled_at_rest_stays_so(tmp_path, integrator):
    """The curvature of a mesh as placed is that at rest."""
    made = shell({"a": on_mesh("turned by 30", tmp_path, bent=tube, bend_stiffness=0.01)}, gravity=(0, 0, 0),
                 integrator=integrator)  # fmt: skip
    before = places(made)
    step(made, 0.1, 0.005)
    assert np.abs(places(made) - before).max() < 1e-9


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_tumbling_shell_keeps_its_momentum(tmp_path, integrator):
    made = shell({"a": on_mesh("irregular", tmp_path, fabric="denim")}, gravity=(0, 0, 0), integrator=integrator,
                 implicit_euler={"velocity_error": 1e-6, "linear_error": 1e-4})  # fmt: skip
    x, mass = places(made), made.mesh.mass[:, None]
    v = np.cross([0.5, 2.0, 1.0], x - x.mean(axis=0)) + 0.3 * np.sin(9 * x[:, [1, 0, 2]])
    set_motion(made, velocity=v)

    def moments():
        x, v = made.vertices("a")
        return (mass * v).sum(axis=0), (mass * np.cross(x, v)).sum(axis=0)

    before, energy = moments(), sum_of(made)
    step(made, 0.25, 0.0025)
    after = moments()
    size = np.linalg.norm(mass * v, axis=1).sum()
    assert np.abs(after[0] - before[0]).max() < 1e-9 * size
    # Small steps keep angular momentum but for rounding; those of XPBD and Euler, by the order of their length.
    assert np.abs(after[1] - before[1]).max() < (1e-9 if integrator == "symplectic_euler" else 0.01) * size
    assert sum_of(made) < energy * (1 + 1e-6)


@pytest.mark.parametrize("integrator", ["implicit_euler", "symplectic_euler", *in_time("xpbd")])
def test_bending_is_damped_by_its_time(integrator):
    """A clamped strip swings with w = 3.516 (B / (rho L^4))^0.5, and loses exp(-w^2 t T) of its energy in t: the ratio
    of damping is w T / 2."""
    length, cells, weight, bend, delay = 0.5, 10, 0.2, 0.01, 0.03
    edge = length / cells
    clamped = [[x, 0, z] for x in (-length / 2, -length / 2 + edge) for z in (-edge, 0.0, edge)]
    strip = sheet((length, 2 * edge), spacing=edge, pins=[{"at": clamped}], mass_per_area=weight, bend_stiffness=bend,
                  stretch_stiffness=100, fabric={"bend_damping_time": delay, "damping_time": 0})  # fmt: skip
    made = shell({"strip": strip}, gravity=(0, 0, 0), integrator=integrator, xpbd={"substeps": 80})
    x = places(made)
    out = np.clip(x[:, 0] + length / 2 - edge / 2, 0, None)
    swing = 3.516 * np.sqrt(bend / weight) / (length - edge / 2) ** 2
    set_motion(made, velocity=np.column_stack([0 * out, 0.02 * swing * (out / length) ** 2, 0 * out]))
    cycle = 2 * np.pi / swing
    step(made, cycle, 0.004)
    first = sum_of(made)
    step(made, cycle, 0.004)
    found = np.log(first / sum_of(made)) / (swing**2 * cycle)
    assert found == pytest.approx(delay, rel=0.06)


def sum_of(made) -> float:
    found = made.measure()
    return found.kinetic_energy + found.elastic_energy


@pytest.mark.slow
def test_equilibrium_does_not_depend_on_the_integrator():
    damping = {"damping_time": 0.05, "bend_damping_time": 0.05}
    fabric = {"warp_stiffness": 80, "weft_stiffness": 40, "shear_stiffness": 20, **damping}
    cloth = {"pins": ["corners"], "mass_per_area": 0.3, "fabric": fabric}
    sags = {}
    for integrator in INTEGRATORS:
        made = shell(
            {"sheet": sheet((1.0, 1.0), spacing=0.125, **cloth)},
            integrator=integrator, air={"density": 1000.0}, xpbd={"substeps": 80},
        )  # fmt: skip
        step(made, 12.0, 0.01)
        assert made.measure().v_max < 1e-4
        sags[integrator] = -places(made)[:, 1].min()
    assert max(sags.values()) / min(sags.values()) < 1.005, sags


@pytest.mark.parametrize("spread", [0.5, 0.1, 1e-3, 0.0])
@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_what_is_crushed_comes_back(spread, integrator):
    """Two triangles, to a line, too: the barrier stays finite, and a triangle without a normal pulls nowhere."""
    made = shell({"a": sheet((0.4, 0.4), spacing=0.4, thickness=1e-4, fabric={"damping_time": 0.01})},
                 gravity=(0, 0, 0), integrator=integrator)  # fmt: skip
    rng, start = np.random.default_rng(0), places(made)
    set_motion(made, position=start * [spread, 1, 1] + rng.normal(0, 1e-4, start.shape))
    step(made, 0.5, 0.005)
    x, corners = places(made), made.mesh.shell.membrane.corners
    area = np.linalg.norm(np.cross(*(x[corners[:, k]] - x[corners[:, 0]] for k in (1, 2))), axis=1) / 2
    assert area == pytest.approx(made.mesh.shell.membrane.area, rel=0.05)
