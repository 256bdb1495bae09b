"""Foam as a layer on the water: how much of it is where, and what is left of it as balls."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

from common.ply import write_points, write_surface
from render.content.ply import TriangleMesh
from sim.foam.particles import BUBBLE, FOAM, FOAM_POINT, SPRAY

COUNT, EDGE = 41, 0.01
SIDE = (COUNT - 1) * EDGE


def sheet(height=0.0):
    """Vertices, normals and triangles of level water, a square around the vertical axis."""
    line = np.linspace(-SIDE / 2, SIDE / 2, COUNT)
    x, z = np.meshgrid(line, line, indexing="ij")
    vertices = np.stack([x.ravel(), np.full(x.size, height), z.ravel()], axis=1)
    at = np.arange(COUNT * COUNT).reshape(COUNT, COUNT)
    a, b, c, d = at[:-1, :-1].ravel(), at[1:, :-1].ravel(), at[1:, 1:].ravel(), at[:-1, 1:].ravel()
    triangles = np.concatenate([np.stack([a, c, b], axis=1), np.stack([a, d, c], axis=1)])
    return vertices, np.tile((0.0, 1.0, 0.0), (len(vertices), 1)), triangles


def water(vertices, normals, triangles) -> TriangleMesh:
    columns = dict(zip(("x", "y", "z", "nx", "ny", "nz"), np.concatenate([vertices, normals], axis=1).T, strict=True))
    return TriangleMesh(columns, triangles.ravel())


def foam(places, kind, radius=0.002) -> np.ndarray:
    points = np.zeros(len(places), FOAM_POINT)
    for axis, column in zip("xyz", np.reshape(places, (-1, 3)).T, strict=True):
        points[axis] = column
    points["radius"], points["kind"] = radius, kind
    return points


def laid(surface, points):
    pytest.importorskip("bpy")
    from render.content.changing.froth import laid as lay

    return lay(surface, TriangleMesh({name: points[name] for name in points.dtype.names}, np.empty(0, int)))


def area_of(surface, triangles) -> float:
    """Integral of the density over the surface: piecewise linear, so that a third of each triangle belongs to each of
    its corners [m^2]."""
    vertices = np.stack([surface.columns[axis] for axis in "xyz"], axis=1)
    corner = vertices[triangles]
    area = np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1) / 2
    return float((area * surface.columns["foam"].astype(float)[triangles].mean(axis=1)).sum())


def test_no_foam_is_lost_on_its_way_to_the_surface():
    """The integral of the density is the cross-section of all that floats; to rounding of single precision."""
    dice = np.random.default_rng(0)
    vertices, normals, triangles = sheet()
    vertices[:, 1] = 0.01 * np.sin(30 * vertices[:, 0])
    places = dice.uniform(-0.15, 0.15, (500, 3)) * (1, 0.05, 1)
    points = foam(places, FOAM, dice.uniform(0.001, 0.003, 500))
    surface, spray, bubbles = laid(water(vertices, normals, triangles), points)
    section = float((np.pi * points["radius"].astype(float) ** 2).sum())
    assert spray.vertex_count() == bubbles.vertex_count() == 0
    assert area_of(surface, triangles) == pytest.approx(section, rel=1e-5)
    assert surface.columns["foam"].min() >= 0


def test_foam_lies_where_it_floats():
    """All within a few edges of its place, and most where it is densest."""
    vertices, normals, triangles = sheet()
    surface, _, _ = laid(water(vertices, normals, triangles), foam([(0.1, 0.003, -0.05)] * 20, FOAM))
    density = surface.columns["foam"]
    away = np.linalg.norm(vertices - (0.1, 0.0, -0.05), axis=1)
    assert away[density.argmax()] < EDGE
    assert away[density > 0].max() < 6 * EDGE


def test_kinds_part():
    """Spray flies, bubbles deep below stay air, and those that have come up are foam, as at default settings."""
    kinds = [SPRAY, BUBBLE, BUBBLE, FOAM, FOAM, FOAM]
    heights = [0.1, -0.1, -0.002, 0.0, -0.1, 0.1]
    points = foam([(0.0, height, 0.0) for height in heights], kinds)
    vertices, normals, triangles = sheet()
    surface, spray, bubbles = laid(water(vertices, normals, triangles), points)
    assert spray.columns["y"] == pytest.approx([0.1, 0.1])
    assert bubbles.columns["y"] == pytest.approx([-0.1, -0.1])
    assert area_of(surface, triangles) == pytest.approx(2 * np.pi * 0.002**2, rel=1e-5)


def test_what_is_beside_a_wall_is_no_foam_on_it():
    """Water that ends flush with a wall looks just where that does; the same, bent a little, is a wave."""
    vertices, _, triangles = sheet()
    upright = vertices[:, [1, 2, 0]]
    normals = np.tile((1.0, 0.0, 0.0), (len(upright), 1))
    points = foam([(-0.003, 0.0, 0.0)], FOAM)
    flush, _, air = laid(water(upright, normals, triangles), points)
    assert area_of(flush, triangles) == 0.0
    normals[:, 2] = 0.02
    wave, _, air = laid(water(upright, normals, triangles), points)
    assert area_of(wave, triangles) > 0
    assert air.vertex_count() == 0


def test_there_may_be_none():
    vertices, normals, triangles = sheet()
    surface, spray, bubbles = laid(water(vertices, normals, triangles), foam([], FOAM))
    assert not surface.columns["foam"].any()
    assert spray.vertex_count() == bubbles.vertex_count() == 0
    nothing = water(np.empty((0, 3)), np.empty((0, 3)), np.empty((0, 3), int))
    _, spray, bubbles = laid(nothing, foam([(0, 0, 0), (0, 0, 0)], [SPRAY, BUBBLE]))
    assert (spray.vertex_count(), bubbles.vertex_count()) == (1, 1)


def picture(folder, points, **settings) -> np.ndarray:
    """Linear light of a picture from above of dark water on which foam floats, shape [n, n, 3]."""
    simulation, surface, there, out = (folder / name for name in ("simulation", "surface", "foam", "out"))
    for made in (simulation, surface, there):
        made.mkdir(parents=True)
    extent = {"min": [-SIDE / 2, -0.1, -SIDE / 2], "max": [SIDE / 2, 0.1, SIDE / 2]}
    (simulation / "summary.json").write_text(json.dumps({"extent": extent}))
    vertices, normals, triangles = sheet()
    write_surface(surface / "surface_00000.ply", vertices, normals, np.zeros_like(vertices), triangles)
    write_points(there / "foam_00000.ply", points)
    spec = {
        "resolution": [40, 40],
        "samples": 16,
        "denoise": False,
        "ground": {"enabled": False},
        "camera": {"position": [0, 2, 0.01], "target": [0, 0, 0], "field_of_view": 8},
        "background": {"type": "plain", "color": "#000000"},
        "water": {"type": "matte", "color": "#000000"},
        "view_transform": "Standard",
    }
    command = [sys.executable, "-m", "render", "--spec", json.dumps(spec | settings), "--frames", "0:0"]
    command += ["--simulation", str(simulation), "--surface", str(surface), "--foam", str(there), "--out", str(out)]
    done = subprocess.run([*command, "--threads", "1"], capture_output=True, text=True, timeout=400)
    assert done.returncode == 0, done.stderr
    value = np.asarray(Image.open(out / "00000.png").convert("RGB"), float) / 255
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def test_foam_is_seen_as_a_soft_layer(tmp_path):
    """White all over where much floats, less where there is a fifth, black without; other looks make balls of it."""
    dice = np.random.default_rng(1)
    many = dice.uniform(-0.1, 0.1, (6000, 3)) * (1, 0, 1) - (0.05, 0, 0)
    few = dice.uniform(-0.1, 0.1, (300, 3)) * (0.5, 0, 1) + (0.1, 0, 0)
    points = foam(np.concatenate([many[many[:, 0] < 0], few[few[:, 0] > 0.05]]), FOAM, 0.0015)
    soft = picture(tmp_path / "layer", points).mean(axis=2)
    left, right = soft[15:25, 14:17], soft[15:25, 26:30]
    assert left.min() > 0.3
    assert 0.02 < right.mean() < 0.7 * left.mean()
    assert soft[0].max() < 0.03
    balls = picture(tmp_path / "balls", points, foam={"type": "matte", "color": "#ff0000"})
    assert balls[..., 0].max() > 5 * balls[..., 1].max()
