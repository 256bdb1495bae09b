"""Where images lie on bodies, by closed forms: up is up, left is left, seen from outside."""

from array import array
from types import SimpleNamespace

import numpy as np
import pytest

from render.content.ply import TriangleMesh
from render.errors import Unusable
from render.texturing.projection import project
from tests.support.textured import cube

TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


UPRIGHT = np.eye(3)


def mesh(points, triangles, turned=UPRIGHT):
    columns = dict(zip("xyz", np.asarray(points, dtype=float).T, strict=True))
    return TriangleMesh(columns, np.asarray(triangles, np.int32).ravel(), turned=tuple(turned.ravel()))


def look(**settings):
    return SimpleNamespace(**{"type": "plastic", "projection": None, "texture_size": None} | settings)


@pytest.mark.parametrize("turned", [UPRIGHT, TURN], ids=["upright", "turned"])
@pytest.mark.parametrize("moved", [0, 3])
def test_a_box_has_the_image_upright_on_each_side(turned, moved):
    points, uv, triangles = cube()
    found = project(mesh((points + moved) @ turned.T, triangles, turned), look(), 1.0)
    assert np.reshape(found, (-1, 3, 2)) == pytest.approx(uv[triangles], abs=1e-6)


def test_its_size_and_shape_are_kept():
    """An image twice as high as wide, 0.5 m wide, on a square of 1 m: two across, one up."""
    points, uv, triangles = cube()
    found = np.reshape(project(mesh(points, triangles), look(texture_size=0.5), 2.0), (-1, 3, 2))
    assert np.ptp(found, axis=(0, 1)) == pytest.approx([2, 1])
    assert (found - 0.5) / [2, 1] + 0.5 == pytest.approx(uv[triangles], abs=1e-6)


def test_around_a_sphere_longitude_and_latitude_count():
    import trimesh

    ball = trimesh.creation.icosphere(subdivisions=2)
    found = np.reshape(project(mesh(ball.vertices, ball.faces), look(projection="sphere"), 1.0), (-1, 3, 2))
    x, y, z = np.moveaxis(ball.vertices[ball.faces], 2, 0)
    assert found[..., 1] == pytest.approx(np.arcsin(np.clip(y, -1, 1)) / np.pi + 0.5, abs=1e-6)
    away = np.hypot(x, z) > 1e-6
    off = (found[..., 0] - np.arctan2(x, z) / (2 * np.pi) - 0.5)[away]
    assert off == pytest.approx(np.round(off), abs=1e-6)
    assert np.ptp(found[..., 0], axis=1).max() < 0.5, "none reaches across the seam"


def test_the_mesh_file_decides_where_it_has_uv():
    points, _, triangles = cube()
    source = mesh(points, triangles)
    own = array("f", range(72))
    assert project(TriangleMesh(source.columns, source.triangles, own), look(), 1.0) is own
    assert project(TriangleMesh(source.columns, source.triangles, own), look(projection="box"), 1.0) is not own
    with pytest.raises(Unusable, match="no UV coordinates"):
        project(source, look(projection="uv"), 1.0)


def test_it_needs_no_numpy():
    points, uv, triangles = cube()
    columns = {name: array("f", column) for name, column in zip("xyz", points.T, strict=True)}
    found = project(TriangleMesh(columns, array("i", triangles.ravel().tolist())), look(), 1.0)
    assert np.reshape(found, (-1, 3, 2)) == pytest.approx(uv[triangles], abs=1e-6)
