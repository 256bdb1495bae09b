"""The scene at run time: which materials there are, what they do to each other, and how they step together."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from scene.settings import given
from sim.run import materials
from sim.run.placing.placed_scene import PlacedScene
from sim.spec import SimulationSpec

if TYPE_CHECKING:
    from sim.bodies.movement import Movement
    from sim.cloth.contact.dynamic_solids import Bodies as BodiesInCloth
    from sim.cloth.fabric.state import ClothState
    from sim.cloth.model import ClothModel
    from sim.coupling.fluid_cloth.wet_cloth import WetCloth
    from sim.coupling.fluid_rigid.floating import Floating
    from sim.fluid.births import Births
    from sim.fluid.inflow.flow import Flow
    from sim.fluid.measure import Measure
    from sim.fluid.model import FluidModel, FluidState
    from sim.fluid.protocols import Bodies
    from sim.rigid.body import RigidState
    from sim.rigid.model import RigidModel
    from sim.run.reporting.counts import Counts

Limits = tuple[dict[str, float], Callable[[str], tuple[str, str]]]
"""Largest steps [s] by what limits them, and what tells in words where one comes from and what would help."""


class World(PlacedScene):
    """A placed scene that steps.

    Modules of a material that the scene does not have are not imported.
    """

    def __init__(
        self,
        spec: SimulationSpec,
        folder: Path,
        origin: np.ndarray | None = None,
        rigid_state: RigidState | None = None,
        cloth_state: ClothState | None = None,
    ):
        """Place everything; raises Refused. `origin` [m] and what bodies and cloth do are given when a run goes on."""
        super().__init__(spec, folder, origin, cloth_state)
        self.fluid: FluidModel | None = None
        self.flow: Flow | None = None
        self.rigid: RigidModel | None = None
        self.floating: Floating | None = None
        self.cloth: ClothModel | None = None
        self.wet_cloth: WetCloth | None = None
        self._rigid_state = rigid_state
        if rigid_state is not None:
            materials.put_back(self.obstacles, rigid_state)
        self.emission: dict[str, Any] = {}
        self.births: Births | None = None
        """Of the particles; None without fluid."""
        """What emitters had sent when this world was built."""
        self.time = self._until = 0.0
        """Of the present state [s]; told by who steps."""

    def build(
        self,
        state: FluidState | None,
        emission: dict[str, Any],
        counts: Counts,
        warn: Callable[[str], None],
        time: float,
        *,
        births: Births | None = None,
        going_on: bool,
    ) -> None:
        """Build what steps from `time` [s] on; `going_on` takes accelerations as they are in `state`.

        `emission` is what emitters remember; they count in `counts`, and add to the `births` of the particles.
        """
        self.emission = emission
        self.time = time
        if self.obstacles.dynamic:
            self.rigid = materials.build_rigid(self, self._rigid_state, time)
            self._follow(self.rigid)
        if self.sheets:
            self.cloth = materials.build_cloth(self, time)
        if self.rigid:
            self.rigid.awaits_cloth = bool(self.cloth)
        if state is None:
            self._leave_fluid()
            return
        self.births = given(births)
        self.fluid = fluid = materials.build_fluid(
            self, state, materials.sheet_samples(self, self.cloth) if self.cloth else None
        )
        self._aim(fluid, time)
        fluid.system.boundary.move()
        self._couple(fluid)
        if self.outlets or self.sinks:
            self.flow = fluid.system.flow = materials.build_flow(self, fluid, emission, counts, self.births, warn)
        fluid.solver.restore() if going_on else fluid.solver.start()

    # What materials do to each other

    def _couple(self, fluid: FluidModel) -> None:
        """Let fluid, dynamic bodies and cloth move each other."""
        moved: list[Bodies] = [self._float(fluid, self.rigid)] if self.rigid else []
        moved += [self._soak(fluid, self.cloth, alone=not moved)] if self.cloth else []
        if len(moved) > 1:
            from sim.coupling.together import Together

            fluid.system.bodies = Together(moved)
        elif moved:
            fluid.system.bodies = moved[0]

    def _float(self, fluid: FluidModel, rigid: RigidModel) -> Floating:
        from sim.coupling.fluid_rigid.floating import Floating

        moving = [index for index, item in enumerate(self.obstacles.placed) if item.motion]
        rows = {index: moving.index(index) for index in self.obstacles.dynamic}
        surfaces = [item.solid.surface for item in self.obstacles.dynamic.values()]
        self.floating = Floating(rigid, fluid.system, rows, list(self.obstacles.dynamic), self.origin, surfaces)
        return self.floating

    def _soak(self, fluid: FluidModel, cloth: ClothModel, *, alone: bool) -> WetCloth:
        from sim.coupling.fluid_cloth.wet_cloth import WetCloth

        self.wet_cloth = WetCloth(
            cloth,
            fluid.system,
            materials.sheet_samples(self, cloth),
            self.origin,
            lambda dt: self._solids_ahead(cloth, dt),
            lambda dt: self._apply_response(cloth, dt),
            alone=alone,
        )
        return self.wet_cloth

    def _follow(self, rigid: RigidModel) -> None:
        """Keep the motions of dynamic bodies up to date."""
        dynamic = self.obstacles.dynamic
        for item, now in zip(dynamic.values(), rigid.movements(list(dynamic)), strict=True):
            item.dynamic.now = now

    def _solids_ahead(self, cloth: ClothModel, dt: float) -> tuple[np.ndarray | None, BodiesInCloth | None]:
        """Where surfaces that cloth may meet are after the step, if any of them moves, and bodies that obey forces."""
        if self.rigid:
            self._follow(self.rigid)
        return self._solids_at(cloth, self._until, dt)

    def _solids_at(self, cloth: ClothModel, time: float, dt: float) -> tuple[np.ndarray | None, BodiesInCloth | None]:
        """Where surfaces that cloth may meet are at `time` [s], if any of them moves, and bodies that obey forces."""
        if not any(item.motion for item in self.obstacles.placed):
            return None, None
        from sim.coupling.cloth_solids import ahead, places

        return places(self.obstacles, time), ahead(cloth, self.rigid, dt) if self.rigid else None

    def _apply_response(self, cloth: ClothModel, dt: float) -> None:
        """Let wet cloth push dynamic bodies, before the fluid hears where they are."""
        if self.floating and self.rigid:
            self._push(cloth, self.rigid, dt, self._until)
            self.floating.pose()

    def _push(self, cloth: ClothModel, rigid: RigidModel, dt: float, until: float) -> None:
        """Let the cloth push dynamic bodies."""
        from sim.coupling.cloth_solids import places, push

        push(cloth, rigid, dt)
        self._follow(rigid)
        cloth.settle_solids(places(self.obstacles, until))

    def _leave_fluid(self) -> None:
        for part in (self.rigid, self.cloth):
            if part:
                part.leave_fluid()

    def release(self, after: SimulationSpec) -> None:
        """Let go of bodies that touch what `after`, from now on, has otherwise or no longer."""
        if self.rigid:
            before, later = (
                {**(spec.rigid.bodies if spec.rigid else {}), **spec.containers} for spec in (self.spec, after)
            )
            changed = {name for name, item in before.items() if later.get(name) != item}
            self.rigid.release([index for index, body in enumerate(self.rigid.bodies) if body.name in changed])

    # How long a step may be

    def step_limit(self, measure: Measure | None) -> float:
        """Largest stable time step [s]; infinite where nothing moves."""
        return min((min(limits.values(), default=math.inf) for limits, _ in self._limits(measure)), default=math.inf)

    def limiting_term(self, measure: Measure | None) -> tuple[str, str]:
        """What `step_limit` comes from, and what would help, in the words of the material that asks for it."""
        limits, describe = min(self._limits(measure), key=lambda found: min(found[0].values(), default=math.inf))
        return describe(min(limits, key=lambda term: limits[term]))

    def _limits(self, measure: Measure | None) -> Iterator[Limits]:
        """Of each material."""
        rigid, cloth, fluid = self.rigid, self.cloth, self.fluid
        if rigid:
            moving = rigid.measure()
            yield rigid.step_limits(moving), lambda term: rigid.limiting_term(term, moving)
        if cloth:
            yield cloth.step_limits(), cloth.limiting_term
        emitted = self.flow.fastest(self.time) if self.flow else 0.0
        if fluid is None or measure is None or not (fluid.count or emitted):
            return
        ahead = replace(measure, v_max=max(measure.v_max, emitted), pace=max(measure.pace, emitted))
        limits = fluid.solver.step_limits(ahead, self.spec.step.cfl)
        yield limits, lambda term: fluid.solver.limiting_term(term, measure, emitted)

    def next_keyframe(self, time: float) -> float:
        """The first time after `time` [s] at which the velocity of a body or pin jumps; infinite where none does."""
        return min(self.obstacles.next_keyframe(time), self.cloth.next_keyframe(time) if self.cloth else math.inf)

    # Steps

    def begin_frame(self) -> int:
        """What a run that goes on from the last frame would do first; how many particles were out of the scene."""
        if self.fluid is None:
            return 0
        fallen = self.fluid.remove_fallen()
        anew = self.fluid.system.begin_frame() or fallen > 0
        if self.wet_cloth:
            anew = self.wet_cloth.begin_frame() or anew
        self.fluid.solver.restore() if anew else self.fluid.system.find_solids()
        return fallen

    def advance(self, dt: float, until: float) -> dict[str, float]:
        """Step all materials by dt [s] to the time `until` [s]; returns what the solvers tell of the step."""
        rigid, cloth, fluid = self.rigid, self.cloth, self.fluid
        prescribed = self.obstacles.prescribed if rigid else {}
        if rigid:
            rigid.release([index for index, item in prescribed.items() if item.prescribed.jumps(self.time)])
        moved = {index: item.prescribed.at(until) for index, item in prescribed.items()}
        stats: dict[str, float] = {}
        fluid_leads = fluid is not None and fluid.count > 0
        if fluid and not fluid_leads:
            self._leave_fluid()
        if rigid and not fluid_leads:
            stats = rigid.advance(dt, moved)
            self._follow(rigid)
        if cloth and not fluid_leads:
            stats |= cloth.advance(dt, until, *self._solids_at(cloth, until, dt))
            if rigid:
                self._push(cloth, rigid, dt, until)
        if fluid:
            stats |= self._advance_fluid(fluid, dt, until, moved)
        if rigid and fluid_leads:
            self._follow(rigid)
        self.time = until
        return stats

    def _advance_fluid(
        self, fluid: FluidModel, dt: float, until: float, moved: dict[int, Movement]
    ) -> dict[str, float]:
        self._aim(fluid, until)
        self._until = until
        if self.floating:
            self.floating.begin(moved)
        if self.wet_cloth:
            self.wet_cloth.begin(until)
        if self.flow:
            self.flow.time = self.time
        boundary, stats = fluid.system.boundary, {}
        if fluid.count:
            stats = fluid.solver.advance(dt)
            if self.wet_cloth:
                stats["cloth_held_off"] = self.wet_cloth.tightness.held_off
        else:
            boundary.move()
            if self.flow and self.flow.exchange(dt):
                fluid.solver.start()
        stats["held_off"], boundary.held_off = boundary.held_off, 0
        return stats

    def _aim(self, fluid: FluidModel, time: float) -> None:
        """Say where the bodies that move are at `time` [s], which alone decides it."""
        boundary = fluid.system.boundary
        if boundary.shapes.moving:
            from sim.coupling.fluid_solids import motions

            boundary.aim(motions(self.obstacles, self.origin, time))

    # What is told of it

    def measure(self) -> Measure | None:
        """Extremes, sums and error counts of the fluid; None without one."""
        return self.fluid.measure(self.spec.step.cfl) if self.fluid else None

    def choices(self) -> dict[str, str]:
        """What settings of `auto` came to."""
        if self.fluid is None or not self.fluid.system.spec.viscosity:
            return {}
        return {"fluid.viscosity_solver": "implicit" if self.fluid.system.implicit_viscosity else "explicit"}

    def bytes_by_module(self) -> dict[str, int]:
        """Memory of each material that the scene has [bytes]."""
        found = {"fluid": self.fluid.system.bytes} if self.fluid else {}
        found |= {"rigid": self.rigid.bytes} if self.rigid else {}
        return found | ({"cloth": self.cloth.bytes} if self.cloth else {})
