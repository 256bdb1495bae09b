"""Light that passes through water and glass, against the laws of Fresnel and of Beer and Lambert."""

import json
import subprocess
import sys

import numpy as np
import pytest

from render.content.nodes import rgba
from render.content.world import BACKDROP

THICKNESS = 0.2
HALF = 0.5
"""Of the slab's width [m]."""
SHARE = 0.005
"""Each path is reflected at a surface or not, one in 25 of glass: over the 65,536 of the picture, the mean has a
standard deviation of sqrt(0.04 / 65,536), a thousandth."""
SETTINGS = {
    "resolution": [32, 32],
    "samples": 64,
    "noise_threshold": 0,
    "denoise": False,
    "motion_blur": False,
    "passes": ["depth"],
    "ground": {"enabled": False},
    "background": {"type": "plain", "color": "#ffffff"},
    # What is reflected is dark; the sun, which some light must be, stands aside.
    "lights": {"sun": {"strength": 1e-6}, "environment": {"strength": 0}},
    "camera": {"position": [0, 0, 20], "target": [0, 0, 0], "field_of_view": 2},
}


def slab(path, write_mesh):
    """A closed plate across the view, with corners of their own for each side."""
    vertices, triangles = [], []
    size = (HALF, HALF, THICKNESS / 2)
    for axis in range(3):
        first, second = (axis + 1) % 3, (axis + 2) % 3
        for sign in (-1, 1):
            start = len(vertices)
            for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                place, normal = [0.0] * 3, [0.0] * 3
                place[axis], place[first], place[second] = sign * size[axis], a * size[first], b * size[second]
                normal[axis] = sign
                vertices.append((*place, *normal, 0, 0, 0))
            corners = (0, 1, 2, 3) if sign > 0 else (0, 3, 2, 1)
            triangles += [tuple(start + corners[k] for k in face) for face in ((0, 1, 2), (0, 2, 3))]
    return write_mesh(path, "x y z nx ny nz vx vy vz", vertices, triangles)


def seen_through(tmp_path, write_mesh, of_fluid, **settings):
    """Light of a white backdrop behind a slab, over that without it: red, green, blue."""
    import OpenEXR

    simulation, surface, out = (tmp_path / name for name in ("simulation", "surface", "out"))
    simulation.mkdir()
    surface.mkdir()
    slab(surface / "surface_00000.ply" if of_fluid else simulation / "body_plate.ply", write_mesh)
    if not of_fluid:
        head = "frame,time,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz"
        (simulation / "bodies.csv").write_text(f"{head}\n0,0,plate,0,0,0,1,0,0,0,0,0,0,0,0,0\n")
    (simulation / "summary.json").write_text(json.dumps({"extent": {"min": [-0.5] * 3, "max": [0.5] * 3}}))
    command = [sys.executable, "-m", "render", "--spec", json.dumps(SETTINGS | settings), "--frames", "0:0"]
    command += ["--simulation", str(simulation), "--out", str(out), "--threads", "1"]
    command += ["--surface", str(surface)] if of_fluid else []
    done = subprocess.run(command, capture_output=True, text=True, timeout=200)
    assert done.returncode == 0, done.stderr
    with OpenEXR.File(str(out / "00000.exr"), separate_channels=True) as file:
        channels = {name: channel.pixels for name, channel in file.channels().items()}
    picture = [channels[f"ViewLayer.Combined.{channel}"] for channel in "RGB"]
    return np.array([float(pixels.mean()) for pixels in picture]) / BACKDROP


def through_slab(ior, crossing, surface=1.0):
    """Share of light that a slab lets through head-on: Fresnel at each surface, what is left of light that crosses it
    once, and of light at each surface. What is reflected within leaves by one side or the other, and sees the same
    backdrop there; what is reflected outside sees the dark."""
    reflected = ((ior - 1) / (ior + 1)) ** 2
    return (1 - reflected) ** 2 * surface**2 * crossing / (1 - reflected * surface * crossing)


@pytest.mark.parametrize("clarity", [THICKNESS, THICKNESS / 2])
def test_water_absorbs_with_the_way_through_it(tmp_path, write_mesh, clarity):
    color = (0.8, 0.6, 0.9)
    water = {"color": color, "clarity": clarity, "ior": 1.333}
    found = seen_through(tmp_path, write_mesh, True, water=water)
    crossing = np.array(rgba(color)[:3]) ** (THICKNESS / clarity)
    assert found == pytest.approx(through_slab(1.333, crossing), rel=SHARE)


def test_glass_has_its_colour_once_for_each_surface(tmp_path, write_mesh):
    color = (0.9, 0.95, 0.85)
    found = seen_through(tmp_path, write_mesh, False, materials={"plate": {"type": "glass", "color": color}})
    assert found == pytest.approx(through_slab(1.5, 1.0, np.array(rgba(color)[:3])), rel=SHARE)
