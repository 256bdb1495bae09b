"""Timed changes of the scene: an event turns one valid specification into the next."""

from __future__ import annotations

from typing import Any

from pydantic import ValidationError

from sim.settings import Refused
from sim.spec import Event, SimulationSpec


def spec_at(spec: SimulationSpec, time: float) -> SimulationSpec:
    """The specification in force at `time` [s], after the events up to it; it has no events itself."""
    current = spec.model_copy(update={"events": ()})
    for index, event in enumerate(spec.events):
        if event.at <= time:
            current = apply(current, event, index)
    return current


def apply(spec: SimulationSpec, event: Event, index: int) -> SimulationSpec:
    """The specification after `event`; raises Refused where a value does not fit.

    Removed fluid bodies stay in the specification, since their settings are the liquid's; their
    particles are taken out by the world.
    """
    data = spec.model_dump(mode="python", exclude_none=True)
    for group, field in (("fluid", "bodies"), ("rigid", "bodies"), ("cloth", "sheets")):
        added = getattr(event.add, group)
        if added:
            data.setdefault(group, {}).setdefault(field, {}).update(
                {name: body.model_dump(mode="python", exclude_none=True) for name, body in added.items()}
            )
    data["containers"].update(
        {name: body.model_dump(mode="python", exclude_none=True) for name, body in event.add.containers.items()}
    )
    for name in event.remove:
        data["containers"].pop(name, None)
        for group, field in (("rigid", "bodies"), ("cloth", "sheets")):
            if group in data:
                data[group][field].pop(name, None)
                if not data[group][field]:
                    del data[group]
    for path, value in event.set.items():
        _assign(data, path, value, ("events", index, "set", path))
    try:
        return SimulationSpec.model_validate(data)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        field = ".".join(str(part) for part in first["loc"])
        raise Refused(
            f"the event can not be applied: {field}: {first['msg']}",
            location=("events", index, *(("set", next(iter(event.set))) if event.set else ())),
            remedy="give a path of the scene and a value of its kind, as `gravity: [0, 0, 0]`",
        ) from None


FIXED = ("fps", "fluid.particle_radius", "fluid.support_ratio", "fluid.solver", "events", "probes")
"""Settings that can not change while particles exist."""


def _assign(data: dict[str, Any], path: str, value: Any, location: tuple[str | int, ...]) -> None:
    if any(path == fixed or path.startswith(f"{fixed}.") for fixed in FIXED):
        raise Refused(f"{path} can not change during the simulation", location=location, remedy="set it at the start")
    *groups, last = path.split(".")
    target = data
    for key in groups:
        if not isinstance(target.get(key), dict):
            raise Refused(f"there is no setting '{path}'", location=location, remedy="give a dotted path of the scene")
        target = target[key]
    target[last] = value
