"""The cheapest settings of a scene that studies found exact enough, and what its film is predicted to take."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from common.distribution import HOME
from scene import grid
from scene.load import ACCURACY, Scene, load
from scene.settings import Refused
from workflow.accuracy.evidence import Measured, cheapest, evidence, least_error
from workflow.budget.detail import Presets
from workflow.budget.forecast import predicted, teller
from workflow.budget.spacings import is_spacing, resolving, scaled
from workflow.plan.jobs import Plan
from workflow.plan.kept import keep, kept, key_of


@dataclass(frozen=True)
class Settings:
    """What an error needs: spacings and others by path, and the studies that say so."""

    spacings: Mapping[str, float]
    others: Mapping[str, Any]
    reasons: tuple[str, ...]

    def __str__(self) -> str:
        lengths = {path: f"{1000 * value:.3g} mm" for path, value in self.spacings.items()}
        return ", ".join(f"{path} {value}" for path, value in {**lengths, **self.others}.items())


def chosen(path: Path, name: str, error: float, cores: int) -> Scene:
    """The scene at `path` with at most this error; what is chosen and predicted is said on the error stream, once.

    Raises Refused where no study found so small an error, SceneError, and PilotFailed.
    """
    base = load(path)
    settings = needed(base, error)
    scene = replace(
        load(path, quality=base.quality, overrides=grid.overrides({**settings.spacings, **settings.others})),
        quality=ACCURACY,
    )
    key = key_of(cores, Plan(scene, HOME).job("film").plan)
    if kept(name, ACCURACY, key) is None:
        start, tell = time.perf_counter(), teller(name)
        tell(f"an error of {100 * error:g} % needs {settings}")
        for reason in settings.reasons:
            tell(reason)
        forecast = predicted(Presets(path, grid.overrides(settings.others)), scene, cores, tell)
        keep(name, ACCURACY, key, {"error": error, **asdict(settings), "forecast": asdict(forecast)})
        tell(f"{forecast}; found in {time.perf_counter() - start:.0f} s")
    return scene


def needed(scene: Scene, error: float) -> Settings:
    """The finest of what every study that speaks for the scene's materials needs, with spacings that are no coarser
    than those of its draft; raises Refused, SceneError."""
    picked = list(_picked(scene, error))
    across: dict[str, float] = {}
    others: dict[str, Any] = {}
    best: dict[str, float] = {}
    for material, point in picked:
        for path, value in point.fineness.items():
            if is_spacing(path):
                across[material] = max(across.get(material, 0.0), value)
            elif value > best.get(path, 0.0):
                best[path], others[path] = value, point.chosen[path]
    coarsest = scaled(load(scene.path, quality="draft"), 1.0)
    return Settings(
        {
            path: float(f"{min(value, coarsest.get(path, value)):.4g}")
            for path, value in resolving(scene, **across).items()
        },
        others,
        tuple(_reason(material, point) for material, point in picked),
    )


def _picked(scene: Scene, error: float) -> Iterator[tuple[str, Measured]]:
    materials = scene.simulation.materials()
    if not scene.simulation.has_dynamic_bodies():
        materials -= {"rigid"}
    for material in sorted(materials):
        for points in evidence(material, scene):
            point = cheapest(points, error)
            if point is None:
                least = least_error(points)
                raise Refused(
                    f"--config error={100 * error:g}%: no setting of study {points[0].study} can be trusted with that",
                    remedy=f"ask for {_rounded_up(100 * least)} % or more, choose another solver, or widen the study",
                )
            yield material, point


def _rounded_up(value: float) -> str:
    step = 10.0 ** (math.floor(math.log10(value)) - 1) if 0 < value < math.inf else 1.0
    return f"{math.ceil(value / step) * step:.4g}" if value < math.inf else "100"


def _reason(material: str, point: Measured) -> str:
    settings = [f"{path} {value}" for path, value in point.chosen.items()]
    settings += [f"{value:.3g} spacings across" for path, value in point.fineness.items() if is_spacing(path)]
    error = math.inf if point.error is None else point.error
    return f"{material}: {100 * error:.2g} % in study {point.study} with {', '.join(settings)}"
