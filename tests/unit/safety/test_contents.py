"""What is in a mesh or a state reads no other file, runs nothing and does not fill the memory."""

from __future__ import annotations

import io
import json
import struct
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import trimesh

from scene.settings import Refused
from sim.geometry.meshes.formats import read
from sim.run.checkpoint import frame_of

BOX = trimesh.creation.box((1, 1, 1))
TETRAHEDRON = """\
<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/>
<vertex x="0" y="0" z="1"/></vertices><triangles><triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/>
<triangle v1="1" v2="2" v3="3"/><triangle v1="0" v2="3" v3="2"/></triangles></mesh>"""


@pytest.fixture
def opened() -> Iterator[list[str]]:
    """Names of the files that were opened meanwhile."""
    found: list[str] = []
    watching = True

    def note(event: str, arguments: tuple[object, ...]) -> None:
        if watching and event == "open":
            found.append(str(arguments[0]))

    sys.addaudithook(note)
    yield found
    watching = False


def glb(**changes: object) -> bytes:
    """A box in GLB, with other values in its head."""
    content = BOX.export(file_type="glb")
    (length,) = struct.unpack_from("<I", content, 12)
    text = json.dumps({**json.loads(content[20 : 20 + length]), **changes}).encode()
    text += b" " * (-len(text) % 4)
    rest = content[20 + length :]
    head = struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text) + len(rest), len(text), b"JSON")
    return head + text + rest


def three_mf(objects: str, item: int = 1, head: str = "") -> bytes:
    space = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
    build = f'<build><item objectid="{item}"/></build>'
    text = f'<?xml version="1.0"?>{head}<model xmlns="{space}" unit="meter"><resources>{objects}</resources>{build}'
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("3D/3dmodel.model", text + "</model>")
    return stream.getvalue()


NAMING = {
    "box.obj": lambda name: f"mtllib {name}.mtl\nusemtl red\n{BOX.export(file_type='obj')}".encode(),
    "box.ply": lambda name: BOX.export(file_type="ply").replace(
        b"\nelement", f"\ncomment TextureFile {name}.png\nelement".encode(), 1
    ),
    "box.glb": lambda name: glb(
        images=[{"uri": f"{name}.png"}],
        textures=[{"source": 0}],
        materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
    ),
    "box.3mf": lambda name: three_mf(
        f'<metadata>&a;</metadata><object id="1">{TETRAHEDRON}</object>',
        head=f'<!DOCTYPE m [<!ENTITY a SYSTEM "{name}.png">]>',
    ),
}
"""Files that name another one, by its name without the end."""


@pytest.mark.parametrize("place", ["", "../"])
@pytest.mark.parametrize("name", NAMING)
def test_a_mesh_reads_no_other_file(tmp_path, opened, name, place):
    folder = tmp_path / "folder"
    folder.mkdir()
    for end in ("mtl", "png"):
        (folder / place / f"secret.{end}").write_text("newmtl red\nKd 1 0 0\nmap_Kd secret.png\n")
    (folder / name).write_bytes(NAMING[name](f"{place}secret"))
    opened.clear()
    assert len(read(folder / name).faces) in (4, 12)
    assert any(file.endswith(name) for file in opened) and not [file for file in opened if "secret" in file]


@pytest.mark.parametrize("uri", ["../secret.bin", "file:///etc/passwd", "http://127.0.0.1:9/box.bin"])
def test_a_glb_has_no_triangles_in_other_files(tmp_path, uri):
    (tmp_path / "box.glb").write_bytes(glb(buffers=[{"byteLength": 100, "uri": uri}]))
    with pytest.raises(Refused, match="has its triangles in another file"):
        read(tmp_path / "box.glb")


def test_a_glb_cannot_promise_more_than_it_has(tmp_path):
    (tmp_path / "box.glb").write_bytes(glb(accessors=[{"componentType": 5126, "count": 10**9, "type": "VEC3"}]))
    with pytest.raises(Refused, match="promises 1,000,000,000"):
        read(tmp_path / "box.glb")


def test_a_3mf_does_not_unpack_to_more_than_a_memory_holds(tmp_path):
    with zipfile.ZipFile(tmp_path / "zeros.3mf", "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        archive.writestr("3D/3dmodel.model", b"\0" * 1_000_000)
        archive.infolist()[0].file_size = 2_000_000_000
    with pytest.raises(Refused, match="unpacks to 2 GB"):
        read(tmp_path / "zeros.3mf")


def test_a_3mf_does_not_build_without_end(tmp_path):
    twice = '<object id="{0}"><components><component objectid="{1}"/><component objectid="{1}"/></components></object>'
    doubled = "".join(twice.format(level, level - 1) for level in range(2, 40))
    (tmp_path / "tower.3mf").write_bytes(three_mf(f'<object id="1">{TETRAHEDRON}</object>{doubled}', item=39))
    with pytest.raises(Refused, match="builds 274,877,906,944 parts"):
        read(tmp_path / "tower.3mf")


def test_entities_of_a_3mf_do_not_grow(tmp_path):
    levels = [f'<!ENTITY a{level} "{f"&a{level - 1};" * 10}">' for level in range(1, 12)]
    head = f'<!DOCTYPE m [<!ENTITY a0 "0">{"".join(levels)}]>'
    (tmp_path / "laughs.3mf").write_bytes(
        three_mf(f'<object id="1">{TETRAHEDRON}</object>'.replace('x="1"', 'x="&a11;"'), head=head)
    )
    with pytest.raises(Refused, match="cannot be read"):
        read(tmp_path / "laughs.3mf")


class Evil:
    """Unpickled, it writes a file."""

    def __init__(self, path: Path):
        self.path = path

    def __reduce__(self):
        return Path.touch, (self.path,)


@pytest.mark.parametrize("name", ["meta", "origin"])
def test_no_state_is_unpickled(tmp_path, name):
    contents = {"meta": np.array("{}"), "origin": np.zeros(3), name: np.array([Evil(tmp_path / "ran")], object)}
    np.savez(tmp_path / "state_00001.npz", **contents)
    with pytest.raises(Refused, match="is not a state"):
        frame_of(tmp_path / "state_00001.npz")
    assert not (tmp_path / "ran").exists()


def test_nothing_in_the_sources_unpickles():
    root = Path(__file__).parents[3]
    chapters = ("common", "scene", "sim", "render", "workflow", "live")
    files = [file for chapter in chapters for file in root.glob(f"{chapter}/**/*.py")]
    text = {file: file.read_text() for file in files}
    assert not [file for file, found in text.items() if "pickle.load" in found or "allow_pickle=True" in found]
    loading = {file.name: found.count("np.load(") - found.count("allow_pickle=False") for file, found in text.items()}
    assert not {name for name, missing in loading.items() if missing}


def test_a_state_does_not_unpack_to_more_than_its_size(tmp_path):
    path = tmp_path / "state_00001.npz"
    np.savez_compressed(path, meta=np.array("{}"), zeros=np.zeros(10_000_000))
    with pytest.raises(Refused, match="it holds more than its size"):
        frame_of(path)
