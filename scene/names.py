"""Every name in the settings that refers to something, found among what there is at the start and through events."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from scene.diagnostics.suggestions import suggestion
from scene.events import apply
from scene.settings import Refused
from sim.rigid.spec import ContactPair
from sim.spec import SimulationSpec

Location = tuple[str | int, ...]

FLUID = ("a fluid body", "an emitter", "a drain")
SOLID = ("a rigid body", "a container")
KINDS: dict[Location | str | int, str] = {
    ("fluid", "bodies"): "a fluid body",
    ("fluid", "emitters"): "an emitter",
    ("fluid", "drains"): "a drain",
    ("rigid", "bodies"): "a rigid body",
    ("cloth", "sheets"): "a sheet of cloth",
    "fluid": "a fluid body",
    "emitters": "an emitter",
    "drains": "a drain",
    "rigid": "a rigid body",
    "cloth": "a sheet of cloth",
    "containers": "a container",
}
"""What has a name, by its group of settings, or by the key of an event's `add`."""


@dataclass(frozen=True)
class Named:
    """Something that has a name, and where the scene gives it."""

    kind: str
    location: Location
    body: Any


def named(spec: SimulationSpec) -> dict[str, Named]:
    """All that has a name, at any time; raises Refused where two have the same."""
    found: dict[str, Named] = {}
    for location, body in spec.placements():
        name = str(location[-1])
        if name in found:
            first = ".".join(map(str, found[name].location))
            raise Refused(
                f"there is already a body named '{name}', {first}",
                location=location,
                remedy="give each body, sheet and container a name of its own",
            )
        kind = KINDS[location[:-1]] if location[:-1] in KINDS else KINDS[location[-2]]
        found[name] = Named(kind, location, body)
    return found


def resolve(spec: SimulationSpec) -> dict[str, Named]:
    """All that has a name; raises Refused where a setting names what there never is, or what it cannot be about."""
    found = named(spec)
    for name, probe in spec.probes.items():
        _resolve_probe(("probes", name), probe, found)
        if probe.MATERIAL not in {None, *spec.materials()}:
            message = f"this probe measures {probe.MATERIAL}, and the scene has none"
            raise Refused(message, location=("probes", name), remedy="remove it")
    if spec.rigid is not None:
        _resolve_pairs(spec.rigid.pairs, found, ("rigid", "pairs"))
    _resolve_events(spec, found)
    return found


def resolve_one(name: str, found: dict[str, Named], location: Location) -> Named:
    """What a name refers to; raises Refused where that is nothing."""
    if name not in found:
        raise Refused(f"there is no body named '{name}'", location=location, remedy=_offer(name, found))
    return found[name]


def _resolve_probe(location: Location, probe: Any, found: dict[str, Named]) -> None:
    body, sheet = (getattr(probe, key, None) for key in ("body", "sheet"))
    if body is not None:
        solids = {name: item for name, item in found.items() if item.kind == "a rigid body" and _has_surface(item.body)}
        if body in found and body not in solids:
            raise Refused(
                f"the {probe.type} on '{body}' cannot be measured: it is no rigid body with a surface",
                location=(*location, "body"),
                remedy=_offer(body, solids, "name a rigid body that is no plane"),
            )
        resolve_one(body, found if body in found else solids, (*location, "body"))
    if sheet is not None:
        sheets = {name: item for name, item in found.items() if item.kind == "a sheet of cloth"}
        if sheet not in sheets:
            raise Refused(
                f"'{sheet}' is no sheet of cloth",
                location=(*location, "sheet"),
                remedy=_offer(sheet, sheets, "the scene has none: remove the probe"),
            )


def _resolve_pairs(pairs: Iterable[ContactPair], known: dict[str, Named], location: Location) -> None:
    solids = {name: item for name, item in known.items() if item.kind in SOLID}
    for index, pair in enumerate(pairs):
        for name in pair.between:
            here = (*location, index, "between")
            if name in known and name not in solids:
                message = f"'{name}' is {known[name].kind}, which has no contacts with friction of its own"
                raise Refused(message, location=here, remedy="name two rigid bodies, or one and a container")
            if name not in solids:
                remedy = _offer(name, solids, "name two rigid bodies, or one and a container")
                raise Refused(f"there is no body named '{name}'", location=here, remedy=remedy)
        if pair.between[0] == pair.between[1]:
            message = f"'{pair.between[0]}' is named twice, and does not meet itself"
            raise Refused(message, location=(*location, index, "between"), remedy="name two bodies")


def _resolve_events(spec: SimulationSpec, found: dict[str, Named]) -> None:
    """What events remove is there at that time; what pairs name that they set is there, or is still to come."""
    present = [name for name, item in found.items() if item.location[0] != "events"]
    to_come = [name for event in spec.events for name in event.add.names()]
    for index, event in enumerate(spec.events):
        present += event.add.names()
        to_come = to_come[len(event.add.names()) :]
        for name in event.remove:
            if name not in present:
                when = "at that time " if name in found else ""
                message = f"{when}there is no body named '{name}'"
                raise Refused(message, location=("events", index, "remove"), remedy=_offer(name, present))
            present.remove(name)
        for path in {"rigid", "rigid.pairs"} & event.set.keys():
            known = {name: found[name] for name in (*present, *to_come)}
            try:
                _resolve_pairs(_pairs_after(spec, index), known, ())
            except Refused as refused:
                location = ("events", index, "set", path)
                raise Refused(refused.message, location=location, remedy=refused.remedy) from None


def _pairs_after(spec: SimulationSpec, last: int) -> tuple[ContactPair, ...]:
    """What the events up to this one leave of exceptions from friction."""
    current = spec.model_copy(update={"events": ()})
    for index, event in enumerate(spec.events[: last + 1]):
        current = apply(current, event, index)
    return current.rigid.pairs if current.rigid else ()


def _has_surface(body: Any) -> bool:
    return body.shape.type != "plane"


def _offer(name: str, known: Iterable[str], otherwise: str = "the scene has none") -> str:
    """`did you mean ...?` or what is known, or, where nothing is, other words."""
    known = list(known)
    return suggestion(name, known) if known else otherwise
