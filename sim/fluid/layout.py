"""How the arrays of a fluid are laid out for kernels: what is read together, and what is in the fourth component of
vectors."""

from typing import Any

from sim.device.argument_packs import argpack
from sim.device.arrays import DoubleTable, IntArray, IntTable, RealArray, Vec4Array, real, vec2, vec4

Q = 3
"""Of `position`: p / rho^2 [m^5/(kg s^2)]."""
DENSITY = 3
"""Of `velocity`, of `normal` of surface tension, and of the velocities that implicit viscosity looks for [kg/m^3]."""
DISTANCE = 3
"""Of a `face`: from the half-space beyond it [m]; the others are its normal."""
VOLUME = 3
"""Of a sample of a sheet: weighted volume [m^3]; the others are its place."""

Resolution: Any = argpack(h=real, spacing=real, mass=real, rest_density=real)
"""Support radius and spacing [m], mass of a particle [kg], and density of the fluid at rest [kg/m^3]."""

Points: Any = argpack(position=Vec4Array, velocity=Vec4Array, slack=RealArray, eased=RealArray)
"""Positions [m] and velocities [m/s]; in gaps (`sim.fluid.boundary.gaps`) slack [m], and the share of the rest density
that does not press yet."""

Samples: Any = argpack(sample=Vec4Array, velocity=Vec4Array, begin=IntArray, size=IntArray, index=IntArray)
"""Samples of sheets and their velocities [m/s]; of each particle, where its list begins and how many are near;
and the lists."""

Solids: Any = argpack(
    shift=vec2,
    pose=DoubleTable,
    boxes=DoubleTable,
    kind=IntArray,
    size=Vec4Array,
    firm=IntArray,
    holds=IntArray,
    slim=IntArray,
    frame=DoubleTable,
    lattice=IntTable,
    table=IntArray,
    nodes=Vec4Array,
    bend=RealArray,
)
"""Tables of `sim.fluid.boundary.shapes.Shapes`, with a row for each solid: its pose and bounding box; kind of shape,
half sizes [m], and -1 for what has the fluid inside; whether it obeys no forces, holds what is along it, and is slim.
Of meshes: low corner and cell of the band [m], first entry of its table of blocks and their number along each axis; of
all, the blocks, and half-space and curvature that each node sees. shift: `calibration.curvature_shift`."""

Walls: Any = argpack(
    spacing=real,
    fit=vec4,
    begin=IntArray,
    size=IntArray,
    share=Vec4Array,
    excess=RealArray,
    solid=IntArray,
    particle=IntArray,
    near=Vec4Array,
    face=Vec4Array,
    weight=RealArray,
    held=RealArray,
    pull=Vec4Array,
    pose=DoubleTable,
)
"""Half-spaces near particles (`sim.fluid.boundary.faces.Faces`): those of particle i are `size[i]` from `begin[i]` on.
pose: where solids are and how they move; spacing of the fluid [m]; fit: `half_space.half_space_fit`."""
