"""What is said when Blender cannot be loaded."""

import pytest

from render.blender.session import import_remedy
from render.libraries import DEBIAN_PACKAGES


@pytest.mark.parametrize(
    ("library", "package"),
    [
        ("libX11.so.6", "libx11-6"),
        ("libXrender.so.1", "libxrender1"),
        ("libXfixes.so.3", "libxfixes3"),
        ("libXi.so.6", "libxi6"),
        ("libxkbcommon.so.0", "libxkbcommon0"),
        ("libSM.so.6", "libsm6"),
        ("libICE.so.6", "libice6"),
        ("libGL.so.1", "libgl1"),
    ],
)
def test_a_missing_library_names_its_package(library, package):
    error = ImportError(f"{library}: cannot open shared object file: No such file or directory")
    assert f"apt-get install {package} " in import_remedy(error)


def test_other_failures_keep_their_message():
    assert "undefined symbol: foo" in import_remedy(ImportError("undefined symbol: foo"))
    missing = import_remedy(ModuleNotFoundError("No module named 'bpy'"))
    assert "install the Python package bpy" in missing and "export TIDEMILL_BLENDER=PATH" in missing


def test_package_names_are_those_of_debian():
    assert all(name == name.lower() for name in DEBIAN_PACKAGES.values())
