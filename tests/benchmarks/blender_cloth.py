"""A cloth that falls on a ball, by Blender's own solver; run by `cloth_drape.py` in a process of its own.

Blender's cloth takes a thousandth of gravity in a frame squared, at any frame rate: to it a frame is sqrt(0.001) s.
What falls freely goes so far: 0.718 m in 12 frames.
"""

from __future__ import annotations

import json
import sys
import time

import bpy
import numpy as np

FRAME = 0.001**0.5
"""[s]"""


def lattice(cells: int, size: float, height: float) -> bpy.types.Object:
    line = np.linspace(-size / 2, size / 2, cells + 1)
    x, y = (part.ravel() for part in np.meshgrid(line, -line, indexing="ij"))
    corner = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    faces = np.stack([corner, corner + cells + 1, corner + cells + 2, corner + 1], axis=1)
    mesh = bpy.data.meshes.new("cloth")
    mesh.from_pydata(np.stack([x, y, np.full_like(x, height)], axis=1).tolist(), [], faces.tolist())
    cloth = bpy.data.objects.new("cloth", mesh)
    bpy.context.collection.objects.link(cloth)
    return cloth


def build(case: dict) -> bpy.types.Object:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.gravity = (0, 0, -9.81)
    vertices, triangles = np.array(case["ball_points"]), case["ball_triangles"]
    mesh = bpy.data.meshes.new("ball")
    mesh.from_pydata(vertices.tolist(), [], triangles)
    ball = bpy.data.objects.new("ball", mesh)
    bpy.context.collection.objects.link(ball)
    ball.modifiers.new("collision", "COLLISION")
    ball.collision.thickness_outer = ball.collision.thickness_inner = 0.001
    ball.collision.cloth_friction = 0.3
    cloth = lattice(case["cells"], case["size"], case["height"])
    modifier = cloth.modifiers.new("cloth", "CLOTH")
    settings, meets = modifier.settings, modifier.collision_settings
    spacing = case["size"] / case["cells"]
    settings.mass = case["mass_per_area"] * case["size"] ** 2 / (case["cells"] + 1) ** 2
    settings.quality = case["quality"]
    # Force per strain of one thread, and of one diagonal [kg m per frame squared].
    stiffness = case["stretch_stiffness"] * spacing * FRAME**2
    settings.tension_stiffness = settings.compression_stiffness = stiffness
    settings.shear_stiffness = stiffness / 2
    settings.tension_damping = settings.compression_damping = settings.shear_damping = 0.0
    settings.bending_stiffness = settings.bending_damping = 0.0
    settings.air_damping = 0.0
    meets.distance_min = meets.self_distance_min = max(case["thickness"], 0.001)
    meets.use_self_collision = True
    meets.friction = meets.self_friction = 0.3
    modifier.point_cache.frame_end = round(case["seconds"] / FRAME) + 1
    return cloth


def main() -> None:
    case = json.loads(sys.stdin.read())
    cloth, scene = build(case), bpy.context.scene
    scene.frame_set(1)
    begun = time.perf_counter()
    frames = round(case["seconds"] / FRAME)
    for frame in range(2, frames + 2):
        scene.frame_set(frame)
    wall = time.perf_counter() - begun
    made = cloth.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    places = np.zeros(3 * len(made.vertices))
    made.vertices.foreach_get("co", places)
    # Its z is up, and rows of points begin where ours do.
    np.save(case["out"], places.reshape(-1, 3)[:, [0, 2, 1]] * [1, 1, -1])
    print(f"wall {wall / (frames * FRAME)}")


if __name__ == "__main__":
    main()
