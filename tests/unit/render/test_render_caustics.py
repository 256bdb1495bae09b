"""Light that water and glass focus, and how much of it comes through."""

from __future__ import annotations

import json
import math
import subprocess
import sys

import numpy as np
import pytest
import trimesh

from render.content.nodes import rgba

EXTENT = {"min": [-1, 0, -1], "max": [1, 1, 1]}
SETTINGS = {
    "resolution": [48, 48],
    "samples": 64,
    "noise_threshold": 0,
    "denoise": False,
    "motion_blur": False,
    "passes": ["depth"],
    "firefly_clamp": 0,
    "ground": {"enabled": False},
    "background": {"type": "plain", "color": "#000000"},
    "lights": {"sun": {"elevation": 50, "angle": 1}, "environment": {"strength": 0}},
    "materials": {"floor": {"type": "matte", "color": "#404040"}},
}


def light(tmp_path, write_mesh, slab=None, ball=None, **settings):
    """Light of a floor at y = 0 as a camera sees it that looks straight down on 0.4 m of it [48, 48]."""
    import OpenEXR

    simulation, surface, out = (tmp_path / name for name in ("simulation", "surface", "out"))
    for folder in (simulation, surface):
        folder.mkdir(parents=True)
    bodies = {"floor": trimesh.creation.box([4, 0.2, 4], trimesh.transformations.translation_matrix([0, -0.1, 0]))}
    bodies |= {} if ball is None else {"ball": ball}
    rows = ["frame,time,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz"]
    for name, mesh in bodies.items():
        write_mesh(simulation / f"body_{name}.ply", "x y z", mesh.vertices.tolist(), mesh.faces.tolist())
        rows.append(f"0,0,{name},0,0,0,1,0,0,0,0,0,0,0,0,0")
    (simulation / "bodies.csv").write_text("\n".join(rows) + "\n")
    (simulation / "summary.json").write_text(json.dumps({"extent": EXTENT}))
    command = [sys.executable, "-m", "render", "--spec", json.dumps(SETTINGS | settings), "--frames", "0:0"]
    command += ["--simulation", str(simulation), "--out", str(out), "--threads", "1"]
    if slab is not None:
        # corners of their own for each side, with its normal
        vertices = [(*c, *n, 0, 0, 0) for t, n in zip(slab.triangles, slab.face_normals, strict=True) for c in t]
        triangles = np.arange(len(vertices)).reshape(-1, 3).tolist()
        write_mesh(surface / "surface_00000.ply", "x y z nx ny nz vx vy vz", vertices, triangles)
        command += ["--surface", str(surface)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=200)
    assert done.returncode == 0, done.stderr
    with OpenEXR.File(str(out / "00000.exr"), separate_channels=True) as file:
        return file.channels()["ViewLayer.Combined.G"].pixels


@pytest.mark.parametrize("color", ["#ffffff", "#8fbfbf"])
def test_light_through_a_level_surface_is_that_of_the_laws(tmp_path, write_mesh, color):
    """Both ways weaken it by Fresnel's law alike. Refracted rays are steeper, so that less of them is absorbed (Beer
    and Lambert); and a diffuse floor in the water gives off its light into all of the half-space there, but only what
    is within the critical angle leaves it: a share of 1 / n^2 (Snell), which straight rays know nothing of. The floor
    is so dark that what is thrown back to it counts for less than the bound."""
    depth, clarity, ior, elevation = 0.3, 0.5, 1.333, math.radians(50)
    slab = trimesh.creation.box(
        [2, depth + 0.01, 2], trimesh.transformations.translation_matrix([0, depth / 2 - 0.005, 0])
    )
    above = {"position": [0, 5, 0.01], "target": [0, 0, 0], "field_of_view": 4}
    settings = {"water": {"color": color, "clarity": clarity}, "camera": above}
    straight = light(tmp_path / "straight", write_mesh, slab, **settings)
    refracted = light(tmp_path / "refracted", write_mesh, slab, caustics=True, **settings)
    assert np.median(straight) > 0.01
    longer = depth / math.sin(elevation) - depth / math.cos(math.asin(math.cos(elevation) / ior))
    left = rgba([int(color[k : k + 2], 16) / 255 for k in (1, 3, 5)])[1]
    expected = left ** (-longer / clarity) / ior**2
    assert np.median(refracted) / np.median(straight) == pytest.approx(expected, rel=0.02)


def test_a_glass_ball_has_a_bright_focus_in_a_dark_shadow(tmp_path, write_mesh):
    """A ball of index 1.5 has its focus half a radius behind itself; the floor is half way. Rays near its rim go
    elsewhere. Without caustics its shadow is that of a window."""
    radius = 0.2
    ball = trimesh.creation.icosphere(4, radius)
    ball.apply_translation([0, 1.25 * radius, 0])
    look = SETTINGS["materials"] | {"ball": {"type": "glass"}}
    camera = {"position": [0, 1.2, 4], "target": [0, 0, 0], "field_of_view": 10}
    views = {
        caustics: light(
            tmp_path / str(caustics), write_mesh, ball=ball, materials=look, camera=camera, caustics=caustics
        )
        for caustics in (False, True)
    }
    lit = float(np.median(views[True][-8:]))
    shadow = (slice(21, 32), slice(18, 40))
    assert views[True][shadow].max() > 1.5 * lit and views[True][shadow].min() < 0.1 * lit
    assert views[False][shadow].max() < 1.1 * lit and views[False][shadow].min() > 0.5 * lit
