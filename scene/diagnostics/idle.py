"""Settings that a scene gives and that change nothing, because another setting switches them off."""

from __future__ import annotations

import functools
import itertools
import operator
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from render.looks.spec import OF_BODIES, OF_SHEETS
from scene.document import Location
from scene.load import Scene
from scene.names import resolve
from scene.settings import Caution, Settings, choices
from sim.cloth.spec import Cloth
from sim.fluid.spec import Fluid

ANY = "*"
"""In a path: each name there is."""


@dataclass(frozen=True)
class Dependence:
    """Settings that count only where another setting is such."""

    settings: tuple[Location, ...]
    on: Location
    counts: Callable[[Any], bool]
    because: str
    """With {value}, that of the other setting."""


def _sections(path: str, model: type[Settings], of: str) -> Iterator[Dependence]:
    """Settings of each of the methods that the setting `of` chooses from; those of installed packages are in extra."""
    for name in choices(model, of):
        section = (path, name) if name in model.model_fields else (path, "extra", name)
        other = f"it is for {of}: {name}, and the scene has {of}: {{value}}: change one of the two, or remove it"
        yield Dependence((section,), (path, of), functools.partial(operator.eq, name), other)


def _within(path: Location, names: str, on: str, counts: Callable[[Any], bool], because: str) -> Dependence:
    """Settings side by side."""
    return Dependence(tuple((*path, name) for name in names.split()), (*path, on), counts, because)


_SHEET: Location = ("cloth", "sheets", ANY)
_NO_MASS = "a body of motion: {value} obeys no forces, whatever it weighs: add `motion: dynamic`, or remove it"
_OFF = "strength: 0 switches this light off: raise strength, or remove it"
DEPENDENCES = (
    *_sections("fluid", Fluid, "solver"),
    _within(
        ("fluid", "dfsph"),
        "hyperviscosity",
        "iteration",
        lambda value: value == "conjugate_gradients",
        "iteration: jacobi damps nothing: change iteration to conjugate_gradients, or remove it",
    ),
    *_sections("cloth", Cloth, "integrator"),
    Dependence(
        tuple((*_SHEET, name) for name in ("bend_model", "damping", "bend_damping")),
        ("cloth", "model"),
        lambda value: value == "springs",
        "it is for masses and springs, and a shell is damped by damping_time and bend_damping_time of its fabric: "
        "give these, or remove it",
    ),
    Dependence(
        tuple((*_SHEET, name) for name in ("stretch_stiffness", "shear_stiffness", "bend_stiffness")),
        (*_SHEET, "woven", "type"),
        lambda value: value is None,
        "fabric: {value} brings a stiffness of its own: change it there, as warp_stiffness, or remove it",
    ),
    _within(("rigid", "bodies", ANY), "density mass", "motion", lambda value: value == "dynamic", _NO_MASS),
    _within(("events", ANY, "add", "rigid", ANY), "density mass", "motion", lambda value: value == "dynamic", _NO_MASS),
    _within(
        ("fluid",),
        "implicit_viscosity",
        "viscosity_solver",
        lambda value: value != "explicit",
        "viscosity_solver is explicit: make it auto or implicit, or remove it",
    ),
    _within(
        ("fluid",),
        "surface_tension_model",
        "surface_tension",
        bool,
        "there is no surface tension: give surface_tension, which is 0.072 N/m for water, or remove it",
    ),
    _within(("render", "lights", "sun"), "azimuth elevation color angle", "strength", bool, _OFF),
    _within(("render", "lights", "environment"), "light file rotation", "strength", bool, _OFF),
    _within(("render", "ground"), "height material", "enabled", bool, "no ground is drawn: enable it, or remove it"),
    _within(("render",), "shutter", "motion_blur", bool, "motion_blur is off: switch it on, or remove it"),
    _within(
        ("render",),
        "contrast",
        "view_transform",
        lambda value: value != "Standard",
        "view_transform: Standard has no choice of contrast: take AgX or Filmic, or remove it",
    ),
    _within(("surface", "layers"), "reach", "enabled", bool, "layers are off: enable them, or remove it"),
    _within(
        ("surface", "smoothing"),
        "weighted normalization",
        "iterations",
        bool,
        "iterations: 0 smooths nothing: raise iterations, or remove it",
    ),
    _within(
        ("surface", "cleanup"),
        "snap_distance decimate_barnacles",
        "enabled",
        bool,
        "cleanup is off: enable it, or remove it",
    ),
)


def cautions(scene: Scene) -> Iterator[Caution]:
    """One for each setting that changes nothing. A setting that a preset, the wedge or an event changes may."""
    data, varied = scene.document.data, set(_varied(scene.document.data))
    whole = {**vars(scene.simulation), "surface": scene.surface, "render": scene.render}
    for dependence in DEPENDENCES:
        for setting in dependence.settings:
            for place in _given(data, setting):
                on = tuple(place[k] if part == ANY else part for k, part in enumerate(dependence.on))
                value = _value(whole, on)
                if not dependence.counts(value) and on not in varied:
                    yield Caution(f"changes nothing: {dependence.because.format(value=value)}", place)
    yield from _of_others_alone(scene)


def _of_others_alone(scene: Scene) -> Iterator[Caution]:
    """One for each setting of a look that only sheets, or only bodies show, on something else."""
    found = resolve(scene.simulation)
    looks = (("render", "materials", ANY), ("render", "ground", "material"), ("render", "water"), ("render", "foam"))
    for kind, settings in (("a sheet of cloth", OF_SHEETS), ("a rigid body", OF_BODIES)):
        shown = {name for name, item in found.items() if item.kind == kind}
        for look, setting in itertools.product(looks, settings):
            for place in _given(scene.document.data, (*look, setting)):
                if place[:2] != ("render", "materials") or place[2] not in shown:
                    yield Caution(f"changes nothing: only {kind} shows it: remove it", place)


def _given(data: Any, setting: Location) -> Iterator[Location]:
    """Where the data holds the setting."""
    if not setting:
        yield ()
        return
    keys = list(data) if isinstance(data, dict) else list(range(len(data))) if isinstance(data, list) else []
    for key in keys:
        if setting[0] in {key, ANY}:
            yield from ((key, *rest) for rest in _given(data[key], setting[1:]))


def _value(whole: Any, path: Location) -> Any:
    for part in path:
        if isinstance(whole, Mapping):
            whole = whole[part]
        else:
            whole = whole[int(part)] if isinstance(whole, Sequence) else getattr(whole, str(part))
    return whole


def _varied(data: dict[str, Any]) -> Iterator[Location]:
    """What is not the same in all films of the scene, or not all the time in them."""
    for preset in data.get("presets", {}).values():
        yield from _leaves(preset)
    for group in (data.get("wedge", {}), *(event.get("set", {}) for event in data.get("events", ()))):
        yield from (tuple(path.split(".")) for path in group)


def _leaves(data: Any) -> Iterator[Location]:
    if not isinstance(data, dict):
        yield ()
        return
    for key, value in data.items():
        yield from ((key, *rest) for rest in _leaves(value))
