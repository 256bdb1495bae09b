"""A cube with a picture on each side, as files of several formats, and what is seen of it in a picture.

The picture is red at its upper left, green at its upper right, blue and white below.
"""

from __future__ import annotations

import io
import struct
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from common.imported.gltf import joined

QUARTERS = ("red", "green", "blue", "white")
_COLORS = np.array([[(255, 0, 0), (0, 255, 0)], [(0, 0, 255), (255, 255, 255)]], np.uint8)
_SIDES = (
    ((-1, -1, 1), (1, 0, 0), (0, 1, 0)),
    ((1, -1, -1), (-1, 0, 0), (0, 1, 0)),
    ((1, -1, 1), (0, 0, -1), (0, 1, 0)),
    ((-1, -1, -1), (0, 0, 1), (0, 1, 0)),
    ((-1, 1, 1), (1, 0, 0), (0, 0, -1)),
    ((-1, -1, -1), (1, 0, 0), (0, 0, 1)),
)
"""Lower left corner, and the directions of right and up, as seen from outside; the front first."""
MTL = "newmtl paint\nKd 0.2 0.2 0.2\nNs 0\nKs 0 0 0\nmap_Kd quarters.png\n"


def picture(kind: str = "PNG") -> bytes:
    """Four quarters of 8 by 8 pixels."""
    stream = io.BytesIO()
    Image.fromarray(_COLORS.repeat(8, axis=0).repeat(8, axis=1)).save(stream, kind, quality=95)
    return stream.getvalue()


def cube() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Corners [m], shape [24, 3], of a cube of 1 m, their UV, shape [24, 2], and its triangles, shape [12, 3]."""
    along = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
    sides = [np.array(start) / 2 + along @ np.array([right, up]) for start, right, up in _SIDES]
    triangles = 4 * np.arange(6)[:, None, None] + np.array([[0, 1, 2], [0, 2, 3]])
    return np.concatenate(sides), np.tile(along, (6, 1)), triangles.reshape(-1, 3)


def obj(head: str = "mtllib cube.mtl\nusemtl paint\n") -> str:
    points, uv, triangles = cube()
    lines = [f"v {x} {y} {z}" for x, y, z in points] + [f"vt {u} {v}" for u, v in uv]
    lines += ["f " + " ".join(f"{corner}/{corner}" for corner in triangle) for triangle in triangles + 1]
    return head + "\n".join(lines) + "\n"


def ply(head: str = "") -> str:
    points, uv, triangles = cube()
    kinds = "".join(f"property float {name}\n" for name in ("x", "y", "z", "s", "t"))
    text = f"ply\nformat ascii 1.0\n{head}element vertex 24\n{kinds}element face 12\n"
    text += "property list uchar int vertex_indices\nend_header\n"
    rows = np.column_stack([points, uv])
    return (
        text
        + "".join(" ".join(f"{n:g}" for n in row) + "\n" for row in rows)
        + "".join(f"3 {a} {b} {c}\n" for a, b, c in triangles)
    )


def glb(image: bytes | None = None, material: dict[str, Any] | None = None, **head: Any) -> bytes:
    """The cube with a picture within; `material` and `head` are added to what is said of both."""
    points, uv, triangles = cube()
    parts = [
        points.astype("<f4").tobytes(),
        np.column_stack([uv[:, 0], 1 - uv[:, 1]]).astype("<f4").tobytes(),
        triangles.astype("<u2").tobytes(),
        picture() if image is None else image,
    ]
    starts = np.cumsum([0, *(len(part) for part in parts)])
    content = b"".join(parts)
    content += b"\0" * (-len(content) % 4)
    paint = {
        "name": "paint",
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0, "roughnessFactor": 1},
    }
    primitive = {"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}
    shapes = ((5126, 24, "VEC3"), (5126, 24, "VEC2"), (5123, 36, "SCALAR"))
    whole = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [primitive]}],
        "materials": [paint | (material or {})],
        "textures": [{"source": 0}],
        "images": [{"bufferView": 3, "mimeType": "image/png"}],
        "accessors": [
            {"bufferView": view, "componentType": kind, "count": count, "type": shape}
            for view, (kind, count, shape) in enumerate(shapes)
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": int(start), "byteLength": len(part)}
            for start, part in zip(starts, parts, strict=False)
        ],
        "buffers": [{"byteLength": len(content)}],
    }
    return joined(whole | head, struct.pack("<I4s", len(content), b"BIN\0") + content)


def write(folder: Path) -> None:
    """All of them: cube.obj with cube.mtl and quarters.png, cube.glb, cube.ply, and plain.obj without materials."""
    (folder / "quarters.png").write_bytes(picture())
    (folder / "cube.mtl").write_text(MTL)
    (folder / "cube.obj").write_text(obj())
    (folder / "plain.obj").write_text(obj(head=""))
    (folder / "cube.glb").write_bytes(glb())
    (folder / "cube.ply").write_text(ply("comment TextureFile quarters.png\n"))


def named(color: Any) -> str:
    """What one calls a pixel, shape [3], 0 to 255."""
    red, green, blue = (channel > 0.6 * max(max(color), 60) for channel in color)
    return {
        (True, False, False): "red",
        (False, True, False): "green",
        (False, False, True): "blue",
        (True, True, True): "white",
    }.get((red, green, blue), "another")


def quarters(image: np.ndarray) -> tuple[str, ...]:
    """The colours around the middle of a picture: upper left, upper right, lower left, lower right."""
    height, width, _ = image.shape
    return tuple(named(image[int(y * height), int(x * width)]) for y in (0.38, 0.62) for x in (0.38, 0.62))
