"""What a film takes at any detail, from two pilots of it, of which the second is finer.

Steps and iterations grow with the fineness as they did from pilot to pilot. A step takes a constant time, and one for
every particle and for every particle's iteration, found by least squares over the frames of both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from scene.load import Scene
from workflow.budget.pilot import Drawn, Simulated
from workflow.budget.spacings import spacing
from workflow.plan.memory import particles
from workflow.plan.timeline import Timeline

COPIES = 2
"""Of a picture: in results/ and in renders/."""


@dataclass(frozen=True)
class Flight:
    """A pilot's scene and what its simulation took."""

    scene: Scene
    simulated: Simulated


@dataclass(frozen=True)
class Surfaces:
    """Surfaces of the same frames: of the coarse pilot, of the fine one, and of that with other cubes."""

    coarse: tuple[Drawn, ...]
    fine: tuple[Drawn, ...]
    cubes: tuple[Drawn, ...]
    cube_sizes: tuple[float, float]
    """Of the first two, and of the third."""


@dataclass(frozen=True)
class Pictures:
    """Pictures of the fine pilot: by frame with all samples, then one of the middle frame with one sample, and one with
    one sample of more pixels."""

    frames: tuple[Drawn, ...]
    one_sample: Drawn
    more_pixels: Drawn
    pixels: tuple[int, int]
    """Of all but the last, and of that."""
    samples: int


@dataclass(frozen=True)
class Prediction:
    """Seconds of each job of a stage by frame, and what every job of it takes besides [s]; bytes of all files."""

    simulate: np.ndarray
    """Shape [frames], without the first frame."""
    surface: float
    picture: float
    overheads: tuple[float, float, float]
    size: float


class Model:
    """Predicts from two pilots; `corrected` by what the first frames took at the detail that is asked for."""

    def __init__(self, coarse: Flight, fine: Flight, surfaces: Surfaces | None, pictures: Pictures):
        self._fine = fine
        self._surfaces, self._pictures = surfaces, pictures
        finer = self._finer = np.log(spacing(coarse.scene) / spacing(fine.scene))
        one, two = coarse.simulated, fine.simulated
        self._steps = _exponent(two.steps.sum(), one.steps.sum(), finer, 1.5)
        self._iterations = _exponent(_total(two.iterations, two), _total(one.iterations, one), finer, 1.5)
        self._cost = _exponent(two.stepping.sum() / two.steps.sum(), one.stepping.sum() / one.steps.sum(), finer, 4.0)
        self._terms = _terms([one, two]) if fine.scene.simulation.cloth is None and two.particles.any() else None
        self._correction = 1.0

    def simulate(self, scene: Scene) -> np.ndarray:
        """Seconds of stepping, shape [frames], of which a preset may have more than the pilot's."""
        done = np.concatenate([[0.0], np.cumsum(self._as_pilot(scene))])
        wanted, known = (np.linspace(0.0, 1.0, count) for count in (scene.last_frame + 1, len(done)))
        return np.diff(np.interp(wanted, known, done))

    def _as_pilot(self, scene: Scene) -> np.ndarray:
        """Seconds of stepping in each of the pilot's frames."""
        pilot = self._fine.simulated
        finer = spacing(self._fine.scene) / spacing(scene)
        if self._terms is None:
            return self._correction * pilot.stepping * finer ** (self._steps + self._cost)
        steps = pilot.steps * finer**self._steps
        count, iterations = pilot.particles * self._more(scene), pilot.iterations * finer**self._iterations
        constant, each, iteration = self._terms
        return self._correction * steps * (constant + count * (each + iteration * iterations))

    def correct(self, scene: Scene, probes: Sequence[Simulated]) -> None:
        """Scale what is predicted for a scene to what its first frames took, on average, if they hold what is
        simulated; what first frames of the fine pilot took differs from its own prediction, too."""
        count, pilot = len(probes[0].stepping), self._fine.simulated
        if self._terms is None or probes[0].particles.any():
            usual = pilot.stepping[:count].sum() / self.simulate(self._fine.scene)[:count].sum() * self._correction
            expected = self.simulate(scene)[:count].sum() * usual
            self._correction *= float(np.mean([probe.stepping.sum() for probe in probes]) / expected)

    def predict(self, scene: Scene) -> Prediction:
        """What a scene's film takes."""
        frames = scene.last_frame + 1
        surface, mesh = self._surface(scene)
        picture, image = self._picture(scene)
        pilot, more = self._fine.simulated, self._more(scene)
        overheads = (
            pilot.overhead,
            _mean(self._surfaces.fine, "overhead") if self._surfaces else 0.0,
            self._pictures.one_sample.overhead,
        )
        stepping = self.simulate(scene) + pilot.output * more
        segments = Timeline(scene.simulation.fps, scene.last_frame).segments
        size = frames * (pilot.size * more + mesh + COPIES * image) + segments * pilot.fixed
        return Prediction(stepping, surface, picture, overheads, size)

    def _more(self, scene: Scene) -> float:
        """Points of a scene over those of the fine pilot."""
        if self._fine.simulated.particles.any():
            return particles(scene) / max(1, particles(self._fine.scene))
        return (spacing(self._fine.scene) / spacing(scene)) ** 2

    def _surface(self, scene: Scene) -> tuple[float, float]:
        """Seconds and bytes of a frame."""
        if self._surfaces is None:
            return 0.0, 0.0
        found, finer = self._surfaces, spacing(self._fine.scene) / spacing(scene)
        cubes = found.cube_sizes[0] / scene.surface.cube_size
        ratio = np.log(found.cube_sizes[0] / found.cube_sizes[1])
        result = []
        for name in ("seconds", "size"):
            coarse, fine, other = (_mean(drawn, name) for drawn in (found.coarse, found.fine, found.cubes))
            of_points, of_cubes = _exponent(fine, coarse, self._finer, 3.0), _exponent(other, fine, ratio, 3.0)
            result.append(fine * finer**of_points * cubes**of_cubes)
        return result[0], result[1]

    def _picture(self, scene: Scene) -> tuple[float, float]:
        """Seconds and bytes of a frame."""
        found = self._pictures
        few, many = found.pixels
        width, height = scene.render.resolution
        per_pixel = max(0.0, (found.more_pixels.seconds - found.one_sample.seconds) / (many - few))
        constant = max(0.0, found.one_sample.seconds - few * per_pixel)
        mean = _mean(found.frames, "seconds")
        per_sample = max(0.0, (mean - found.one_sample.seconds) / (few * max(1, found.samples - 1)))
        pixels = width * height
        seconds = constant + pixels * (per_pixel + per_sample * (scene.render.samples - 1))
        return float(seconds), _mean(found.frames, "size") * pixels / few


def _mean(drawn: Sequence[Drawn], name: str) -> float:
    return float(np.mean([getattr(one, name) for one in drawn]))


def _total(values: np.ndarray, simulated: Simulated) -> float:
    return float((values * simulated.steps).sum() / max(1, simulated.steps.sum()))


def _exponent(fine: float, coarse: float, finer: float, most: float) -> float:
    """The power of the fineness that a value grows with, between 0 and `most`; 0 where nothing tells."""
    if min(fine, coarse) <= 0 or finer <= 0:
        return 0.0
    return float(np.clip(np.log(fine / coarse) / finer, 0.0, most))


def _terms(pilots: Sequence[Simulated]) -> np.ndarray:
    """Seconds of a step, of a step's particle, and of a particle's iteration."""
    rows, times = [], []
    for pilot in pilots:
        work = pilot.steps * pilot.particles
        rows.append(np.column_stack([pilot.steps, work, work * pilot.iterations]))
        times.append(pilot.stepping)
    matrix, right = np.concatenate(rows).astype(float), np.concatenate(times)
    weight = 1 / np.sqrt(np.maximum(right, 1e-9))
    scale = np.maximum(np.abs(matrix).max(axis=0), 1e-300)
    return nnls(matrix / scale * weight[:, None], right * weight)[0] / scale
