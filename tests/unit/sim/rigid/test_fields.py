"""Distances on the device against those of the placed solids, and the features of shapes against their surfaces."""

from pathlib import Path

import numpy as np
import pytest

from sim.geometry.shapes import place
from sim.geometry.spec import Box, Capsule, Cylinder, MeshFile, Placement, Sphere, Torus
from tests.support.in_time import in_time

SHAPES = {
    "box": Box(type="box", size=(0.3, 0.5, 0.2)),
    "sphere": Sphere(type="sphere", radius=0.2),
    "capsule": Capsule(type="capsule", radius=0.1, height=0.3),
    "cylinder": Cylinder(type="cylinder", radius=0.15, height=0.3),
    "torus": Torus(type="torus", radius=0.2, tube_radius=0.07),
    "mesh": MeshFile(type="mesh", file="pymeshfix:examples/StanfordBunny.ply", size=0.5, anchor="center"),
}
PLACEMENT = Placement(position=(1, 2, 3), rotation=({"axis": (1, 2, 3), "angle": 40},))
ALL_IN_TIME = pytest.mark.parametrize("name", [*(name for name in SHAPES if name != "mesh"), *in_time("mesh")])


def _contact_shape(name: str):
    from sim.rigid.collision.shapes import contact_shape

    solid = place(SHAPES[name], PLACEMENT, Path())
    return solid, contact_shape(solid)


def _lookup(shape, points: np.ndarray) -> np.ndarray:
    """Directions and distances of world points [m], shape [n, 4], by the kernels."""
    from sim.device import runtime

    runtime.start(threads=1, arch="cpu")
    from sim.device.compiler import ti
    from sim.device.double import Quaternions, Vectors
    from sim.rigid.body import Body
    from sim.rigid.collision.arrays import shapes
    from sim.rigid.collision.narrow_phase import Shapes, distance

    @ti.kernel
    def look(kinds: ti.template(), count: ti.i32, points: Vectors, pack: Shapes, found: Quaternions):
        for i in range(count):
            found[i] = distance(kinds, 0, points[i], pack)

    found = np.zeros((len(points), 4))
    pack = shapes([Body("body", shape, 0.5, 0.5, 0.0)])
    look(1 << shape.kind, len(points), (points - shape.origin) @ shape.turn, pack, found)
    found[:, :3] = found[:, :3] @ shape.turn.T
    return found


@ALL_IN_TIME
def test_distances_and_directions(name):
    """Exact but for a mesh, whose grid is right to a share of its cell, and beyond it no less than the distance.

    Directions are those in which distances grow.
    """
    solid, shape = _contact_shape(name)
    random = np.random.default_rng(0)
    points = shape.origin + random.uniform(-0.4, 0.4, (400, 3))
    found = _lookup(shape, points)
    exact = solid.signed_distance(points)
    local = np.abs((points - shape.origin) @ shape.turn)
    within = np.all(local < shape.bounds[1], axis=1) if shape.grid else np.ones(400, bool)
    close = shape.grid.cell / 4 if shape.grid else 1e-12
    assert found[within, 3] == pytest.approx(exact[within], abs=close)
    assert np.all(found[~within, 3] > exact[~within] - close)
    assert np.linalg.norm(found[:, :3], axis=1) == pytest.approx(np.ones(400))
    small = 1e-6
    growth = (solid.signed_distance(points + small * found[:, :3]) - exact) / small
    assert np.median(growth) == pytest.approx(1, abs=5e-3 if shape.grid else 1e-3)
    assert np.mean(growth > 0.8) > 0.95


@ALL_IN_TIME
def test_features_lie_on_the_surface(name):
    from sim.rigid.collision.shapes import AXIS, CIRCLE

    solid, shape = _contact_shape(name)
    features = shape.features
    columns = features.kind, features.centre, features.direction, features.rounding
    kind, centre, way, rounding = map(np.array, columns)
    around = np.zeros_like(way)
    around[:, 2] = way[:, 0]
    across = np.where((kind == CIRCLE)[:, None], around, -way)
    # An axis is about the middle of the round side.
    inner = np.where((kind == AXIS)[:, None], 0.0, 1.0)
    for point in (centre + inner * way, centre + inner * across):
        found = solid.signed_distance(shape.origin + point @ shape.turn.T)
        hull_of_a_mesh = found > 0 if name == "mesh" else np.zeros(len(found), bool)
        assert np.abs(found + rounding)[~hull_of_a_mesh].max() < 1e-9


@pytest.mark.slow
def test_a_mesh_has_all_corners_of_its_hull():
    solid, shape = _contact_shape("mesh")
    points = shape.origin + np.array(shape.features.centre) @ shape.turn.T
    for direction in np.random.default_rng(0).normal(size=(20, 3)):
        assert (points @ direction).max() == pytest.approx((solid.mesh.vertices @ direction).max(), abs=1e-9)


def test_a_solid_without_closed_forms_is_met_by_its_mesh():
    from sim.geometry.solids import Solid
    from sim.rigid.collision.shapes import contact_shape

    box = place(SHAPES["box"], PLACEMENT, Path())

    class Other(Solid):
        bounds, volume = box.bounds, box.volume

        def signed_distance(self, points):
            return box.signed_distance(points)

        def mass_properties(self, density):
            return box.mass_properties(density)

    shape = contact_shape(Other(box.pose, box._local))
    points = shape.origin + np.array(shape.features.centre) @ shape.turn.T
    assert len(points) > 8 and shape.grid
    assert np.abs(box.signed_distance(points)).max() < 1e-9


def test_a_primitive_whose_features_nobody_wrote_is_refused(monkeypatch):
    from dataclasses import replace

    from sim.rigid.collision import shapes

    box = place(SHAPES["box"], PLACEMENT, Path())
    cone = replace(shapes.primitive(box), kind=99)
    monkeypatch.setattr(shapes, "primitive", lambda solid: cone)
    with pytest.raises(TypeError, match="contact_shape does not know its features"):
        shapes.contact_shape(box)
