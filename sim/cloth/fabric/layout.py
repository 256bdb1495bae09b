"""How the arrays of a cloth are laid out for kernels.

Members have names of their own in all packs that one kernel takes, and none of its variables is called like one: Taichi
finds arrays by the name of the member alone.
"""

from sim.device.argument_packs import argpack
from sim.device.compiler import ti
from sim.device.double import Integers, Matrices, Numbers, Vectors, vec3, vec4

PARTITIONS = 256
"""Sums are taken over so many ranges, then over those, so that they do not depend on threads."""

Weights = ti.types.ndarray(dtype=vec4, ndim=1)

Points = argpack(position=Vectors, velocity=Vectors, mass=Numbers, mobile=Integers)
"""Positions [m], velocities [m/s], masses [kg], and whether a point is free or goes where its pin takes it."""

Springs = argpack(
    spring_ends=Integers,
    rest_length=Numbers,
    spring_stiffness=Numbers,
    spring_damping=Numbers,
    first_spring=Integers,
    of_spring=Integers,
)
"""Both ends, lengths at rest [m], stiffness [N/m], damping [N s/m]; and the springs of each point, as 2 spring + end
from first_spring[i] to first_spring[i + 1]."""

Hinges = argpack(
    hinge_points=Integers,
    rest_angle=Numbers,
    rigidity=Numbers,
    bend_damping=Numbers,
    first_hinge=Integers,
    of_hinge=Integers,
)
"""Four points, angles at rest [rad], rigidity [N m] and damping [N m s]; and the hinges of each point, as 4 hinge +
corner."""

Drag = argpack(cloth_normal=Vectors, drag_across=Numbers, drag_along=Numbers)
"""Of points: the cloth's normals, and drag of the air across and along it [kg/s]."""

MassSpring = argpack(
    point_count=ti.i32,
    spring_count=ti.i32,
    hinge_count=ti.i32,
    gravity=vec3,
    wind=vec3,
    **Points.members,
    **Springs.members,
    **Hinges.members,
    **Drag.members,
)
"""The whole model of a cloth: points, springs, hinges and the drag of the air in one; gravity [m/s^2] and the wind
[m/s]."""

BlockMatrix = argpack(
    first_block=Integers,
    column=Integers,
    first_element=Integers,
    of_element=Integers,
    slot=Integers,
    off_diagonal=Matrices,
    diagonal=Matrices,
    inertial_diagonal=Matrices,
)
"""A matrix of blocks [N/m]: those of row i, from first_block[i] to first_block[i + 1], and their columns; that of the
diagonal, and what of it is left when all points move alike: inertia and air. Of pairs of points, the elements that they
share, from first_element[k] to first_element[k + 1]: -1 - spring, or 16 hinge + 4 corner of the first + corner of the
other; and the places of their two blocks."""

AlikeRows = argpack(first_alike=Integers, alike_column=Integers, alike=Numbers)
"""What of a matrix is alike along all axes, without its diagonal: where rows begin, columns, and values [N/m]."""

LIMIT, KINETIC, STATIC, LAGGED = range(4)
"""What stands in `law` of a contact: how far along the normal the first side has to be from the other at least [m], the
coefficients of friction while sliding and at rest, and the normal force by which friction is bounded [N], which lags
behind the one that is looked for."""

Contacts = argpack(
    corner=Integers,
    weight=Weights,
    body=Integers,
    body_weight=Numbers,
    body_arm=Vectors,
    normal=Vectors,
    law=Weights,
    stiffness=Numbers,
    normal_force=Numbers,
    friction_force=Vectors,
    contact_force=Vectors,
    tangent_stiffness=Vectors,
    trial_force=Vectors,
    relative_displacement=Vectors,
    force_change=Vectors,
    active=Integers,
    first_contact=Integers,
    of_contact=Integers,
)
"""Contacts: four points, -1 where there is none, and their weights; two coupled bodies, -1 where there is none, sums of
the weights of their points, and of these times places from the centre of mass [m]; the normal; the law; the contact
stiffness [N/m]; the multipliers, a force along the normal [N] and one of friction [N]; the force now, its stiffness
along the normal, across, and along the slip [N/m], and what it would be without the laws of contact [N]; along the
direction of a search, how its sides move apart and its force changes; whether it may press while conjugate gradients
run; and the contacts of each point, as 4 contact + corner."""

ACTIVE, LEAST = range(2)
"""What stands in `active_limit` of a contact: 1 if it takes part in a small step, else 0, and its limit then [m]."""

ProjectedContacts = argpack(
    **{
        name: Contacts.members[name]
        for name in ("corner", "weight", "body", "body_weight", "body_arm", "normal", "law", "normal_force")
    },
    friction_force=Vectors,
    contact_force=Vectors,
    active_limit=Vectors,
    before_step=Vectors,
    force_change=Vectors,
    first_contact=Integers,
    of_contact=Integers,
)
"""The same contacts in small steps, in which forces are found by projection: whether each takes part, and its limit
[m]; where the first side was from the other before the small step [m]; and by what the force changes [N]."""

CoupledBodies = argpack(
    body_inertia=Matrices,
    body_displacement=Vectors,
    body_base=Vectors,
    body_predicted=Vectors,
    first_body_contact=Integers,
    of_body_contact=Integers,
)
"""Rigid bodies whose motion is solved for with that of the cloth, each as two rows: its displacement [m] and its turn
[rad], small as they are, from where it goes without what the cloth changes. Inertia over the step squared;
displacements tried, tried before, and predicted, without what is looked for. And the contacts of each body, as 2
contact + side, from first_body_contact[b] to first_body_contact[b + 1]."""

StepMotion = argpack(
    start=Vectors,
    before=Vectors,
    target=Vectors,
    active_contacts=Numbers,
    body_mobility=Matrices,
    body_velocity=Vectors,
    body_active_contacts=Numbers,
)
"""Small steps. Where points were before the step and before a small one, and where those that are held, and solids, are
to be [m]; contacts of each that take part. Of rows of coupled bodies: one over inertia, the velocity of displacements,
and contacts that take part."""
