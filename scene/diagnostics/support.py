"""Which settings of the schema are simulated: the rest is refused by name, never ignored."""

from __future__ import annotations

from typing import Any

from scene.events import apply
from scene.settings import Refused
from sim.cloth.spec import Cloth
from sim.rigid.spec import RigidBody
from sim.spec import BoxContainer, Event, SimulationSpec


def refuse_unsupported(spec: SimulationSpec) -> None:
    """Raise Refused for the first setting that the schema knows and no solver does yet."""
    _refuse_empty_fluid(spec)
    _refuse_settings(spec)
    current = spec.model_copy(update={"events": ()})
    for index, event in enumerate(spec.events):
        current = apply(current, event, index)
        try:
            _refuse_settings(current)
        except Refused as refused:
            path = ".".join(map(str, refused.location))
            location = ("events", index, "set", path) if path in event.set else ("events", index)
            raise Refused(refused.message, location=location, remedy=refused.remedy) from None


def _refuse_empty_fluid(spec: SimulationSpec) -> None:
    if spec.fluid is None or spec.fluid.bodies or spec.fluid.emitters:
        return
    if not any(event.add.fluid or event.add.emitters for event in spec.events):
        remedy = "add fluid.bodies or fluid.emitters, or an event that adds one"
        raise Refused("the fluid has no bodies and no emitters", location=("fluid",), remedy=remedy)


def _refuse_settings(spec: SimulationSpec) -> None:
    for location, body in spec.placements():
        group = location[-2] if location[0] == "events" else location[0]
        held = spec.fluid is not None or spec.has_dynamic_bodies()
        if group == "containers" and not isinstance(body, BoxContainer) and not held:
            message = "a mesh container without fluid or dynamic bodies holds nothing"
            raise Refused(message, location=location, remedy="add fluid, or a body with motion: dynamic")
    if spec.cloth is not None:
        _refuse_meetings(spec, spec.cloth)
    if spec.fluid is not None and spec.fluid.method == "dfsph_jacobi":
        _refuse_what_jacobi_does_not_move(spec)
    for name, probe in spec.probes.items():
        if probe.type == "force" and probe.region and _is_dynamic(spec, probe.body):
            raise Refused(
                f"the force on a part of '{probe.body}' cannot be measured, which obeys forces",
                location=("probes", name, "region"),
                remedy="leave it out, or use a body with motion: static or prescribed",
            )
    for index, event in enumerate(spec.events):
        for part in ("fluid", "emitters", "drains"):
            if getattr(event.add, part) and spec.fluid is None:
                raise Refused(
                    f"{part} can only be added to a scene that has a fluid section",
                    location=("events", index, "add", part),
                    remedy="give the fluid section, with fluid.particle_radius",
                )

    _refuse_what_events_make(spec)


def _refuse_what_events_make(spec: SimulationSpec) -> None:
    current = spec.model_copy(update={"events": ()})
    for index, event in enumerate(spec.events):
        before, current = current, apply(current, event, index)
        _refuse_jumps(before, current, index)
        _refuse_beginnings(before, current, event, index)
        try:
            refuse_unsupported(current)
        except Refused as refused:
            path = ".".join(map(str, refused.location))
            location = ("events", index, "set", path) if path in event.set else ("events", index)
            raise Refused(refused.message, location=location, remedy=refused.remedy) from None


def _refuse_jumps(before: SimulationSpec, after: SimulationSpec, index: int) -> None:
    """Raise Refused where an event changes how a body moves, which would take it elsewhere at once."""
    bodies = before.rigid.bodies if before.rigid else {}
    for name, body in (after.rigid.bodies if after.rigid else {}).items():
        earlier = bodies.get(name, body)
        if "prescribed" in (earlier.motion, body.motion) and _path(earlier) != _path(body):
            raise Refused(
                f"the motion of '{name}' cannot be changed by an event",
                location=("events", index),
                remedy="give all of it as keyframes from the start",
            )


BEGINNING = ("position", "rotation", "velocity", "angular_velocity")
"""How what moves by itself begins."""


def _refuse_beginnings(before: SimulationSpec, after: SimulationSpec, event: Event, index: int) -> None:
    """Raise Refused where an event changes how something that is there already began, which nothing looks at again."""
    for group, field in (("fluid", "bodies"), ("rigid", "bodies"), ("cloth", "sheets")):
        earlier = getattr(getattr(before, group), field, {})
        for name, body in getattr(getattr(after, group), field, {}).items():
            if name in earlier and _begins_otherwise(group, earlier[name], body):
                path = f"{group}.{field}.{name}"
                given = [key for key in event.set if f"{key}.".startswith(f"{path}.")]
                raise Refused(
                    f"'{name}' is there already: how it begins cannot be changed by an event",
                    location=("events", index, "set", given[0]) if given else ("events", index),
                    remedy="remove it and add another, or let forces, pins or gravity move it",
                )


def _begins_otherwise(group: str, earlier: Any, body: Any) -> bool:
    """Whether the settings differ that only the beginning looks at: all of a body of fluid."""
    if group == "fluid":
        return earlier != body
    if group == "rigid" and not earlier.motion == body.motion == "dynamic":
        return False
    return any(getattr(earlier, name, None) != getattr(body, name, None) for name in BEGINNING)


def _path(body: RigidBody) -> tuple[Any, ...]:
    shape = (body.shape, body.position, body.rotation, body.scale)
    return (*shape, body.motion, body.velocity, body.angular_velocity, body.start, body.keyframes)


def _refuse_meetings(spec: SimulationSpec, cloth: Cloth) -> None:
    """What cloth does not meet yet."""
    if spec.fluid is not None and spec.fluid.solver == "pcisph":
        message = "cloth meets fluid with dfsph, iisph and wcsph only, not with pcisph"
        raise Refused(message, location=("fluid", "solver"), remedy="use fluid.solver: dfsph")
    if spec.fluid is not None and spec.fluid.viscosity_solver == "implicit":
        message = "cloth does not meet fluid whose viscosity is implicit yet"
        raise Refused(message, location=("fluid", "viscosity_solver"), remedy="use fluid.viscosity_solver: explicit")
    if spec.fluid is not None and cloth.integrator != "implicit_euler":
        message = f"cloth meets fluid with implicit_euler only, not with {cloth.integrator} yet"
        raise Refused(message, location=("cloth", "integrator"), remedy="use cloth.integrator: implicit_euler")


def _refuse_what_jacobi_does_not_move(spec: SimulationSpec) -> None:
    if spec.cloth is not None or spec.has_dynamic_bodies():
        what = "cloth" if spec.cloth is not None else "bodies that obey forces"
        raise Refused(
            f"the Jacobi iterations of dfsph do not move {what} yet",
            location=("fluid", "dfsph", "iteration"),
            remedy="use fluid.dfsph.iteration: conjugate_gradients",
        )


def _is_dynamic(spec: SimulationSpec, name: str) -> bool:
    return any(
        location[-1] == name and getattr(body, "motion", None) == "dynamic" for location, body in spec.placements()
    )
