"""Timed changes of the scene: an event turns one valid specification into the next."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from typing import Any, get_args

from pydantic import ValidationError

from scene.diagnostics.suggestions import similar, suggestion
from scene.diagnostics.wrong_values import reason
from scene.settings import Refused, Settings
from sim.spec import Event, SimulationSpec

TIME_TOLERANCE = 1e-12
"""Times closer than this [s] are the same."""


def spec_at(spec: SimulationSpec, time: float) -> SimulationSpec:
    """The specification in force at `time` [s], after the events up to it; it has no events itself."""
    return _after(spec, lambda event: event.at < time + TIME_TOLERANCE)


def spec_before(spec: SimulationSpec, time: float) -> SimulationSpec:
    """The specification in force just before `time` [s], when the events at this time are still to come."""
    return _after(spec, lambda event: event.at < time - TIME_TOLERANCE)


def events_between(spec: SimulationSpec, start: float, end: float) -> list[tuple[float, list[Event]]]:
    """The times [s] from `start` up to, without, `end` at which something happens, and what."""
    found: list[tuple[float, list[Event]]] = []
    for event in spec.events:
        if start - TIME_TOLERANCE <= event.at < end - TIME_TOLERANCE:
            if found and event.at < found[-1][0] + TIME_TOLERANCE:
                found[-1][1].append(event)
            else:
                found.append((event.at, [event]))
    return found


def _after(spec: SimulationSpec, happened: Callable[[Event], bool]) -> SimulationSpec:
    current = spec.model_copy(update={"events": ()})
    for index, event in enumerate(spec.events):
        if happened(event):
            current = apply(current, event, index)
    return current


def apply(spec: SimulationSpec, event: Event, index: int) -> SimulationSpec:
    """The specification after `event`; raises Refused where a value does not fit.

    Removed fluid bodies stay in the specification, since their settings are the liquid's; their
    particles are taken out by the world.
    """
    data = spec.model_dump(mode="python", exclude_none=True)
    for addition, group, field in (
        ("fluid", "fluid", "bodies"),
        ("emitters", "fluid", "emitters"),
        ("drains", "fluid", "drains"),
        ("rigid", "rigid", "bodies"),
        ("cloth", "cloth", "sheets"),
    ):
        added = getattr(event.add, addition)
        if added:
            dumped = {name: body.model_dump(mode="python", exclude_none=True) for name, body in added.items()}
            data.setdefault(group, {}).setdefault(field, {}).update(dumped)
    data["containers"].update(
        {name: body.model_dump(mode="python", exclude_none=True) for name, body in event.add.containers.items()}
    )
    for name, body in event.add.rigid.items():
        if body.motion == "prescribed" and not body.keyframes and body.start is None:
            data["rigid"]["bodies"][name]["start"] = event.at
    for name in event.remove:
        data["containers"].pop(name, None)
        for field in ("emitters", "drains"):
            data.get("fluid", {}).get(field, {}).pop(name, None)
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
        raise _refusal(event, index, first) from None


FIXED = (
    "fps",
    "fluid.particle_radius",
    "fluid.support_ratio",
    "fluid.solver",
    "fluid.dfsph.iteration",
    "events",
    "probes",
)
"""Settings that cannot change while particles exist."""


def _assign(data: dict[str, Any], path: str, value: Any, location: tuple[str | int, ...]) -> None:
    for fixed in FIXED:
        if f"{path}.".startswith(f"{fixed}.") or fixed.startswith(f"{path}."):
            raise Refused(
                f"{fixed} cannot change during the simulation",
                location=location,
                remedy="give it once at the start, or set single settings of the group that are free to change",
            )
    *groups, last = path.split(".")
    target, before = data, _names(data)
    for depth, key in enumerate(groups):
        inner = target.get(key)
        if isinstance(inner, list | tuple):
            remedy = f"set the whole list, as `{'.'.join(groups[: depth + 1])}: {json.dumps(inner)}`"
            raise Refused(f"'{key}' is a list", location=location, remedy=remedy)
        if not isinstance(inner, dict):
            raise _unknown(path, key, target, location)
        target = inner
    new = ".".join(groups) in NAMED and last not in target
    target[last] = value
    changed = before ^ _names(data)
    if new and similar(last, target.keys() - {last}):
        raise _unknown(path, last, target.keys() - {last}, location)
    if changed:
        raise Refused(
            f"set can neither bring in nor take out '{min(changed)}'",
            location=location,
            remedy="use add and remove, or set single settings of what is there",
        )


NAMED = ("containers", "fluid.bodies", "fluid.emitters", "fluid.drains", "rigid.bodies", "cloth.sheets")
"""Groups whose keys are names that the scene gives."""


def _names(data: dict[str, Any]) -> set[str]:
    """All names that the scene gives, as far as its groups are groups."""
    found: set[str] = set()
    for path in NAMED:
        group: Any = data
        for key in path.split("."):
            group = group.get(key) if isinstance(group, dict) else None
        found |= set(group) if isinstance(group, dict) else set()
    return found


def _refusal(event: Event, index: int, detail: Any) -> Refused:
    """Blame the `set` whose path the invalid field lies at, or the event where there is none."""
    field = tuple(map(str, detail["loc"]))
    message, remedy = reason(detail)
    for path in event.set:
        keys = tuple(path.split("."))
        # Pydantic puts the chosen members of unions between the keys.
        if [key for key in field if key in keys][: len(keys)] == list(keys):
            location = ("events", index, "set", path)
            if detail["type"] == "extra_forbidden":
                return _unknown(path, keys[-1], _known(keys[:-1]), location)
            within = "" if field[-1] == keys[-1] else f"{field[-1]}: "
            return Refused(f"{within}{message}", location=location, remedy=remedy)
    return Refused(
        f"the event cannot be applied: {'.'.join(field)}: {message}", location=("events", index), remedy=remedy
    )


def _unknown(path: str, key: str, known: Iterable[str], location: tuple[str | int, ...]) -> Refused:
    known = sorted(known)
    close = similar(key, known)
    meant = ".".join(close[0] if part == key else part for part in path.split(".")) if close else ""
    remedy = f"did you mean '{meant}'?" if close else suggestion(key, known)
    return Refused(f"there is no setting '{path}'", location=location, remedy=remedy)


def _known(groups: tuple[str, ...]) -> list[str]:
    """The settings of a group of the simulation, as far as it has fixed ones."""
    model: Any = SimulationSpec
    for key in groups:
        field = model.model_fields.get(key)
        members = (field.annotation, *get_args(field.annotation)) if field else ()
        model = next((m for m in members if isinstance(m, type) and issubclass(m, Settings)), None)
        if model is None:
            return []
    return list(model.model_fields)
