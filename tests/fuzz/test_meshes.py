"""Files of meshes in every format that is common, and meshes that are broken as such."""

from __future__ import annotations

import io
import zipfile

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from scene.settings import Refused
from sim.geometry.shapes import load_mesh
from sim.geometry.spec import MeshFile
from tests.fuzz.mutations import broken_bytes, fuzzed

FORMATS = ["obj", "ply", "stl", "off", "glb", "3mf"]
NUMBERS = (b"nan", b"inf", b"-1", b"1e300", b"1e-320", b"0", b"99999999999", b"\xff\xff\xff\x7f", b"\x00\x00\xc0\x7f")


@pytest.fixture
def survives(tmp_path, monkeypatch, survived):
    """Loads a file as a closed mesh, a shell and one of cloth; anything but a sound mesh or Refused fails the test."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))

    def check(content: bytes, kind: str) -> None:
        path = tmp_path / f"mesh.{kind}"
        path.write_bytes(content)
        for closed, thickness in ((True, None), (True, 0.1), (False, None)):
            with survived(Refused):
                shape = MeshFile(type="mesh", file=path.name, size=1.0, thickness=thickness)
                mesh, _ = load_mesh(shape, path, closed=closed)
                assert len(mesh.faces)
                assert np.isfinite(mesh.vertices).all()
                assert not closed or (mesh.is_watertight and mesh.volume > 0)

    return check


def exported(kind: str) -> bytes:
    content = trimesh.creation.icosphere(subdivisions=1).export(file_type=kind)
    return content if isinstance(content, bytes) else content.encode()


@pytest.mark.parametrize("kind", FORMATS)
def test_bytes(kind, survives):
    @fuzzed(30)
    @given(broken_bytes(exported(kind), NUMBERS))
    def check(changed):
        survives(changed, kind)

    check()


def test_the_model_in_a_3mf(survives):
    """What is broken before it is packed passes the checksums of the archive."""
    name = "3D/3dmodel.model"

    def packed(model: bytes) -> bytes:
        content = io.BytesIO()
        with zipfile.ZipFile(content, "w") as archive:
            archive.writestr(name, model)
        return content.getvalue()

    @fuzzed(30)
    @given(broken_bytes(zipfile.ZipFile(io.BytesIO(exported("3mf"))).read(name), NUMBERS))
    def check(changed):
        survives(packed(changed), "3mf")

    check()


@pytest.mark.parametrize("kind", FORMATS)
def test_what_is_no_mesh(kind, survives):
    @fuzzed(20)
    @given(st.binary(max_size=200))
    def check(content):
        survives(content, kind)

    check()


COORDINATES = st.floats(-1, 1, width=32) | st.sampled_from([0.0, 1e-30, 1e30, -1e30, 0.5])


def test_triangles_at_random(survives):
    """Any triangles between any points: open, doubled, folded, crossing, without area, far away."""

    @fuzzed(30)
    @given(
        st.integers(3, 12).flatmap(
            lambda n: st.tuples(
                arrays(np.float64, (n, 3), elements=COORDINATES),
                arrays(np.int64, st.tuples(st.integers(1, 20), st.just(3)), elements=st.integers(0, n - 1)),
            )
        )
    )
    def check(drawn):
        vertices, faces = drawn
        buffer = io.StringIO()
        buffer.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in vertices.tolist())
        buffer.writelines(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces.tolist())
        survives(buffer.getvalue().encode(), "obj")

    check()
