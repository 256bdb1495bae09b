"""What exported files hold, read again by USD's library, as glTF's JSON, and by Blender: as many points and vertices as
the stages left, in their places, in metres and with y up, at their times, of what they are made of."""

import json
import struct
import subprocess
import sys

import numpy as np
import pytest

from common.ply import FLUID_POINT, write_points
from sim.foam.particles import FOAM_POINT

FPS = 12.5
RADIUS = 0.05
SETTINGS = {"resolution": [32, 18], "samples": 1, "water": {"color": "#48abc9", "roughness": 0.1}}
TINT = (0.0648, 0.4072, 0.5841)
"""The water's colour in linear light."""
FOAM = [(0.5, 0.25, -0.75), (-0.5, 0.5, 0.25), (0.0, 1.0, 0.125)]
SIZES = [0.01, 0.02, 0.03]
USD = """
import bpy, json, sys
try:
    import pxr
except ImportError:
    bpy.utils.expose_bundled_modules()
from pxr import Usd, UsdGeom, UsdShade
stage = Usd.Stage.Open(sys.argv[-1])
def points(path, time):
    cloud = UsdGeom.Points.Get(stage, path)
    to_world = UsdGeom.XformCache(time).GetLocalToWorldTransform(cloud.GetPrim())
    places = [list(to_world.Transform(place)) for place in cloud.GetPointsAttr().Get(time)]
    ways = [list(to_world.TransformDir(way)) for way in cloud.GetVelocitiesAttr().Get(time)]
    return [places, list(cloud.GetWidthsAttr().Get(time)), ways]
water = UsdGeom.Mesh.Get(stage, "/root/water/water")
material = UsdShade.MaterialBindingAPI(water.GetPrim()).ComputeBoundMaterial()[0]
shader = material.ComputeSurfaceSource()[0]
inputs = {one.GetBaseName(): one.Get() for one in shader.GetInputs()}
inputs["diffuseColor"] = list(inputs["diffuseColor"])
rock = UsdGeom.XformCache(1).GetLocalToWorldTransform(stage.GetPrimAtPath("/root/rock/rock"))
print("SEEN " + json.dumps({
    "axis": UsdGeom.GetStageUpAxis(stage), "metre": UsdGeom.GetStageMetersPerUnit(stage),
    "fps": stage.GetTimeCodesPerSecond(), "span": [stage.GetStartTimeCode(), stage.GetEndTimeCode()],
    "shader": shader.GetIdAttr().Get(), "inputs": inputs, "rock": list(rock.ExtractTranslation()),
    "foam": [points("/root/foam/PointCloud", time) for time in (0, 1)],
    "particles": [points("/root/particles/PointCloud", time) for time in (0, 1)],
    "ids": list(stage.GetPrimAtPath("/root/particles/PointCloud").GetAttribute("primvars:particle_id").Get(1)),
}))
"""
BLENDER = """
import bpy, json, os, sys
path, fps = sys.argv[-2], float(sys.argv[-1])
kind = path.rpartition(".")[2]
if kind == "blend":
    bpy.ops.wm.open_mainfile(filepath=path)
else:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    stage = bpy.context.scene
    stage.render.fps, stage.render.fps_base = 100, 1.0
    load = {"abc": bpy.ops.wm.alembic_import, "usdc": bpy.ops.wm.usd_import, "glb": bpy.ops.import_scene.gltf}
    load[kind](filepath=path)
found = []
for frame in (0, 1):
    seconds = kind in ("abc", "glb")
    bpy.context.scene.frame_set(round(frame * 100 / fps) if seconds else frame)
    graph = bpy.context.evaluated_depsgraph_get()
    seen = {}
    for thing in bpy.data.objects:
        shown = thing.evaluated_get(graph)
        if shown.hide_render or max(shown.matrix_world.to_scale()) < 1e-6 or thing.type not in ("MESH", "POINTCLOUD"):
            continue
        data = shown.data if thing.type == "POINTCLOUD" else thing.data if kind == "blend" else shown.data
        own = data.points if thing.type == "POINTCLOUD" else data.vertices
        known = [name for name in ("radius", "_RADIUS", "foam_radius") if name in data.attributes]
        sizes = data.attributes[known[0]] if known else None
        seen[thing.name] = [
            sorted([round(value, 5) for value in shown.matrix_world @ one.co] for one in own),
            sorted(round(one.value, 5) for one in sizes.data) if sizes and len(own) else [],
        ]
    found.append(seen)
print("SEEN " + json.dumps(found), flush=True)
os._exit(0)
"""


@pytest.fixture
def stages(film, tmp_path):
    """The film with a moving rock, foam in frame 1 alone, and two particles of the fluid, then five."""
    simulation, surface = film
    table = simulation / "bodies.csv"
    head, first, second = table.read_text().splitlines()
    table.write_text("\n".join([head, first, second.replace("rock,-0.5", "rock,0.5")]) + "\n")
    foam = tmp_path / "foam"
    foam.mkdir()
    for frame, count in enumerate((0, 3)):
        records = np.zeros(count, FOAM_POINT)
        for axis, column in enumerate("xyz"):
            records[column] = [place[axis] for place in FOAM[:count]]
        records["radius"], records["vy"], records["vz"] = SIZES[:count], 3.0, 1.0
        write_points(foam / f"foam_{frame:05d}.ply", records)
    for frame, count in enumerate((2, 5)):
        records = np.zeros(count, FLUID_POINT)
        records["x"], records["y"], records["id"] = np.arange(count) / 8, 0.5, np.arange(count) + 7
        records["vx"] = np.arange(count) + 0.5
        write_points(simulation / f"fluid_{frame:05d}.ply", records)
    return simulation, surface, foam


def export(stages, path, *more, expected=0):
    simulation, surface, foam = stages
    command = [sys.executable, "-m", "render", "--spec", json.dumps(SETTINGS), "--frames", "0:1", "--fps", str(FPS)]
    command += ["--simulation", str(simulation), "--surface", str(surface), "--foam", str(foam)]
    command += ["--out", str(path.parent / "out"), "--export", str(path), *more]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == expected, done.stderr
    return done


def look(tmp_path, script, *arguments):
    file = tmp_path / "look.py"
    file.write_text(script)
    looked = subprocess.run(
        [sys.executable, str(file), *map(str, arguments)], capture_output=True, text=True, timeout=120
    )
    line = next((line for line in looked.stdout.splitlines() if line.startswith("SEEN ")), None)
    assert line is not None, looked.stdout + looked.stderr
    return json.loads(line.removeprefix("SEEN "))


def test_usd_by_its_own_library(stages, tmp_path):
    path = tmp_path / "film.usdc"
    export(stages, path, "--particles", str(RADIUS))
    seen = look(tmp_path, USD, path)
    assert (seen["axis"], seen["metre"], seen["span"]) == ("Y", 1.0, [0.0, 1.0])
    assert seen["fps"] == pytest.approx(FPS)
    assert seen["rock"] == pytest.approx([0.5, 0.3, 0.0], abs=1e-6)
    assert seen["shader"] == "UsdPreviewSurface"
    assert seen["inputs"]["ior"] == pytest.approx(1.333)
    assert seen["inputs"]["roughness"] == pytest.approx(0.1)
    assert seen["inputs"]["opacity"] == pytest.approx(0.2)
    assert seen["inputs"]["diffuseColor"] == pytest.approx(TINT, abs=1e-4)
    (_, widths, _), (places, sizes, ways) = seen["foam"]
    assert widths == [0.0]
    assert np.array(places) == pytest.approx(np.array(FOAM), abs=1e-6)
    assert sizes == pytest.approx([2 * size for size in SIZES])
    assert np.array(ways) == pytest.approx(np.array([[0, 3, 1]] * 3), abs=1e-5)
    assert [len(places) for places, _, _ in seen["particles"]] == [2, 5]
    assert seen["particles"][1][0][4] == pytest.approx([0.5, 0.5, 0.0], abs=1e-6)
    assert seen["particles"][1][1] == pytest.approx([2 * RADIUS] * 5)
    assert seen["ids"] == [7, 8, 9, 10, 11]


@pytest.mark.parametrize("kind", ["usdc", "abc", "glb", "blend"])
def test_blender_shows_what_was_there(stages, tmp_path, kind):
    """With z up: (x, -z, y). Frames are at their times where files count seconds."""
    path = tmp_path / f"film.{kind}"
    export(stages, path, "--particles", str(RADIUS))
    found = look(tmp_path, BLENDER, path, FPS)
    # USD's points are named after their kind, the foam's first
    names = {"usdc": ("PointCloud", "PointCloud.001")}.get(kind, ("foam", "particles"))

    def named(frame, name):
        whole = [value for key, value in found[frame].items() if key == name or key.startswith(f"{name}_")]
        return whole[0] if whole else [[], []]

    if kind == "usdc" and len(named(1, names[0])[0]) != 3:
        names = names[::-1]
    places, sizes = named(1, names[0])
    assert np.array(places) == pytest.approx(np.array(sorted((x, -z, y) for x, y, z in FOAM)), abs=1e-4)
    assert sizes == pytest.approx(SIZES, abs=1e-4)
    assert [len(named(frame, names[1])[0]) for frame in (0, 1)] == [2, 5]
    assert named(1, names[1])[1] == pytest.approx([RADIUS] * 5, abs=1e-4)
    first = [round(value, 4) for value in min(named(0, "rock")[0])]
    assert first == pytest.approx([-0.8, 0.3, 0.0], abs=1e-4)
    assert min(named(1, "rock")[0]) == pytest.approx([0.2, 0.3, 0.0], abs=1e-4)
    assert len(named(0, "water")[0]) == 4


@pytest.mark.parametrize("frame", [0, 1])
@pytest.mark.parametrize("kind", ["usdc", "abc", "glb", "blend"])
def test_a_body_that_is_not_there_yet_or_no_more_is_not_shown(stages, tmp_path, kind, frame):
    table = stages[0] / "bodies.csv"
    lines = table.read_text().splitlines()
    table.write_text("\n".join([lines[0], lines[1 + frame]]) + "\n")
    path = tmp_path / f"film.{kind}"
    export(stages, path)
    found = look(tmp_path, BLENDER, path, FPS)
    assert ["rock" in seen for seen in found] == [frame == 0, frame == 1]


def test_gltf_has_clear_water_and_one_animation(stages, tmp_path):
    """Times are those of the frames over FPS; what changes its shape has its size in its frame alone."""
    path = tmp_path / "film.glb"
    export(stages, path)
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    scene = json.loads(data[20 : 20 + length])
    binary = data[28 + length :]

    def read(index):
        accessor = scene["accessors"][index]
        view = scene["bufferViews"][accessor["bufferView"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        return np.frombuffer(binary, "<f4", width * accessor["count"], start).reshape(-1, width)

    water = next(material for material in scene["materials"] if material["name"] == "water")
    extensions = water["extensions"]
    assert extensions["KHR_materials_ior"]["ior"] == pytest.approx(1.333)
    assert extensions["KHR_materials_transmission"]["transmissionFactor"] == 1
    assert extensions["KHR_materials_volume"]["attenuationColor"] == pytest.approx(TINT, abs=1e-4)
    assert water["pbrMetallicRoughness"]["roughnessFactor"] == pytest.approx(0.1)
    ground = next(material for material in scene["materials"] if material["name"] == "ground")
    assert max(ground["pbrMetallicRoughness"]["baseColorFactor"][:3]) < 0.8
    (animation,) = scene["animations"]
    tracks = {
        (scene["nodes"][channel["target"]["node"]]["name"], channel["target"]["path"]): animation["samplers"][
            channel["sampler"]
        ]
        for channel in animation["channels"]
    }
    rock = tracks["rock", "translation"]
    assert rock["interpolation"] == "LINEAR"
    assert read(rock["input"]).ravel() == pytest.approx([0, 1 / FPS])
    assert read(rock["output"]) == pytest.approx(np.array([[-0.5, 0.3, 0], [0.5, 0.3, 0]]), abs=1e-6)
    shown = tracks["water_00000", "scale"]
    assert shown["interpolation"] == "STEP"
    assert read(shown["input"]).ravel() == pytest.approx([0, 1 / FPS])
    assert read(shown["output"]).tolist() == [[1, 1, 1], [0, 0, 0]]
    foam = next(node for node in scene["nodes"] if node["name"] == "foam_00001")
    (part,) = scene["meshes"][foam["mesh"]]["primitives"]
    assert part["mode"] == 0
    assert read(part["attributes"]["POSITION"]) == pytest.approx(np.array(FOAM), abs=1e-6)
    assert read(part["attributes"]["_RADIUS"]).ravel() == pytest.approx(SIZES)
    assert read(part["attributes"]["_VY"]).ravel() == pytest.approx([3.0] * 3)
    assert read(part["attributes"]["_VZ"]).ravel() == pytest.approx([1.0] * 3)


@pytest.fixture
def fast(stages, write_mesh):
    """The stages, whose water says its speed: 1 to 4 m/s at its corners."""
    names = "x y z nx ny nz vx vy vz speed"
    corners = [(0.2, 0, -0.3), (0.8, 0, -0.3), (0.5, 0, 0.4), (0.5, 0.8, 0)]
    water = [(*corner, 0, 1, 0, 0, 0, 0, speed) for speed, corner in enumerate(corners, 1)]
    write_mesh(stages[1] / "surface_00000.ply", names, water, [(0, 1, 2), (0, 3, 1)])
    write_mesh(stages[1] / "surface_00001.ply", names, [], [])
    return stages


ATTRIBUTES = """
import bpy, json, os, sys
path = sys.argv[-1]
kind = path.rpartition(".")[2]
if kind == "blend":
    bpy.ops.wm.open_mainfile(filepath=path)
else:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    (bpy.ops.wm.usd_import if kind == "usdc" else bpy.ops.import_scene.gltf)(filepath=path)
bpy.context.scene.frame_set(1)
graph = bpy.context.evaluated_depsgraph_get()
found = []
for thing in bpy.data.objects:
    if thing.type in ("MESH", "POINTCLOUD"):
        data = thing.evaluated_get(graph).data if kind == "usdc" else thing.data
        known = {name.strip("_").lower(): one for name, one in data.attributes.items()}
        if {"age", "source", "particle_id"} <= known.keys():
            own = [[round(one.value, 5) for one in known[name].data] for name in ("particle_id", "age", "source")]
            across = "vx" if "vx" in known else "velocity"
            ways = [one.value if across == "vx" else one.vector[0] for one in known[across].data]
            found.append([list(row) for row in zip(*own, ways)])
print("SEEN " + json.dumps(max(found, key=len)), flush=True)
os._exit(0)
"""


@pytest.mark.parametrize("kind", ["usdc", "glb", "blend"])
def test_particles_have_their_speeds_ages_and_sources(stages, tmp_path, kind):
    """Those of the tank came with the scene, those of the tap 0.05 s later; sources are numbered as they came."""
    (stages[0] / "sources.csv").write_text("id,time,source\n7,0,tank\n9,0.05,tap\n")
    path = tmp_path / f"film.{kind}"
    export(stages, path, "--particles", str(RADIUS))
    found = look(tmp_path, ATTRIBUTES, path)
    rows = [[7, 0.08, 0, 0.5], [8, 0.08, 0, 1.5], [9, 0.03, 1, 2.5], [10, 0.03, 1, 3.5], [11, 0.03, 1, 4.5]]
    assert np.array(sorted(found)) == pytest.approx(np.array(rows), abs=1e-5)


@pytest.mark.parametrize(
    ("table", "said"),
    [("id,time,source\n9,0,tap\n", "is not about all particles"), ("id,time\n7,0\n", "sources.csv is not a table")],
)
def test_sources_that_cannot_be_leave_no_file(stages, tmp_path, table, said):
    (stages[0] / "sources.csv").write_text(table)
    done = export(stages, tmp_path / "film.usdc", "--particles", str(RADIUS), expected=2)
    assert said in done.stderr
    assert not list(tmp_path.glob("*film*"))


def test_usd_and_gltf_have_what_water_says_of_the_fluid(fast, tmp_path):
    path = tmp_path / "film.usda"
    export(fast, path)
    text = path.read_text()
    assert "float[] primvars:speed" in text and "0: [1, 2, 3, 4],\n                1: [0, 0, 0],\n" in text
    export(fast, tmp_path / "film.glb")
    data = (tmp_path / "film.glb").read_bytes()
    scene = json.loads(data[20 : 20 + struct.unpack_from("<I", data, 12)[0]])
    water = next(mesh for mesh in scene["meshes"] if mesh["name"].startswith("water"))
    speed = scene["accessors"][water["primitives"][0]["attributes"]["_SPEED"]]
    assert (speed["type"], speed["componentType"]) == ("SCALAR", 5126)


def test_without_being_asked_there_are_no_particles(stages, tmp_path):
    path = tmp_path / "film.usda"
    export(stages, path)
    text = path.read_text()
    assert 'Points "PointCloud"' in text and "particles" not in text


@pytest.mark.parametrize("kind", ["usdc", "abc", "glb", "blend"])
def test_points_that_cannot_be_read_leave_no_file(stages, tmp_path, kind):
    (stages[2] / "foam_00001.ply").unlink()
    done = export(stages, tmp_path / f"film.{kind}", expected=2)
    assert "foam_00001.ply" in done.stderr
    assert not list(tmp_path.glob("*film*"))
