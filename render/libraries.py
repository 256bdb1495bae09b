"""Libraries of the system that Blender needs."""

from __future__ import annotations

DEBIAN_PACKAGES = {
    "libEGL": "libegl1",
    "libGL": "libgl1",
    "libICE": "libice6",
    "libSM": "libsm6",
    "libX11": "libx11-6",
    "libXext": "libxext6",
    "libXfixes": "libxfixes3",
    "libXi": "libxi6",
    "libXrender": "libxrender1",
    "libXxf86vm": "libxxf86vm1",
    "libxkbcommon": "libxkbcommon0",
}
"""Debian's name of the package that brings a library which the bpy wheel expects of the system."""
