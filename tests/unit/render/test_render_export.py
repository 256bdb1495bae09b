"""Files for other programs hold the animation: read again by Blender, they show what the frames show."""

import json
import shutil
import subprocess
import sys

import pytest

TINY = {"resolution": [32, 18], "samples": 1}
LOOK = """
import bpy, sys, json
path = sys.argv[-1]
if path.endswith(".blend"):
    bpy.ops.wm.open_mainfile(filepath=path)
else:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    (bpy.ops.wm.alembic_import if path.endswith(".abc") else bpy.ops.wm.usd_import)(filepath=path)
found = []
for frame in (0, 1):
    bpy.context.scene.frame_set(frame)
    graph = bpy.context.evaluated_depsgraph_get()
    seen = {}
    for thing in bpy.data.objects:
        if thing.type == "MESH" and not thing.evaluated_get(graph).hide_render:
            mesh = thing.evaluated_get(graph).to_mesh()
            places = [thing.evaluated_get(graph).matrix_world @ vertex.co for vertex in mesh.vertices]
            seen[thing.name] = [len(places), *([min(p[a] for p in places) for a in range(3)] if places else [])]
    found.append(seen)
packed = all(image.packed_file for image in bpy.data.images if image.source == "FILE")
print("SEEN " + json.dumps([found, packed, bpy.data.objects.get("camera") is not None]))
"""
KINDS = [
    "usdc",
    "abc",
    "blend",
    pytest.param("stock", marks=pytest.mark.skipif(not shutil.which("blender"), reason="no Blender")),
]


@pytest.fixture
def moving(film):
    """The film, whose body is a metre further to the right in frame 1."""
    simulation, surface = film
    table = simulation / "bodies.csv"
    head, first, second = table.read_text().splitlines()
    table.write_text("\n".join([head, first, second.replace("rock,-0.5", "rock,0.5")]) + "\n")
    return simulation, surface


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_read_again_is_what_was_there(moving, tmp_path, kind):
    """Corners: the body's lowest is 0.3 left of its place, -0.3 + 0.3 high; water is there in frame 0 only."""
    simulation, surface = moving
    stock = kind == "stock"
    path = tmp_path / f"film.{'blend' if stock else kind}"
    command = [sys.executable, "-m", "render", "--spec", json.dumps(TINY), "--frames", "0:1", "--out", str(tmp_path)]
    command += ["--simulation", str(simulation), "--surface", str(surface), "--export", str(path)]
    command += ["--blender", shutil.which("blender")] if stock else []
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    script = tmp_path / "look.py"
    script.write_text(LOOK)
    opener = (
        ["blender", "-b", "--factory-startup", "--python-exit-code", "3", "--python"] if stock else [sys.executable]
    )
    looked = subprocess.run([*opener, str(script), "--", str(path)], capture_output=True, text=True, timeout=120)
    line = next((line for line in looked.stdout.splitlines() if line.startswith("SEEN ")), None)
    assert line is not None, looked.stdout + looked.stderr
    (first, second), packed, camera = json.loads(line.removeprefix("SEEN "))
    for seen, x in ((first, -0.8), (second, 0.2)):
        rock = next(value for name, value in seen.items() if name.startswith("rock"))
        assert rock == pytest.approx([4, x, -0.4, 0.0], abs=1e-5)
    water = [
        [value for name, value in seen.items() if name.startswith("water") and value[0] > 3] for seen in (first, second)
    ]
    assert water[1] == [] and water[0][0] == pytest.approx([4, 0.2, -0.4, 0.0], abs=1e-5)
    if kind in ("blend", "stock"):
        assert packed and camera


def test_kinds_that_can_not_be_written_are_refused(film, tmp_path):
    command = [sys.executable, "-m", "render", "--spec", "{}", "--frames", "0:1", "--out", str(tmp_path)]
    command += ["--simulation", str(film[0]), "--export", str(tmp_path / "film.obj")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 2 and ".usdc" in done.stderr


@pytest.mark.parametrize("damage", ["gone", "cut short"])
@pytest.mark.parametrize("kind", ["usdc", "abc", "blend"])
def test_a_frame_that_cannot_be_read_leaves_no_file(film, tmp_path, kind, damage):
    """Blender prints what goes wrong while an exporter asks for a frame, and exports the frame before it once more."""
    simulation, surface = film
    last = surface / "surface_00001.ply"
    shutil.copy(surface / "surface_00000.ply", last)
    last.unlink() if damage == "gone" else last.write_bytes(last.read_bytes()[:-20])
    path = tmp_path / f"film.{kind}"
    command = [sys.executable, "-m", "render", "--spec", json.dumps(TINY), "--frames", "0:1", "--out", str(tmp_path)]
    command += ["--simulation", str(simulation), "--surface", str(surface), "--export", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 2 and "surface_00001.ply" in done.stderr, done.stderr
    assert not list(tmp_path.glob("*film*"))
