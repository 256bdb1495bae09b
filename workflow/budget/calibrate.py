"""A model of a film, from pilots of it on the machine at hand."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from workflow.budget.detail import load_at
from workflow.budget.model import Flight, Model, Pictures, Surfaces, spacing
from workflow.budget.pilot import Drawn, Pilot
from workflow.memory import particles
from workflow.scene import Scene

COARSE, FINE = 1500, 5000
"""Particles of the pilots: as few as show what happens, and what a second can follow."""
COARSEST = -6.0
SMALL = (4, 2)
"""Parts of the width and height that pictures of pilots have."""
SHOWN = (0.0, 0.5, 1.0)
"""When surfaces and pictures are looked at, over the duration."""


class Calibration:
    """Pilots of the scene at `path`, each thread count that of a job; `tell` is told what goes on."""

    def __init__(self, path: Path, threads: int, folder: Path, tell: Callable[[str], None]):
        self._path = path
        self._threads = threads
        self._folder = folder
        self._tell = tell

    def model(self) -> Model:
        """Raises PilotFailed, SceneError."""
        scenes = [load_at(self._path, detail) for detail in self._details()]
        pilots = [Pilot(scene, self._made(f"pilot_{k}"), self._threads) for k, scene in enumerate(scenes)]
        flights = []
        for pilot in pilots:
            self._tell(f"pilot with {_told(pilot.scene)}")
            flights.append(Flight(pilot.scene, pilot.simulate()))
        surfaces = self._surfaces(*pilots) if scenes[1].simulation.fluid is not None else None
        self._tell("pictures of the pilot")
        return Model(*flights, surfaces, self._pictures(pilots[1]))

    def probe(self, model: Model, scene: Scene) -> None:
        """Correct a model by what the first frame takes at a detail."""
        self._tell(f"first frame with {_told(scene)}")
        folder = self._made("probe")
        model.correct(scene, Pilot(scene, folder, self._threads).simulate(last=1))

    def _made(self, name: str) -> Path:
        return Path(tempfile.mkdtemp(dir=self._folder, prefix=f"{name}-"))

    def _details(self) -> tuple[float, float]:
        """Of the coarse and the fine pilot."""
        draft = load_at(self._path, 0.0)
        if spacing(load_at(self._path, 1.0)) == spacing(draft):
            return 0.0, 0.0
        if draft.simulation.fluid is None:
            return -1.0, 0.0
        return self._with(COARSE), self._with(FINE)

    def _with(self, count: int) -> float:
        """The detail, at most draft, with about so many particles."""
        low, high = COARSEST, 0.0
        if particles(load_at(self._path, high)) <= count:
            return high if count == FINE else -1.0
        for _ in range(8):
            middle = (low + high) / 2
            low, high = (middle, high) if particles(load_at(self._path, middle)) <= count else (low, middle)
        return low

    def _surfaces(self, coarse: Pilot, fine: Pilot) -> Surfaces:
        self._tell("surfaces of the pilots")
        standard, final = load_at(self._path, 1.0), load_at(self._path, 2.0)
        cubes = standard.surface.cube_size, final.surface.cube_size
        if cubes[0] == cubes[1]:
            final = replace(final, surface=final.surface.model_copy(update={"cube_size": 0.7 * cubes[0]}))
        drawn = [
            tuple(pilot.surface(frame, settings) for frame in _shown(pilot.scene))
            for pilot, settings in ((coarse, standard), (fine, standard), (fine, final))
        ]
        return Surfaces(*drawn, (cubes[0], final.surface.cube_size))

    def _pictures(self, pilot: Pilot) -> Pictures:
        standard = load_at(self._path, 1.0)
        width, height = standard.render.resolution
        small, larger = ([max(16, width // part // 2 * 2), max(16, height // part // 2 * 2)] for part in SMALL)
        samples = standard.render.samples
        frames = _shown(pilot.scene)

        def draw(frame: int, resolution: list[int], samples: int) -> Drawn:
            return pilot.picture(frame, standard, {"resolution": resolution, "samples": samples})

        full = tuple(draw(frame, small, samples) for frame in frames)
        one, more = draw(frames[1], small, 1), draw(frames[1], larger, 1)
        return Pictures(full, one, more, (small[0] * small[1], larger[0] * larger[1]), samples)


def _shown(scene: Scene) -> list[int]:
    return [round(part * scene.last_frame) for part in SHOWN]


def _told(scene: Scene) -> str:
    count = particles(scene)
    return f"{count:,} particles" if count else f"a spacing of {1000 * spacing(scene):.3g} mm"
