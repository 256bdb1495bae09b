"""Typed settings of the surface: how particles become a closed triangle mesh.

The defaults follow Löschner et al. 2023; thin sheets are made whole before, see workflow/stages/surface/layers.py.
"""

from __future__ import annotations

from typing import Annotated, Literal, Self

from annotated_types import Ge, Gt, Le
from pydantic import field_validator, model_validator

from common.attributes import Attribute
from scene.settings import Name, Settings
from scene.units import Density, Dimensionless, FrameRate, PositiveLength
from sim.bodies.wall import Wall


class MeshSmoothing(Settings):
    """Laplacian smoothing of the vertices, weighted to keep splashes and droplets in shape."""

    iterations: Annotated[int, Ge(0), Le(500)] = 25
    """Number of smoothing passes; 0 leaves the bumps of single particles."""
    weighted: bool = True
    """Smooth less where there are few particles, so that thin features do not shrink."""
    normalization: Annotated[Dimensionless, Gt(0), Le(100)] = 13.0
    """Number of neighbours [1] from which a vertex is smoothed in full."""


class MeshCleanup(Settings):
    """Removal of slivers left by marching cubes (Moore & Warren 1992)."""

    enabled: bool = True
    """Snap vertices to the grid where they make degenerate triangles."""
    snap_distance: Annotated[Dimensionless, Gt(0), Le(0.5)] | None = None
    """Maximum displacement of a snapped vertex, in edge lengths of a cube [1]; unlimited by default."""
    decimate_barnacles: bool = True
    """Remove the small bumps that remain on smooth surfaces."""


class Layers(Settings):
    """Thin sheets of fluid, of a single layer of particles, which would otherwise show as bumps and holes."""

    enabled: bool = True
    """Fill gaps where a layer of particles is stretched, and flatten it; drops, threads and bulk are left unchanged."""
    reach: Annotated[Dimensionless, Ge(1.5), Le(4)] = 2.6
    """Widest gap between two particles that is filled, in spacings [1]."""
    reach_on_walls: Annotated[Dimensionless, Ge(1.5), Le(6)] = 4.0
    """Likewise of particles on the sides of box containers and on planes, where water wets what it lies on [1]."""


class Normals(Settings):
    """Normals at the vertices."""

    source: Literal["mesh", "particles"] = "mesh"
    """`mesh`: area-weighted mean of the faces; `particles`: gradient of the colour field (SPH)."""
    smoothing_iterations: Annotated[int, Ge(0), Le(500)] = 10
    """Number of smoothing passes over the normals."""


class SurfaceSpec(Settings):
    """Everything that the reconstruction depends on, besides the particles."""

    smoothing_length: Annotated[Dimensionless, Ge(1), Le(8)] = 2.0
    """Smoothing length of the kernel, in particle radii [1]; it reaches twice as far."""
    cube_size: Annotated[Dimensionless, Ge(0.1), Le(4)] = 0.75
    """Edge of a marching cube, in particle radii [1]: halving it makes about 4 times the triangles."""
    surface_threshold: Annotated[Dimensionless, Gt(0), Le(1.5)] = 0.6
    """Value of the colour field at the surface [1]: 0 is far outside, 1 is deep inside."""
    layers: Layers = Layers()
    drops: bool = True
    """Draw each particle without neighbours as drops of its volume."""
    spray: Annotated[int, Ge(1), Le(16)] = 4
    """Drops of each of these particles, of several sizes; 1 is a ball as large as the particle."""
    walls: bool = True
    """End flush with containers, planes and bodies where the fluid touches them, up to their edges."""
    volume: bool = True
    """Bring each connected piece of the surface to the volume of its particles; thin sheets are too thick otherwise."""
    attributes: tuple[Attribute, ...] = ()
    """What the vertices say of the fluid there, for looks as `colormap` and `palette` and for other programs: `speed`
    [m/s], `vorticity`, its magnitude [1/s], `density` [kg/m^3], `age`, since the fluid came into the scene [s], and
    `source`, the share of each fluid body and emitter; each the mean of the particles around."""
    smoothing: MeshSmoothing = MeshSmoothing()
    cleanup: MeshCleanup = MeshCleanup()
    normals: Normals = Normals()

    @field_validator("attributes")
    @classmethod
    def _each_once(cls, names: tuple[Attribute, ...]) -> tuple[Attribute, ...]:
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice:
            raise ValueError(f"{twice} is named twice: name it once")
        return names


class ReconstructSpec(Settings):
    """What `python -m workflow.reconstruct --spec` takes: the surface, and what it is the surface of."""

    particle_radius: PositiveLength
    """Half the spacing of the particles [m]."""
    rest_density: Density = 1000.0
    walls: tuple[Wall, ...] = ()
    """Planes that the surface ends flush with."""
    vessels: tuple[Name, ...] = ()
    """Containers with a mesh of their own that it ends flush with; it does with all bodies that have one."""
    fps: FrameRate | None = None
    """Frames per simulated second [Hz], which the attribute `age` needs."""
    sources: tuple[Name, ...] | None = None
    """Fluid bodies and emitters that the attribute `source` tells apart, of which some may come later; without it,
    those that the simulation names."""
    surface: SurfaceSpec = SurfaceSpec()

    @model_validator(mode="after")
    def _ages_have_times(self) -> Self:
        if "age" in self.surface.attributes and self.fps is None:
            raise ValueError("surface.attributes: age needs the times of the frames: give fps")
        return self
