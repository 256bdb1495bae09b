"""How the arrays of bodies and of their contacts are laid out for kernels.

Members have names of their own in all packs that one kernel takes, and none of its variables is called like one: Taichi
finds arrays by the name of the member alone.
"""

from typing import Any

from sim.device.argument_packs import argpack
from sim.device.double import Integers, Matrices, Numbers, Quaternions, Vectors

Motion: Any = argpack(
    position=Vectors,
    rotation=Quaternions,
    velocity=Vectors,
    spin=Vectors,
    momentum=Vectors,
    inverse_mass=Numbers,
    inverse_inertia=Matrices,
)
"""Bodies in the world: centres of mass [m], rotations, velocities [m/s] and [rad/s], angular momenta
[kg m^2/s]; inverse mass [1/kg] and inverse inertia about the centre in world axes [1/(kg m^2)], zero of bodies that
nothing moves."""

BodyProperties: Any = argpack(
    dynamic=Integers,
    fluid_driven=Integers,
    velocity_lag=Numbers,
    mass=Numbers,
    own_inverse_inertia=Matrices,
)
"""Whether bodies obey forces, and whether fluid moves them, so that they go by their velocity at the end of a step; by
how much velocities and momenta are those of an earlier time [s]; mass [kg], and inverse inertia in the bodies' own axes
[1/(kg m^2)]."""

Loads: Any = argpack(force=Vectors, torque=Vectors, fluid_force=Vectors, fluid_torque=Vectors)
"""On bodies, about their centres of mass, but for gravity and contacts: forces [N] and torques [N m], and those of the
fluid."""

StepVelocities: Any = argpack(
    old_velocity=Vectors,
    old_spin=Vectors,
    free_velocity=Vectors,
    free_spin=Vectors,
    middle_velocity=Vectors,
)
"""Of bodies [m/s] and [rad/s]: before a step, at its end if nothing were met, and in its middle."""

Pairs: Any = argpack(pair_body=Integers, number=Integers, first=Integers, surface=Numbers, scale=Numbers)
"""Pairs of bodies that are near: both bodies; how many contacts each has, and which is the first; coefficients of
friction while sliding and at rest, and the restitution; size of the smaller body [m]."""

Contacts: Any = argpack(
    body=Integers,
    place=Vectors,
    normal=Vectors,
    arc_velocity=Vectors,
    limit=Numbers,
    kinetic_friction=Numbers,
    static_friction=Numbers,
    normal_impulse=Numbers,
    friction_impulse=Vectors,
    normal_mass=Numbers,
    normal_response=Vectors,
    tangent_mass=Numbers,
    impulse_change=Vectors,
    search_direction=Vectors,
)
"""Contacts: both bodies, place [m], normal towards the first, what turning adds over the step to the relative velocity
across, and the least one along the normal [m/s], coefficients of friction while sliding and at rest, impulses along the
normal and across [N s], and their effective masses [kg]; change of the relative velocity by an impulse along the normal
[1/kg]; what the last sweep added to the impulses and the direction in
which they go on [N s]."""

PreviousContacts: Any = argpack(
    first_previous=Integers, previous_body=Integers, previous_place=Vectors, previous_force=Vectors
)
"""Contacts of the step before: of each pair of now where its own begin and end; both bodies; places in the first
bodies' axes, from their centres of mass [m], and forces on the first bodies [N]."""

Bounces: Any = argpack(
    restitution=Numbers,
    extra=Numbers,
    slow=Numbers,
    struck=Integers,
    bounce=Numbers,
    target_velocity=Numbers,
    blow=Numbers,
)
"""Of contacts: the restitution of their surfaces; how much faster bodies will be along the normal when they meet [m/s];
speeds that are no blow [m/s]; 1 of those that press, 2 of those that are struck; the restitution in this step; the
relative velocity along the normal that each is to have at least [m/s]; impulses of the present blow [N s]."""
