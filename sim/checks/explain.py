"""What a scene models and why, what it leaves out, and what it could leave out without effect."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from scene.events import spec_at
from sim.run.placing.placed_scene import PlacedScene
from sim.run.reporting.counts import Counts
from sim.spec import SimulationSpec

if TYPE_CHECKING:
    from sim.cloth.model import PlacedSheet
    from sim.cloth.spec import Air
    from sim.fluid.spec import Fluid

NUMERICAL = 0.3
"""Numerical viscosity over spacing and sqrt(g H): measured by the decay of standing waves in water of the depth H, 0.28
to 0.34 for all solvers at 8 to 20 layers (docs/fluids.md)."""
NEGLIGIBLE = 0.01
"""Share of an effect below which what causes it may be left out."""
MATERIALS = {"fluid": "fluid", "rigid": "rigid bodies", "cloth": "cloth"}


@dataclass(frozen=True)
class Line:
    """Something about a part of the scene: a setting, or a material."""

    subject: str
    text: str


@dataclass(frozen=True)
class Explanation:
    models: list[Line]
    leaves_out: list[Line]
    could_leave_out: list[Line]


def explain(spec: SimulationSpec, folder: Path, duration: float) -> Explanation:
    """Look at a scene as it starts, `duration` in s; what events add counts as there. Raises Refused."""
    placed = PlacedScene(spec_at(spec, 0.0), folder)
    return Explanation(
        [*_fluid(spec, placed), *_bodies(spec), *_cloth(spec, placed), *_couplings(spec), *_rest(spec)],
        [*_absent(spec)],
        [*_droppable(spec, placed, duration)],
    )


def _fluid(spec: SimulationSpec, placed: PlacedScene) -> Iterator[Line]:
    fluid = spec.fluid
    if fluid is None:
        return
    count = _particles(placed, fluid)
    yield Line("fluid", f"{count:,} particles at distances of {_length(fluid.spacing)} by {fluid.solver.upper()}")
    for volume in placed.volumes.values():
        yield Line("fluid.bodies", volume.line())
    for text in placed.warnings():
        yield Line("fluid", f"warning: {text}")
    for name, term in _terms(fluid):
        if term:
            yield Line(f"fluid.{name}", term)
    if fluid.emitters or fluid.drains or any(event.add.emitters or event.add.drains for event in spec.events):
        yield Line("fluid", "emitters and drains: particles come and go")


def _particles(placed: PlacedScene, fluid: Fluid) -> int:
    from sim.fluid.model import FluidState

    names = list(fluid.bodies)
    return placed.pour(FluidState(), names, names, Counts(), 0.0).count if names else 0


def _terms(fluid: Fluid) -> Iterator[tuple[str, str]]:
    """Settings of optional terms, and what each does; nothing for those that are 0."""
    slip = "" if fluid.wall_slip == "free_slip" else ", and friction at solids"
    yield "viscosity", f"{fluid.viscosity:.3g} m²/s, {fluid.viscosity_solver}{slip}" if fluid.viscosity else ""
    tension = f"{fluid.surface_tension:.3g} N/m, {fluid.surface_tension_model}"
    yield "surface_tension", tension if fluid.surface_tension else ""
    yield "adhesion", f"{fluid.adhesion:.3g} N/m at solids" if fluid.adhesion else ""
    yield "xsph", f"{fluid.xsph:.3g} of the neighbours' velocity" if fluid.xsph else ""


def _bodies(spec: SimulationSpec) -> Iterator[Line]:
    kinds: Counter[str] = Counter()
    kinds.update(body.motion for body in (spec.rigid.bodies.values() if spec.rigid else ()))
    for event in spec.events:
        kinds.update(body.motion for body in event.add.rigid.values())
    words = {
        "dynamic": "obey forces: contacts with friction and restitution",
        "prescribed": "move as the scene says: no forces are found",
        "static": "stand: they are walls, and obey nothing",
    }
    for kind, text in words.items():
        if kinds[kind]:
            yield Line("rigid", f"{kinds[kind]} {text}")


def _cloth(spec: SimulationSpec, placed: PlacedScene) -> Iterator[Line]:
    if spec.cloth is None:
        return
    points = sum(len(item.fabric.points) for item in placed.sheets)
    integrator, shell = spec.cloth.integrator.replace("_", " "), spec.cloth.model == "fem"
    yield Line("cloth", f"{points:,} points by {integrator}, with contacts of its own")
    if shell:
        triangles = sum(len(item.fabric.triangles) for item in placed.sheets)
        yield Line("cloth.model", f"{triangles:,} finite elements resist stretching, warp and weft on their own")
    if spec.cloth.air is not None:
        yield Line("cloth.air", "drag and wind on every triangle")
    bends = any(sheet.bends if shell else sheet.bend_stiffness for sheet in spec.cloth.sheets.values())
    if bends:
        what = "curvatures around points" if shell else "hinges between triangles"
        yield Line("cloth.sheets", f"{what} resist bending")


def _couplings(spec: SimulationSpec) -> Iterator[Line]:
    present = spec.materials()
    if "fluid" in present and spec.has_dynamic_bodies():
        yield Line("coupling", "fluid and rigid bodies move each other")
    elif "fluid" in present and ("rigid" in present or spec.containers):
        yield Line("coupling", "solids hold off the fluid, which does not move them")
    if {"fluid", "cloth"} <= present:
        yield Line("coupling", "fluid and cloth move each other")
    if "cloth" in present and spec.has_dynamic_bodies():
        yield Line("coupling", "cloth and rigid bodies move each other")


def _rest(spec: SimulationSpec) -> Iterator[Line]:
    if spec.precision == "double":
        yield Line("precision", "double: slower, for studies")
    if spec.probes:
        yield Line("probes", f"{len(spec.probes)}, looked at beside the steps")
    if spec.events:
        yield Line("events", f"{len(spec.events)}, up to {spec.events[-1].at:g} s")


def _absent(spec: SimulationSpec) -> Iterator[Line]:
    present = spec.materials()
    for material, name in MATERIALS.items():
        if material not in present:
            yield Line(name, f"no `{material}:`, so its code is neither imported nor compiled")
    if spec.fluid is not None:
        for name, term in _terms(spec.fluid):
            if not term:
                yield Line(f"fluid.{name}", "0, so it is not compiled")
    if "rigid" in present and not spec.has_dynamic_bodies():
        yield Line("rigid contacts", "no body has `motion: dynamic`")
    if spec.cloth is not None and spec.cloth.air is None:
        yield Line("cloth.air", "left out: the cloth is in a vacuum")


def _droppable(spec: SimulationSpec, placed: PlacedScene, duration: float) -> Iterator[Line]:
    gravity = float(np.linalg.norm(spec.gravity))
    if spec.fluid is not None:
        yield from _idle_fluid_terms(spec, spec.fluid, gravity, placed.drop)
    if spec.cloth is not None and spec.cloth.air is not None and not any(spec.cloth.air.wind):
        yield from _idle_air(spec.cloth.air, placed, gravity, duration)
    if spec.fluid is not None and placed.sheets and not _meet(spec, spec.fluid, placed, gravity, duration):
        yield Line("cloth and fluid", f"cannot meet within {duration:g} s: two scenes would cost less")


def _idle_fluid_terms(spec: SimulationSpec, fluid: Fluid, gravity: float, drop: float) -> Iterator[Line]:
    numerical = NUMERICAL * fluid.spacing * math.sqrt(gravity * drop)
    if 0 < fluid.viscosity < NEGLIGIBLE * numerical:
        yield Line(
            "fluid.viscosity",
            f"{fluid.viscosity:.3g} m²/s is less than {NEGLIGIBLE:.0%} of what particles at this distance add by "
            f"themselves, about {numerical:.1g}: 0 would look the same",
        )
    tension = max(fluid.surface_tension, fluid.adhesion)
    if tension and gravity:
        capillary = math.sqrt(tension / (fluid.rest_density * gravity))
        if capillary < fluid.spacing:
            bond = (fluid.spacing / capillary) ** 2
            yield Line(
                "fluid.surface_tension" if fluid.surface_tension else "fluid.adhesion",
                f"bends nothing larger than {_length(capillary)}, and particles are {_length(fluid.spacing)} apart "
                f"(Bond number {bond:.3g}): 0 would look the same",
            )
    if fluid.adhesion and not (spec.containers or "rigid" in spec.materials()):
        yield Line("fluid.adhesion", "there is no solid to stick to")


def _idle_air(air: Air, placed: PlacedScene, gravity: float, duration: float) -> Iterator[Line]:
    """A sheet falls as far as there is room, or as long as the scene; one that is pinned, by its own size."""
    endless = not (placed.obstacles.placed or placed.obstacles.walls)
    up = -placed.gravity / max(gravity, 1e-30)
    for item in placed.sheets:
        height = float((item.fabric.points @ up).max()) - placed.floor
        free = gravity * duration**2 / 2 if endless else height
        fall = _diagonal(item) if item.sheet.pins else free
        speed2 = float(np.dot(item.sheet.velocity, item.sheet.velocity)) + 2 * gravity * fall
        weight = item.sheet.density * gravity
        if weight and air.density * air.drag * speed2 / 2 < NEGLIGIBLE * weight:
            yield Line("cloth.air", f"drags on {item.name} by less than {NEGLIGIBLE:.0%} of its weight")


def _meet(spec: SimulationSpec, fluid: Fluid, placed: PlacedScene, gravity: float, duration: float) -> bool:
    """Whether a sheet may come where fluid may come, both given all room that they could need."""
    if spec.events or fluid.emitters:
        return True
    wet = [_room(np.asarray(source.bounds), source.speed, gravity, duration) for source in placed.sources]
    for item in placed.sheets:
        box = _box(item)
        free = _room(box, float(np.linalg.norm(item.sheet.velocity)), gravity, duration)
        room = _grown(box, _diagonal(item)) if item.sheet.pins else free
        if any((room[0] <= other[1]).all() and (other[0] <= room[1]).all() for other in wet):
            return True
    return False


def _room(box: np.ndarray, speed: float, gravity: float, duration: float) -> np.ndarray:
    """The box [m] around all that something free may reach: nothing is faster than by its fall."""
    way = speed * duration + gravity * duration**2 / 2
    return _grown(box, way)


def _grown(box: np.ndarray, way: float) -> np.ndarray:
    return np.array([box[0] - way, box[1] + way])


def _box(item: PlacedSheet) -> np.ndarray:
    return np.array([item.fabric.points.min(axis=0), item.fabric.points.max(axis=0)])


def _diagonal(item: PlacedSheet) -> float:
    """How far one point of a sheet may be from another [m]."""
    low, high = _box(item)
    return float(np.linalg.norm(high - low)) * max(1.0, item.sheet.rest_scale)


def _length(metres: float) -> str:
    return f"{1000 * metres:.3g} mm" if metres < 1 else f"{metres:.3g} m"
