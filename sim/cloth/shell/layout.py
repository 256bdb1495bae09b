"""How the arrays of a shell are laid out for kernels, as those of `sim.cloth.fabric.layout`."""

from sim.device.argument_packs import argpack
from sim.device.double import Integers, Numbers, Vectors

ShellRest = argpack(
    shell_corner=Integers,
    warp_slope=Vectors,
    weft_slope=Vectors,
    rest_area=Numbers,
    modulus=Vectors,
    shear_modulus=Numbers,
    barrier=Numbers,
    stretch_delay=Numbers,
    first_corner=Integers,
    of_corner=Integers,
    first_beside=Integers,
    beside=Integers,
    bend_weight=Vectors,
    mirrored=Integers,
    bend_delay=Numbers,
    rest_curvature=Vectors,
    flat_at_rest=Numbers,
)
"""At rest. Triangles: corners; slopes of what is 1 at one corner, of all three, along the warp and the weft [1/m]; the
area [m^2]; moduli of warp, weft and both, of shear, and of the barrier [N/m]; the delay of stress [s]; and the
triangles of each point, as 3 triangle + corner from first_corner[i] to first_corner[i + 1]. Bending: points beside
each, from first_beside[i] to first_beside[i + 1]; their three weights [(N/m)^0.5]; the entry with both in turn; the
delay of moments [s], the curvatures at rest [J^0.5], and 1 in sheets that are flat then, or 0."""

ShellTrial = argpack(
    along_warp=Vectors,
    along_weft=Vectors,
    stress=Vectors,
    pulling_stress=Vectors,
    stiffening=Vectors,
    shell_normal=Vectors,
    strain_before=Vectors,
    warp_moment=Vectors,
    weft_moment=Vectors,
    twist_moment=Vectors,
    normal_push=Vectors,
    curvature_before=Vectors,
)
"""At the places tried. Triangles: where the warp and the weft of unit length at rest have come; stress along warp and
weft, and shear, and the part of it that pulls [N/m]; by the area over that at rest, the first and second derivatives of
the barrier [N/m], and how much stiffer damping makes the step; normals; and the strain before the step. Bending, of
points: moments of the three kinds of curvature [J^0.5], how the normal there would have to turn [J], and the curvatures
before the step [J^0.5]."""
