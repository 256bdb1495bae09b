"""What a run leaves behind: frames, tables and the summary."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from common.ply import FLUID_POINT, write_mesh, write_points
from common.simulation_files import SOURCES
from scene.settings import given
from sim.cloth.spec import Cloth
from sim.run.probes.sampling import COLUMNS as PROBE_COLUMNS
from sim.run.table import Table, write_table
from sim.spec import SimulationSpec

if TYPE_CHECKING:
    from sim.bodies.obstacles import Obstacle
    from sim.fluid.births import Births
    from sim.fluid.measure import Measure
    from sim.run.world import World

BODY_COLUMNS = ("frame", "time", "body", "x", "y", "z", "qw", "qx", "qy", "qz", "vx", "vy", "vz", "wx", "wy", "wz")
STEP_COLUMNS = ("step", "time", "dt", "wall_s")
FLUID_COLUMNS = (
    "n_fluid",
    "density_error_avg",
    "density_error_max",
    "v_max",
    "kinetic_energy",
    "potential_energy",
)
RIGID_COLUMNS = ("rigid_kinetic_energy", "rigid_potential_energy")
SOURCE_COLUMNS = ("id", "time", "source")
CLOTH_COLUMNS = ("cloth_kinetic_energy", "cloth_potential_energy", "cloth_elastic_energy", "cloth_stretch")


class Output:
    """The files of a run in one folder; rows and frames of a step that is repeated are dropped.

    `until`: the tables go on after what an earlier run left in the folder up to this time [s].
    """

    def __init__(self, folder: Path, spec: SimulationSpec, until: float | None = None):
        folder.mkdir(parents=True, exist_ok=True)
        self.folder = folder
        self.has_fluid = spec.fluid is not None
        self.bodies = Table(folder / "bodies.csv", BODY_COLUMNS, until)
        self.steps = Table(
            folder / "steps.csv",
            STEP_COLUMNS + self._fluid_columns(spec) + self._rigid_columns(spec) + self._cloth_columns(spec),
            until,
        )
        self.probes = Table(folder / "probes.csv", PROBE_COLUMNS, until) if spec.probes else None
        self._meshes: set[str] = set()
        self._told = -1
        """Births in sources.csv, of this run."""

    def _fluid_columns(self, spec: SimulationSpec) -> tuple[str, ...]:
        if spec.fluid is None:
            self._statistics: tuple[str, ...] = ()
            return ()
        from sim.fluid import load_solver
        from sim.fluid.forces.velocity_smoothing import viscosity_is_implicit
        from sim.fluid.model import SLOWEST

        self._statistics = load_solver(spec.fluid.method).STATISTICS
        if viscosity_is_implicit(spec.fluid, np.array(spec.gravity), SLOWEST * spec.fluid.spacing):
            self._statistics += ("viscosity_iterations",)
        return FLUID_COLUMNS + self._statistics

    def _rigid_columns(self, spec: SimulationSpec) -> tuple[str, ...]:
        self._contact_statistics: tuple[str, ...] = ()
        if not spec.has_dynamic_bodies():
            return ()
        from sim.rigid.model import STATISTICS

        self._contact_statistics = STATISTICS
        return RIGID_COLUMNS + STATISTICS

    def _cloth_columns(self, spec: SimulationSpec) -> tuple[str, ...]:
        self._cloth_statistics: tuple[str, ...] = ()
        if "cloth" not in spec.materials():
            return ()
        from sim.cloth import load_integrator

        self._cloth_statistics = load_integrator(
            spec.cloth.integrator if spec.cloth else Cloth.model_fields["integrator"].default
        ).STATISTICS
        if "fluid" in spec.materials():
            self._cloth_statistics += ("cloth_held_off",)
        return CLOTH_COLUMNS + self._cloth_statistics

    def step(
        self,
        step: int,
        time: float,
        dt: float,
        wall: float,
        world: World,
        measure: Measure | None,
        stats: dict[str, float],
    ) -> None:
        """One row of steps.csv: energies in J, density errors as shares of the rest density; `stats` by the solver."""
        row = [step, time, dt, wall]
        if measure is not None:
            fluid = given(world.fluid)
            count = fluid.count
            row += [
                count,
                measure.compression_sum / count if count else 0.0,
                max(measure.density_max / fluid.system.spec.rest_density - 1.0, 0.0) if count else 0.0,
                measure.v_max,
                measure.kinetic_energy,
                fluid.potential_energy(measure) if count else 0.0,
            ]
            row += [stats.get(name, 0) for name in self._statistics]
        if self._contact_statistics:
            rigid = world.rigid.measure() if world.rigid else None
            row += [rigid.kinetic_energy, rigid.potential_energy] if rigid else [0.0, 0.0]
            row += [stats.get(name, 0) for name in self._contact_statistics]
        if self._cloth_statistics:
            cloth = world.cloth.measure() if world.cloth else None
            row += [cloth.kinetic_energy, cloth.potential_energy, cloth.elastic_energy] if cloth else [0.0] * 3
            row += [cloth.stretch_max if cloth else 0.0]
            row += [stats.get(name, 0) for name in self._cloth_statistics]
        self.steps.add(*row)

    def frame(self, frame: int, time: float, world: World) -> None:
        """Particles, bodies and cloth of one frame; the tables' rows up to it become final.

        Where that fails or is interrupted, nothing of the frame stays.
        """
        names = ["fluid", *(f"cloth_{item.name}" for item in world.sheets)]
        files = {name: self.folder / f"{name}_{frame:05d}.ply" for name in names}
        for table in self._tables():
            table.mark()
        try:
            self._frame(files, frame, time, world)
        except BaseException:
            for table in self._tables():
                table.undo()
            for file in files.values():
                file.unlink(missing_ok=True)
            raise

    def _frame(self, files: dict[str, Path], frame: int, time: float, world: World) -> None:
        if world.fluid is not None:
            self._sources(given(world.births))
            write_points(files["fluid"], fluid_points(world))
        for sheet in world.sheets:
            vertices, velocities = given(world.cloth).vertices(sheet.name)
            more = {f"rest_{axis}": sheet.rest[:, k] for k, axis in enumerate("xyz")}
            more["thickness"] = np.full(len(vertices), sheet.sheet.thickness)
            write_mesh(files[f"cloth_{sheet.name}"], vertices, sheet.fabric.triangles, velocities=velocities, more=more)
        placed = world.obstacles.placed
        for item in placed:
            self._mesh(item.name, "container" if item.hollow else "body", item)
        bodies = [item for item in placed if not item.hollow]
        for item, state in zip(bodies, _body_states(bodies, time), strict=True):
            self.bodies.add(frame, time, item.name, *state)
        for name, (vertices, faces) in world.obstacles.box_surfaces().items():
            if name not in self._meshes:
                self._meshes.add(name)
                write_mesh(self.folder / f"container_{name}.ply", vertices, faces)
        for table in self._tables():
            table.flush()

    def drop_rows(self) -> None:
        """Forget the rows of all tables since their last flush: their steps are to be repeated."""
        for table in self._tables():
            table.drop()

    def close(self) -> None:
        """Close the files of all tables."""
        for table in self._tables():
            table.close()

    def _tables(self) -> list[Table]:
        return [self.bodies, self.steps] + ([self.probes] if self.probes else [])

    def _sources(self, births: Births) -> None:
        """Write all births anew, also those of the run that this one goes on from: each part of a film has its own."""
        count = len(births.first)
        if count != self._told:
            rows = zip(births.first.tolist(), births.time.tolist(), births.source.tolist(), strict=True)
            named = ((first, time, births.names[source]) for first, time, source in rows)
            write_table(self.folder / SOURCES, SOURCE_COLUMNS, named)
            self._told = count

    def _mesh(self, name: str, kind: str, item: Obstacle) -> None:
        if name not in self._meshes:
            self._meshes.add(name)
            surface = given(item.solid.triangles)
            centre = np.zeros(3) if item.hollow else item.centre
            write_mesh(
                self.folder / f"{kind}_{name}.ply",
                surface.vertices - centre,
                surface.faces,
                surface.colors,
                uv=surface.uv,
                material=surface.material,
                comments=_own_axes(item.solid.pose.rotation),
            )


def _own_axes(rotation: np.ndarray) -> list[str]:
    """What a mesh file says of how it was turned when it was placed: nothing, or the rotation matrix row by row."""
    same = bool((rotation == np.eye(3)).all())
    return [] if same else ["turned " + " ".join(f"{number:.9g}" for number in rotation.ravel())]


def _body_states(items: Sequence[Obstacle], time: float) -> Iterator[list[float]]:
    """Of each its centre of mass [m], rotation since it was placed (w, x, y, z), and the velocities [m/s] and [rad/s]
    of both."""
    movements = [item.movement(time) for item in items]
    moving = [movement for movement in movements if movement is not None]
    turned: Iterator[np.ndarray] = iter(())
    if moving:
        from sim.bodies.movement import quaternions

        turned = iter(quaternions(moving))
    for item, movement in zip(items, movements, strict=True):
        if movement is None:
            yield [*item.centre, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0]
        else:
            centre = item.centre_at(time)
            yield [*centre, *next(turned), *movement.velocity_at(centre), *movement.angular_velocity]


def fluid_points(world: World) -> np.ndarray:
    """The particles as FLUID_POINT records in the order of their identities, world coordinates."""
    state = given(world.fluid).state()
    points = np.empty(state.count, dtype=FLUID_POINT)
    position = state.position[:, :3].astype(np.float64) + world.origin
    for axis, name in enumerate("xyz"):
        points[name] = position[:, axis]
        points[f"v{name}"] = state.velocity[:, axis]
    points["density"] = state.velocity[:, 3]
    points["id"] = state.tag[:, 0]
    return points[np.argsort(points["id"], kind="stable")]
