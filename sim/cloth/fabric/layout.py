"""How the arrays of a cloth are laid out for kernels."""

import taichi as ti

from sim.device.double import Integers, Matrices, Numbers, Vectors, vec4

ROWS = 256
"""Sums are taken over so many ranges, then over those, so that they do not depend on threads."""

Weights = ti.types.ndarray(dtype=vec4, ndim=1)

Points = ti.types.argpack(position=Vectors, velocity=Vectors, mass=Numbers, mobile=Integers)
"""Positions [m], velocities [m/s], masses [kg], and whether a point is free or goes where its pin leads it."""

Strands = ti.types.argpack(
    ends=Integers,
    rest=Numbers,
    stiff=Numbers,
    damp=Numbers,
    first_spring=Integers,
    of_spring=Integers,
)
"""Springs: both ends, lengths at rest [m], stiffness [N/m], damping [N s/m]; and those of each point, as 2 spring + end
from first_spring[i] to first_spring[i + 1]."""

Angles = ti.types.argpack(
    corners=Integers,
    rest_angle=Numbers,
    rigid=Numbers,
    bend_damp=Numbers,
    first_hinge=Integers,
    of_hinge=Integers,
)
"""Hinges: four points, angles at rest [rad], rigidity [N m] and damping [N m s]; and those of each point, as 4 hinge +
corner."""

Drag = ti.types.argpack(face=Vectors, drag_across=Numbers, drag_along=Numbers)
"""Of points: the cloth's normals, and drag of the air across and along it [kg/s]."""

Rows = ti.types.argpack(
    first_block=Integers,
    column=Integers,
    first_tie=Integers,
    of_tie=Integers,
    slot=Integers,
    off_block=Matrices,
    own_block=Matrices,
    alone_block=Matrices,
)
"""A matrix of blocks [N/m]: those of row i, from first_block[i] to first_block[i + 1], and their columns; that of the
diagonal, and what of it is left when all points move alike: inertia and air. Of pairs of points, what ties them, from
first_tie[k] to first_tie[k + 1]: -1 - spring, or 16 hinge + 4 corner of the first + corner of the other; and the places
of their two blocks."""

Touches = ti.types.argpack(
    touch_corner=Integers,
    touch_weight=Weights,
    touch_body=Integers,
    touch_sum=Numbers,
    touch_arm=Vectors,
    touch_normal=Vectors,
    law=Weights,
    hard=Numbers,
    press=Numbers,
    grip=Vectors,
    touch_force=Vectors,
    touch_block=Vectors,
    touch_trial=Vectors,
    touch_way=Vectors,
    awake=Integers,
    first_touch=Integers,
    of_touch=Integers,
)
"""Contacts: four points, -1 where there is none, and their weights; two bodies that give way, -1 where there is none,
sums of the weights of their points, and of these times places from the centre of mass [m]; the normal; how far along it
the first side has to be from the other at least [m], the coefficients of friction while sliding and at rest, and the
force along the normal that they count of [N]; the stiffness with which contacts are looked for [N/m]; the force along
the normal [N] and across [N] that is known of; the force now, its stiffness along the normal, across, and along the
slip [N/m], and what it would be without the laws of contact [N]; how its sides move apart, or its force changes;
whether it may press while conjugate gradients run; and those of each point, as 4 contact + corner.

In small steps `touch_block` is whether a contact takes part, and its limit then [m], `touch_trial` where the first side
was from the other before [m], and `touch_way` by what the force changes [N]."""

Loose = ti.types.argpack(
    loose_block=Matrices,
    loose_way=Vectors,
    loose_base=Vectors,
    loose_aim=Vectors,
)
"""Bodies that obey forces, each as two rows: its way [m] and its turn [rad], small as they are, from where it goes
without what the cloth changes. Inertia over the step squared; ways tried, tried before, and taken without what is
looked for."""

Holds = ti.types.argpack(first_hold=Integers, of_hold=Integers)
"""Contacts of each body, as 2 contact + side, from first_hold[b] to first_hold[b + 1]."""

Way = ti.types.argpack(start=Vectors, before=Vectors, aims=Vectors, shares=Numbers)
"""Where points were before a step and before a small step, and where those that are held, and solids, are to be [m];
contacts of each that take part in a small step."""

Pace = ti.types.argpack(body_gives=Matrices, body_speed=Vectors, body_shares=Numbers)
"""Of the rows of bodies in small steps: one over inertia, the speed of their ways, and contacts that take part."""
