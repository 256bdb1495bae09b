"""Shapes and where they stand."""

from __future__ import annotations

from functools import reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from annotated_types import Ge, Gt
from pydantic import Field, model_validator

from common.registry import added
from scene.settings import Settings, type_names
from scene.units import Angle, Dimensionless, Direction, Extents, Position, PositiveLength


class Box(Settings):
    """A cuboid around its centre."""

    type: Literal["box"]
    size: Extents
    """Full edge lengths along x, y and z [m]."""


class Sphere(Settings):
    """A sphere around its centre."""

    type: Literal["sphere"]
    radius: PositiveLength


class Cylinder(Settings):
    """A solid cylinder around its centre, its axis along y."""

    type: Literal["cylinder"]
    radius: PositiveLength
    height: PositiveLength


class Capsule(Settings):
    """A cylinder with half-spheres on both ends, around its centre, its axis along y."""

    type: Literal["capsule"]
    radius: PositiveLength
    height: PositiveLength
    """Length of the cylindrical part [m]."""


class Torus(Settings):
    """A ring around the y axis."""

    type: Literal["torus"]
    radius: PositiveLength
    """From the centre of the ring to the centre of its tube [m]."""
    tube_radius: PositiveLength

    @model_validator(mode="after")
    def _tube_fits(self) -> Self:
        if self.tube_radius >= self.radius:
            raise ValueError(
                "tube_radius must be smaller than radius, or the ring has no hole: lower it, or use a sphere"
            )
        return self


class Plane(Settings):
    """The infinite half-space below a plane through the origin."""

    type: Literal["plane"]
    normal: Direction = (0.0, 1.0, 0.0)
    """Direction out of the solid; need not be of unit length."""

    @model_validator(mode="after")
    def _has_a_direction(self) -> Self:
        if sum(component * component for component in self.normal) < 1e-12:
            raise ValueError("normal must not be zero: give a direction, as [0, 1, 0]")
        return self


class Sheet(Settings):
    """A flat rectangle around its centre, its normal along y."""

    type: Literal["sheet"]
    size: tuple[PositiveLength, PositiveLength]
    """Edge lengths along x and z [m]."""


class MeshSurface(Settings):
    """The triangles of a file in one of the formats OBJ, STL, PLY, OFF, GLB, glTF and 3MF."""

    type: Literal["mesh"]
    file: Annotated[str, Field(min_length=1)]
    """Path, relative to the scene file; or PACKAGE:PATH, a file of an installed Python package."""
    up: Literal["x", "y", "z"] = "y"
    """Which axis of the file points up."""
    size: PositiveLength | None = None
    """Scale so that the longest edge of the bounding box has this length [m]; without it the
    file's numbers are metres, or in the unit that a 3MF names: millimetres, if none."""
    anchor: Literal["origin", "center", "base"] = "origin"
    """Which point of the mesh lies on `position`: the file's origin, the centre of its bounding box, or the middle
    of the bounding box's bottom face."""
    repair: bool = True
    """Repair holes, flipped faces and non-manifold edges; repairs are reported."""


class ClosedMesh(MeshSurface):
    """What the triangles of a file enclose."""

    close: Literal["holes", "all"] = "holes"
    """Which openings `repair` closes: `holes`, small gaps in a solid's surface, while a surface that is open like a
    bowl is refused; or `all`: a bowl becomes a solid up to its rim."""


class MeshFile(ClosedMesh):
    """The inside of a file's triangles, or a shell of a given thickness around them."""

    thickness: PositiveLength | None = None
    """Make a shell of this thickness from the surface [m], half of it on either side; it is open where the surface
    is. `scale` scales it as well, `size` is that of the surface alone."""

    @model_validator(mode="after")
    def _open_or_closed(self) -> Self:
        if self.thickness is not None and self.close == "all":
            raise ValueError("a shell of a thickness stays open where the surface is: leave out thickness or close")
        return self


class MeshFace(MeshSurface):
    """A flat face of a mesh: a triangle and all adjoining ones in the same plane; outward is forward."""

    repair: Literal[False] = False
    """Nothing is repaired, so that faces keep their numbers in the file."""
    face: Annotated[int, Ge(0)]
    """Number of the triangle in the file, from 0; polygons count as the triangles they are split into, degenerate
    triangles do not count."""


PRIMITIVES = (Box, Sphere, Cylinder, Capsule, Torus)
"""Closed shapes that are known in closed form."""
BY_TRIANGLES = (MeshFile, *added("shapes", *type_names(*PRIMITIVES, Plane, Sheet, MeshFile)).values())
"""Those of files, and what installed packages add."""

if TYPE_CHECKING:
    ClosedShape = Any
    AnyShape = Any
else:
    ClosedShape = Annotated[reduce(or_, (*PRIMITIVES, *BY_TRIANGLES)), Field(discriminator="type")]
    AnyShape = Annotated[reduce(or_, (*PRIMITIVES, Plane, Sheet, *BY_TRIANGLES)), Field(discriminator="type")]

ClothShape = Annotated[Sheet | MeshSurface, Field(discriminator="type")]


class Rotation(Settings):
    """A right-handed rotation about an axis through the body's own origin."""

    axis: Direction
    angle: Angle

    @model_validator(mode="after")
    def _has_an_axis(self) -> Self:
        if sum(component * component for component in self.axis) < 1e-12:
            raise ValueError("axis must not be zero: give a direction, as [0, 1, 0]")
        return self


class Placement(Settings):
    """Where a shape stands: scaled, then turned, then moved."""

    position: Position = (0.0, 0.0, 0.0)
    rotation: tuple[Rotation, ...] = ()
    """Rotations, applied in the order given."""
    scale: Annotated[Dimensionless, Gt(0)] = 1.0
