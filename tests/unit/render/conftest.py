"""Small inputs of the render stage, written as the earlier stages write them."""

import json
import struct

import pytest


def _write_mesh(path, names, vertices, triangles):
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}"]
    header += [f"property float {name}" for name in names.split()]
    header += [f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header"]
    data = "".join(line + "\n" for line in header).encode()
    data += b"".join(struct.pack(f"<{len(vertex)}f", *vertex) for vertex in vertices)
    data += b"".join(struct.pack("<B3i", 3, *triangle) for triangle in triangles)
    path.write_bytes(data)
    return path


@pytest.fixture(scope="session")
def write_mesh():
    return _write_mesh


@pytest.fixture
def film(tmp_path):
    """Simulation and surface of two frames: a tetrahedron as body, one as water, none in frame 1."""
    simulation, surface = tmp_path / "simulation", tmp_path / "surface"
    simulation.mkdir()
    surface.mkdir()
    corners = [(-0.3, -0.3, -0.3), (0.3, -0.3, -0.3), (0.0, -0.3, 0.4), (0.0, 0.5, 0.0)]
    sides = [(0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)]
    _write_mesh(simulation / "body_rock.ply", "x y z", corners, sides)
    water = [(x + 0.5, y + 0.3, z, 0, 1, 0, 1, 0, 0) for x, y, z in corners]
    _write_mesh(surface / "surface_00000.ply", "x y z nx ny nz vx vy vz", water, sides)
    _write_mesh(surface / "surface_00001.ply", "x y z nx ny nz vx vy vz", [], [])
    rows = ["frame,time,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz"]
    rows += [f"{frame},{frame / 24},rock,-0.5,0.3,0,1,0,0,0,0,-1,0,0,0,3" for frame in (0, 1)]
    (simulation / "bodies.csv").write_text("\n".join(rows) + "\n")
    extent = {"min": [-0.9, 0.0, -0.4], "max": [0.9, 0.9, 0.4]}
    (simulation / "summary.json").write_text(json.dumps({"extent": extent}))
    return simulation, surface
