"""Assets: where they are found, and what is said when they are not."""

import hashlib
import sys

import pytest

from scene.assets import digest, resolve
from scene.settings import Refused


def test_path_is_relative_to_the_scene(tmp_path):
    (tmp_path / "meshes").mkdir()
    file = tmp_path / "meshes" / "duck.obj"
    file.write_text("v 0 0 0")
    assert resolve("meshes/duck.obj", tmp_path) == file.resolve()
    assert resolve(str(file), tmp_path) == file.resolve()


def test_home_is_expanded(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / "duck.obj").write_text("")
    assert resolve("~/duck.obj", tmp_path) == (tmp_path / "duck.obj").resolve()


def test_file_of_a_package_is_found_without_importing_it(tmp_path, monkeypatch):
    package = tmp_path / "tm_assets_probe"
    package.mkdir()
    (package / "__init__.py").write_text("raise RuntimeError('imported')")
    (package / "cup.stl").write_text("solid")
    monkeypatch.syspath_prepend(tmp_path)
    assert resolve("tm_assets_probe:cup.stl", tmp_path) == (package / "cup.stl").resolve()
    assert "tm_assets_probe" not in sys.modules


@pytest.mark.parametrize(
    ("file", "says"),
    [
        ("dukc.obj", ["'dukc.obj'", "looked for", "Did you mean duck.obj?"]),
        ("mesh/duck.obj", ["does not exist", "Did you mean meshes?"]),
        ("meshes", ["is a folder", "cup.stl"]),
        ("no_such_package_here:a.ply", ["'no_such_package_here' is not installed", "PACKAGE:PATH"]),
        ("pymeshfix:examples/StanfordBuny.ply", ["Did you mean examples/StanfordBunny.ply?"]),
        ("pymeshfix:../trimesh/version.py", ["leads out of the package"]),
        ("a\0b", ["'a\\x00b'"]),
    ],
)
def test_missing_file_is_refused_with_a_remedy(tmp_path, file, says):
    (tmp_path / "duck.obj").write_text("")
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "cup.stl").write_text("")
    with pytest.raises(Refused) as refused:
        resolve(file, tmp_path)
    for words in says:
        assert words in str(refused.value)
    assert refused.value.remedy


def test_digest_follows_the_content_alone(tmp_path):
    one, other = tmp_path / "a", tmp_path / "b"
    one.write_bytes(b"tide")
    other.write_bytes(b"tide")
    assert digest(one) == digest(other) == hashlib.sha256(b"tide").hexdigest()
    other.write_bytes(b"tidf")
    assert digest(one) != digest(other)
