"""`check` loads no library of meshes for bodies at rest whose distance has a closed form: that takes longer than the
check."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

CODE = """
import json, sys
from sim.__main__ import main
assert main(["check", sys.argv[1]]) == 0
print(json.dumps("trimesh" in sys.modules))
"""
SCENE = {
    "duration": 1,
    "fps": 24,
    "containers": {"tank": {"type": "box", "size": [1, 1, 1]}},
    "fluid": {
        "particle_radius": 0.05,
        "bodies": {"water": {"shape": {"type": "box", "size": [0.5, 0.3, 0.5]}, "position": [0, 0.15, 0]}},
    },
}
BODY = {"position": [0.1, 0.6, 0], "rotation": [{"axis": [1, 2, 3], "angle": 20}]}
SHAPES = {
    "box": {"size": [0.2, 0.1, 0.2]},
    "sphere": {"radius": 0.1},
    "cylinder": {"radius": 0.1, "height": 0.1},
    "capsule": {"radius": 0.1, "height": 0.1},
    "torus": {"radius": 0.1, "tube_radius": 0.05},
}


def test_shapes_with_closed_forms(tmp_path):
    bodies = {
        name: BODY | {"position": [0, 0.5 + 0.4 * number, 0], "shape": {"type": name} | sizes}
        for number, (name, sizes) in enumerate(SHAPES.items())
    }
    path = Path(tmp_path, "scene.yaml")
    path.write_text(json.dumps(SCENE | {"rigid": {"bodies": bodies}}))
    done = subprocess.run([sys.executable, "-c", CODE, str(path)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "false"
