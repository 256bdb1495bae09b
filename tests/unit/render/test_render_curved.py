"""Cloth is drawn with curved triangles, through the points of the simulation."""

import numpy as np
import pytest

from render.content.changing.curved import curved
from render.content.ply import TriangleMesh

CELLS = 16


def sheet(height, cells=CELLS):
    """One of 1 m by 1 m, `height` a function of x and z, with velocity along y."""
    x, z = (axis.ravel() for axis in np.meshgrid(*2 * [np.linspace(-0.5, 0.5, cells + 1)], indexing="ij"))
    corner = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    a, b, c, d = (part.ravel() for part in (corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]))
    triangles = np.stack([a, b, c, a, c, d], axis=1).astype(np.int32).ravel()
    columns = {"x": x, "y": height(x, z), "z": z, "vy": 3 * x, "rest_x": x, "rest_z": z}
    return TriangleMesh({name: column.astype(np.float32) for name, column in columns.items()}, triangles)


def test_a_flat_sheet_stays_flat_with_four_times_the_triangles():
    flat = sheet(lambda x, z: 0.25 * x)
    found = curved(flat)
    assert len(found.triangles) == 4 * len(flat.triangles)
    assert found.columns["y"] == pytest.approx(0.25 * found.columns["x"], abs=1e-6)
    assert found.columns["vy"] == pytest.approx(3 * found.columns["x"], abs=1e-6)
    assert found.columns["rest_x"] == pytest.approx(found.columns["x"], abs=1e-6)


def test_it_faces_where_it_did_and_covers_as_much():
    def area(mesh):
        place = np.stack([mesh.columns[axis] for axis in "xyz"], axis=1).astype(float)
        a, b, c = place[np.asarray(mesh.triangles).reshape(-1, 3)].transpose(1, 0, 2)
        return np.cross(b - a, c - a).sum(axis=0) / 2

    flat = sheet(lambda x, z: 0 * x)
    assert area(curved(flat)) == pytest.approx(area(flat), abs=1e-6)


def test_on_a_cylinder_middles_of_edges_are_on_it_too():
    """The chord of an edge is off by h^2 / 8 R there, the cubic by its fourth power; rims know one side alone."""
    radius, h = 0.5, 0.75 / CELLS
    bent = sheet(lambda x, z: 0 * x)
    angle = 0.75 * bent.columns["x"].astype(float) / radius
    bent.columns["x"], bent.columns["y"] = radius * np.sin(angle), radius * np.cos(angle)
    found = curved(bent)
    places = np.stack([found.columns[axis] for axis in "xyz"], axis=1)
    given = len(bent.columns["x"])
    assert places[:given] == pytest.approx(np.stack([bent.columns[axis] for axis in "xyz"], axis=1))
    rest = np.stack([found.columns["rest_x"], found.columns["rest_z"]], axis=1)[given:]
    inside = np.abs(rest).max(axis=1) < 0.5 - 1.2 / CELLS
    off = np.abs(np.hypot(places[given:, 0], places[given:, 1]) - radius)[inside]
    chord = h**2 / 8 / radius
    assert off.max() < 0.02 * chord
