"""The materials of a placed scene, built so that they can step; each only where the scene has it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from scene.settings import given
from sim.run.placing.placed_scene import PlacedScene

if TYPE_CHECKING:
    from sim.bodies.obstacles import Obstacles
    from sim.cloth.model import ClothModel
    from sim.coupling.fluid_cloth.sheet_samples import SheetSamples
    from sim.fluid.births import Births
    from sim.fluid.inflow.flow import Flow
    from sim.fluid.model import FluidModel, FluidState
    from sim.rigid.body import RigidState
    from sim.rigid.model import RigidModel
    from sim.run.reporting.counts import Counts


def build_rigid(placed: PlacedScene, state: RigidState | None, time: float) -> RigidModel:
    """Bodies that obey forces, and what they meet, at `time` [s]; `state` is what they did where a run goes on."""
    from sim.rigid.assemble import assemble
    from sim.rigid.body import RigidState
    from sim.rigid.model import RigidModel

    bodies = assemble(placed.spec, placed.obstacles)
    bottom = placed.floor - placed.depth
    rigid = RigidModel(bodies, placed.gravity, given(placed.spec.rigid), state or RigidState(), bottom=bottom)
    rigid.land({index: item.prescribed.at(time) for index, item in placed.obstacles.prescribed.items()})
    return rigid


def put_back(obstacles: Obstacles, state: RigidState) -> None:
    """Stand bodies that obey forces where they were."""
    row = {name: index for index, name in enumerate(state.names)}
    for item in obstacles.dynamic.values():
        if item.name in row:
            item.dynamic.resume(state.position[row[item.name]], state.rotation[row[item.name]])


def build_cloth(placed: PlacedScene, time: float) -> ClothModel:
    """All sheets, apart from what they are placed through, at `time` [s]."""
    from sim.cloth.fabric.state import ClothState
    from sim.cloth.model import ClothModel

    placed.untangle(time)
    state = placed.cloth_state or ClothState()
    return ClothModel(placed.sheets, placed.gravity, given(placed.spec.cloth), state, time, placed.solids(time))


def sheet_samples(placed: PlacedScene, cloth: ClothModel) -> Callable[[float], SheetSamples]:
    """Makes samples of sheets, as fluid meets them, that are listed within a radius [m]."""
    from sim.coupling.fluid_cloth.wet_cloth import sheet_samples

    return sheet_samples(cloth, given(placed.spec.fluid), placed.origin)


def build_fluid(placed: PlacedScene, state: FluidState, sheets: Callable[[float], SheetSamples] | None) -> FluidModel:
    """The particles of `state` with their solver; `sheets` makes what they meet of cloth."""
    from sim.coupling.fluid_solids import boundary_solids
    from sim.fluid.model import FluidModel, Surroundings

    fluid = given(placed.spec.fluid)
    return FluidModel(
        fluid,
        placed.gravity,
        placed.origin,
        state,
        Surroundings(boundary_solids(placed.obstacles, fluid.spacing, fluid.support_radius), sheets),
        drop=placed.drop,
        fastest=placed.fastest,
        floor=placed.floor,
        depth=placed.depth,
        probed=any(probe.PRESSURES for probe in placed.spec.probes.values()),
    )


def build_flow(
    placed: PlacedScene,
    fluid: FluidModel,
    emission: dict[str, Any],
    counts: Counts,
    births: Births,
    warn: Callable[[str], None],
) -> Flow:
    """Emitters and drains; `emission` is what emitters remember, they count in `counts` and add to `births`."""
    from sim.coupling.fluid_solids import allowed
    from sim.fluid.inflow.flow import Flow, Ledger
    from sim.fluid.seeding.seed import START_CLEARANCE

    clearance = START_CLEARANCE * fluid.system.spec.spacing
    moving = replace(placed.obstacles, walls=[], placed=[item for item in placed.obstacles.placed if item.motion])
    return Flow(
        fluid.system,
        placed.origin,
        placed.outlets,
        placed.sinks,
        Ledger(emission),
        counts,
        births,
        lambda points, time: allowed(moving, points, clearance, time),
        warn,
    )
