"""A model of a film, from pilots of it on the machine at hand.

Jobs run side by side, as those of the film do: cores that share a memory slow each other.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

from scene.load import Scene
from workflow.budget.detail import Presets
from workflow.budget.model import Flight, Model, Pictures, Surfaces
from workflow.budget.pilot import Drawn, Pilot
from workflow.budget.schedule import SIDE_BY_SIDE
from workflow.budget.spacings import spacing
from workflow.plan.memory import particles

COARSE, FINE = 1500, 5000
"""Particles of the pilots: as few as show what happens, and what a second can follow."""
COARSEST = -6.0
SMALL = (4, 2)
"""Parts of the width and height that pictures of pilots have."""
SHOWN = (0.0, 0.5, 1.0)
"""When surfaces and pictures are looked at, over the duration."""


class Calibration:
    """Pilots of a scene on so many cores; `tell` is told what goes on."""

    def __init__(self, presets: Presets, cores: int, folder: Path, tell: Callable[[str], None]):
        self._presets = presets
        self._threads = max(1, cores // SIDE_BY_SIDE)
        self._pool = ThreadPoolExecutor(min(SIDE_BY_SIDE, cores))
        self._folder = folder
        self._tell = tell

    def model(self) -> Model:
        """Raises PilotFailed, SceneError."""
        scenes = [self._presets.at(detail) for detail in self._details()]
        pilots = [Pilot(scene, self._made(f"pilot_{k}"), self._threads) for k, scene in enumerate(scenes)]
        self._tell(f"pilots with {' and '.join(_told(scene) for scene in scenes)}")
        coarse, fine = map(Flight, scenes, self._pool.map(Pilot.simulate, pilots))
        surfaces = self._surfaces(*pilots) if scenes[1].simulation.fluid is not None else None
        self._tell("pictures of the pilot")
        return Model(coarse, fine, surfaces, self._pictures(pilots[1]))

    def probe(self, model: Model, scene: Scene) -> None:
        """Correct a model by what the first frame takes at a detail."""
        self._tell(f"first frame with {_told(scene)}")
        pilots = [Pilot(scene, self._made("probe"), self._threads) for _ in range(SIDE_BY_SIDE)]
        model.correct(scene, list(self._pool.map(lambda pilot: pilot.simulate(last=1), pilots)))

    def _made(self, name: str) -> Path:
        return Path(tempfile.mkdtemp(dir=self._folder, prefix=f"{name}-"))

    def _details(self) -> tuple[float, float]:
        """Of the coarse and the fine pilot."""
        draft = self._presets.at(0.0)
        if spacing(self._presets.at(-1.0)) == spacing(draft):
            return 0.0, 0.0
        if draft.simulation.fluid is None:
            return -1.0, 0.0
        return self._with(COARSE), self._with(FINE)

    def _with(self, count: int) -> float:
        """The detail, at most draft, with about so many particles."""
        low, high = COARSEST, 0.0
        if particles(self._presets.at(high)) <= count:
            return high if count == FINE else -1.0
        for _ in range(8):
            middle = (low + high) / 2
            low, high = (middle, high) if particles(self._presets.at(middle)) <= count else (low, middle)
        return low

    def _surfaces(self, coarse: Pilot, fine: Pilot) -> Surfaces:
        self._tell("surfaces of the pilots")
        standard, final = self._presets.at(1.0), self._presets.at(2.0)
        cubes = standard.surface.cube_size, final.surface.cube_size
        if cubes[0] == cubes[1]:
            final = replace(final, surface=final.surface.model_copy(update={"cube_size": 0.7 * cubes[0]}))
        wanted = (coarse, standard), (fine, standard), (fine, final)
        drawn = list(self._pool.map(lambda job: job[0].surface(*job[1:]), [
            (pilot, frame, settings) for pilot, settings in wanted for frame in _shown(pilot.scene)
        ]))  # fmt: skip
        count = len(SHOWN)
        of_coarse, of_fine, of_cubes = (tuple(drawn[k : k + count]) for k in range(0, len(drawn), count))
        return Surfaces(of_coarse, of_fine, of_cubes, (cubes[0], final.surface.cube_size))

    def _pictures(self, pilot: Pilot) -> Pictures:
        standard = self._presets.at(1.0)
        width, height = standard.render.resolution
        small, larger = ([max(16, width // part // 2 * 2), max(16, height // part // 2 * 2)] for part in SMALL)
        samples = standard.render.samples
        frames = _shown(pilot.scene)

        def draw(frame: int, resolution: list[int], samples: int) -> Drawn:
            return pilot.picture(frame, standard, {"resolution": resolution, "samples": samples})

        jobs = [*((frame, small, samples) for frame in frames), (frames[1], small, 1), (frames[1], larger, 1)]
        *full, one, more = self._pool.map(lambda job: draw(*job), jobs)
        return Pictures(tuple(full), one, more, (small[0] * small[1], larger[0] * larger[1]), samples)


def _shown(scene: Scene) -> list[int]:
    """The first of two frames each."""
    return [round(part * (scene.last_frame - 1)) for part in SHOWN]


def _told(scene: Scene) -> str:
    count = particles(scene)
    if count:
        return f"{count:,} particles"
    return f"a spacing of {1000 * spacing(scene):.3g} mm" if scene.simulation.cloth is not None else "all bodies"
