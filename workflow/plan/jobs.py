"""What each job of a film depends on: pure functions of a scene and of the source files.

A job is repeated when one of these values differs from what its result was made with. The
values differ in kind (a file of settings, `code ...`, `versions ...`), because Snakemake compares the
values of a job's params as a set.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from common.frames import Frames
from render import program
from scene import assets
from scene.load import Scene
from scene.settings import canonical_json
from sim.bodies.wall import Wall
from sim.device import compiler_choice
from sim.foam.spec import FoamJobSpec
from sim.spec import SimulationSpec
from workflow.plan import additions, sources
from workflow.plan.timeline import Timeline
from workflow.stages.film.spec import FilmJobSpec
from workflow.stages.surface.spec import ReconstructSpec
from workflow.stages.wet.spec import WetJobSpec

RESULTS = "results"
FILMS = "renders"

ENTRY = {
    "simulate": "sim.segment",
    "reconstruct": "workflow.reconstruct",
    "foam": "workflow.foam",
    "wet": "workflow.wet",
    "render": "render",
    "film": "workflow.film",
}
"""The module that each stage runs with `python -m`."""


CLEAR = ("glass", "water")
"""Looks of containers on which nobody sees that they are wet."""


@dataclass(frozen=True)
class Job:
    """One job: where its result goes, and all that the result depends on besides its inputs."""

    stage: str
    folder: str
    """Of the result, relative to the working directory."""
    frames: Frames
    spec: str
    """Settings of the stage, in canonical JSON."""
    code: str
    """Digest of the source files that the stage runs."""
    versions: str
    """Of the packages that do the stage's work."""
    assets: str
    """Digests of the files that the scene names."""
    upstream: tuple[str, ...] = ()
    """Plans of the jobs whose results are read."""

    @cached_property
    def plan(self) -> str:
        """Digest of everything above, and so of all earlier stages too."""
        parts = (self.stage, str(self.frames), self.spec, self.code, self.versions, self.assets, *self.upstream)
        return "plan " + hashlib.sha256("\n".join(parts).encode()).hexdigest()[:32]


Digests = dict[tuple[str, frozenset[str]], str]
"""Of the source files of a stage, by its module and the materials of a scene."""


class Plan:
    """The jobs of one film. `root` is the folder of the packages sim, render and workflow; plans that are made at one
    time may share their digests."""

    def __init__(self, scene: Scene, root: Path, digests: Digests | None = None):
        self.scene = scene
        self.root = root
        self.timeline = Timeline(scene.simulation.fps, scene.last_frame)
        self.results = f"{RESULTS}/{scene.name}/{scene.quality}"
        self._jobs: dict[tuple[str, int], Job] = {}
        self._digests: Digests = {} if digests is None else digests

    @property
    def has_surface(self) -> bool:
        """Whether there is fluid, whose surface is reconstructed."""
        return self.scene.simulation.fluid is not None

    @property
    def has_foam(self) -> bool:
        """Whether the scene asks for foam."""
        return self.scene.foam is not None

    @property
    def has_wetness(self) -> bool:
        """Whether the scene asks for what is wet."""
        return self.scene.render.wetness is not None

    def job(self, stage: str, index: int = 0) -> Job:
        """The job of a stage for a segment or block; raises IndexError where the film has no such part."""
        key = (stage, index)
        if key not in self._jobs:
            self._jobs[key] = getattr(self, f"_{stage}")(index)
        return self._jobs[key]

    def parts(self, stage: str) -> int:
        """How many jobs a stage has."""
        if stage == "reconstruct" and not self.has_surface:
            return 0
        if stage == "foam" and not self.has_foam:
            return 0
        if stage == "wet" and not self.has_wetness:
            return 0
        segments = dict.fromkeys(("simulate", "reconstruct", "foam", "wet"), self.timeline.segments)
        return {**segments, "render": self.timeline.blocks, "film": 1}[stage]

    def jobs(self, stage: str) -> list[Job]:
        """All jobs of a stage, in the order of their parts."""
        return [self.job(stage, index) for index in range(self.parts(stage))]

    def whole_simulation(self) -> Job:
        """All frames as one job, which is none of the film's."""
        return self._simulation(f"{self.results}/whole", Frames(0, self.scene.last_frame))

    def _simulate(self, index: int) -> Job:
        frames = self.timeline.segment(index)
        upstream = (self.job("simulate", index - 1).plan,) if index else ()
        return self._simulation(f"{self.results}/simulation/{index:03d}", frames, upstream)

    def _simulation(self, folder: str, frames: Frames, upstream: tuple[str, ...] = ()) -> Job:
        spec = self.scene.simulation.before(self.timeline.time(frames.last))
        compiler = compiler_choice.chosen().package
        return Job(
            stage="simulate",
            folder=folder,
            frames=frames,
            spec=spec.canonical(),
            code=self._code("simulate", spec.materials()),
            versions=versions(
                compiler, "numpy", *(("libigl", "manifold3d", "pymeshfix", "trimesh") if _files(spec) else ())
            ),
            assets=_assets(self.scene.assets, _files(spec)),
            upstream=upstream,
        )

    def _reconstruct(self, index: int) -> Job:
        fluid = self.scene.simulation.fluid
        if fluid is None:
            raise IndexError(f"{self.scene.name} has no fluid, so no surface to reconstruct")
        spec = ReconstructSpec(
            particle_radius=fluid.particle_radius,
            rest_density=fluid.rest_density,
            walls=self._walls if self.scene.surface.walls else (),
            vessels=self._vessels if self.scene.surface.walls else (),
            fps=self.scene.simulation.fps if "age" in self.scene.surface.attributes else None,
            sources=self.scene.simulation.fluid_sources() if "source" in self.scene.surface.attributes else None,
            surface=self.scene.surface,
        )
        return Job(
            stage="reconstruct",
            folder=f"{self.results}/surface/{index:03d}",
            frames=self.timeline.segment(index),
            spec=spec.canonical(),
            code=self._code("reconstruct"),
            versions=versions("libigl", "numpy", "pysplashsurf", "scipy"),
            assets=_assets({}, set()),
            upstream=(self.job("simulate", index).plan,),
        )

    def _foam(self, index: int) -> Job:
        fluid, simulation = self.scene.simulation.fluid, self.scene.simulation
        if self.scene.foam is None or fluid is None:
            raise IndexError(f"{self.scene.name} has no `foam:`, so none is made")
        spec = FoamJobSpec(
            foam=self.scene.foam,
            particle_radius=fluid.particle_radius,
            support_radius=fluid.support_radius,
            gravity=simulation.gravity,
            fps=simulation.fps,
            walls=self._walls,
        )
        return Job(
            stage="foam",
            folder=f"{self.results}/foam/{index:03d}",
            frames=self.timeline.segment(index),
            spec=spec.canonical(),
            code=self._code("foam", frozenset({"fluid"})),
            versions=versions(compiler_choice.chosen().package, "numpy", "scipy", "trimesh"),
            assets=_assets({}, set()),
            upstream=(self.job("simulate", index).plan, *((self.job("foam", index - 1).plan,) if index else ())),
        )

    def _wet(self, index: int) -> Job:
        fluid, wetness = self.scene.simulation.fluid, self.scene.render.wetness
        if wetness is None or fluid is None:
            raise IndexError(f"{self.scene.name} has no `render.wetness`, so that nothing gets wet")
        looks = self.scene.render.materials
        spec = WetJobSpec(
            drying_time=wetness.drying_time,
            particle_radius=fluid.particle_radius,
            fps=self.scene.simulation.fps,
            walls=self._walls,
            vessels=tuple(name for name in self._containers if name in looks and looks[name].type not in CLEAR),
        )
        return Job(
            stage="wet",
            folder=f"{self.results}/wet/{index:03d}",
            frames=self.timeline.segment(index),
            spec=spec.canonical(),
            code=self._code("wet"),
            versions=versions("libigl", "numpy", "scipy", "trimesh"),
            assets=_assets({}, set()),
            upstream=(self.job("simulate", index).plan, *((self.job("wet", index - 1).plan,) if index else ())),
        )

    def _render(self, index: int) -> Job:
        frames = self.timeline.block(index)
        segment = self.timeline.segment_of_block(index)
        return Job(
            stage="render",
            folder=f"{self.results}/frames/{index:03d}",
            frames=frames,
            spec=render_spec(self.scene),
            code=self._code("render"),
            versions=_blender(program.chosen()),
            assets=_assets(self.scene.assets, set(self.scene.assets) - _files(self.scene.simulation)),
            upstream=tuple(self.job(stage, segment).plan for stage in self._shown()),
        )

    def _shown(self) -> tuple[str, ...]:
        """Stages whose results pictures show; the surface stands for the simulation that it was made from."""
        found = ["reconstruct" if self.has_surface else "simulate"]
        found += ["foam"] * self.has_foam + ["wet"] * self.has_wetness
        return tuple(found)

    def _film(self, _index: int) -> Job:
        scene = self.scene
        spec = FilmJobSpec(
            name=scene.name,
            quality=scene.quality,
            fps=scene.simulation.fps,
            last_frame=scene.last_frame,
            transparent=scene.render.background.type == "transparent",
            film=scene.film,
        )
        return Job(
            stage="film",
            folder=f"{FILMS}/{scene.name}",
            frames=Frames(0, scene.last_frame),
            spec=spec.canonical(),
            code=self._code("film"),
            versions=versions("imageio-ffmpeg"),
            assets=_assets({}, set()),
            upstream=tuple(job.plan for job in self.jobs("render")),
        )

    @cached_property
    def _walls(self) -> tuple[Wall, ...]:
        from workflow.stages.surface.standing import standing_walls

        return standing_walls(self.scene.simulation)

    @cached_property
    def _vessels(self) -> tuple[str, ...]:
        from workflow.stages.surface.standing import standing_vessels

        return standing_vessels(self.scene.simulation)

    @cached_property
    def _containers(self) -> tuple[str, ...]:
        from workflow.stages.surface.standing import standing_containers

        return standing_containers(self.scene.simulation)

    def _code(self, stage: str, materials: frozenset[str] = sources.MATERIALS) -> str:
        key = (ENTRY[stage], materials)
        if key not in self._digests:
            beside = additions.digest(stage, materials)
            own = sources.digest(ENTRY[stage], self.root, materials)
            self._digests[key] = f"{own[:32]} and {beside[:32]}" if beside else own[:32]
        return f"code {self._digests[key]}"


def render_spec(scene: Scene) -> str:
    """The render settings, with the paths of pictures relative to the working directory."""
    data = scene.render.model_dump(mode="json", exclude_none=True)
    for place, file in scene.render.assets():
        *way, last = place
        settings: Any = data
        for key in way:
            settings = settings[key]
        settings[last] = os.path.relpath(assets.resolve(file, scene.folder))
    return canonical_json(data)


def _files(spec: SimulationSpec) -> set[str]:
    """Files that the simulation reads, as the scene names them."""
    shapes = (getattr(body, "shape", None) for _, body in spec.placements())
    return {shape.file for shape in shapes if shape is not None and hasattr(shape, "file")}


def _assets(digests: Mapping[str, str], wanted: set[str]) -> str:
    return f"assets {canonical_json({name: digests[name] for name in sorted(wanted)})}"


@cache
def versions(*packages: str) -> str:
    """Those that are installed, as a value of a rule's params."""
    return f"versions {', '.join(f'{package} {_version(package)}' for package in packages)}"


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "absent"


def _blender(path: str | None) -> str:
    """The version of bpy, or what tells one installed Blender from another without starting it."""
    if path is None:
        return versions("bpy")
    try:
        state = program.found(path).stat()
        return f"versions blender {path}, {state.st_size} bytes, changed {state.st_mtime_ns}"
    except OSError:
        return f"versions blender {path}, absent"
