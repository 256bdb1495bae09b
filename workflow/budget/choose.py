"""The finest detail that is predicted to fit a budget of time, chosen once and kept beside the results."""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass
from pathlib import Path

from common.distribution import HOME
from scene.load import BUDGET, load
from scene.presets import QUALITIES
from scene.settings import Refused
from workflow.budget.detail import FINEST, Presets
from workflow.budget.forecast import Forecast, calibrated, forecast, teller
from workflow.budget.model import Model
from workflow.plan.jobs import Plan
from workflow.plan.kept import keep, kept, key_of

STEP = 0.05
"""Between details that are looked at."""
MARGIN = 1.2
"""A budget is so many times what is predicted: films took up to 1.25 times as long."""
AGAIN = 0.1
"""Farther than so much detail from where a model was corrected it is corrected anew."""


@dataclass(frozen=True)
class Choice:
    """A detail, and what it is predicted to take."""

    detail: float
    forecast: Forecast


def chosen(path: Path, name: str, budget: float, cores: int) -> Choice:
    """The choice for the scene at `path` with a budget [s]; made, and said on the error stream, if there is none yet.

    Raises Refused where even a draft takes longer, SceneError, and PilotFailed.
    """
    films = [Plan(load(path, quality=quality), HOME).job("film").plan for quality in QUALITIES]
    key = key_of(budget, cores, films)
    last = kept(name, BUDGET, key)
    if last is not None:
        return Choice(last["detail"], Forecast(**last["forecast"]))
    start = time.perf_counter()
    presets, tell = Presets(path), teller(name)
    with calibrated(presets, cores, tell) as (calibration, model):
        detail, probed = _finest(presets, model, budget, cores), None
        while probed is None or abs(detail - probed) > AGAIN:
            calibration.probe(model, presets.at(detail))
            detail, probed = _finest(presets, model, budget, cores), detail
    choice = Choice(detail, forecast(model, presets.at(detail), cores))
    keep(name, BUDGET, key, asdict(choice))
    tell(f"{told(choice)}; found in {time.perf_counter() - start:.0f} s")
    return choice


def told(choice: Choice) -> str:
    """A choice in words."""
    below = int(min(choice.detail, FINEST - STEP))
    where = f"detail {choice.detail:.2f}, from {QUALITIES[below]} ({below}) to {QUALITIES[below + 1]} ({below + 1})"
    return f"{where}: {choice.forecast}"


def _finest(presets: Presets, model: Model, budget: float, cores: int) -> float:
    """The finest detail that fits; raises Refused."""
    steps = round(FINEST / STEP)
    low, high = 0, steps + 1
    needed = MARGIN * forecast(model, presets.at(0.0), cores).wall_s
    if needed > budget:
        raise Refused(
            f"--config budget={budget:g}s: even at draft quality {presets.path} takes about {needed:.0f} s",
            remedy=f"give it {needed:.0f} s or more, or a shorter duration",
        )
    while high - low > 1:
        middle = (low + high) // 2
        fits = MARGIN * forecast(model, presets.at(middle * STEP), cores).wall_s <= budget
        low, high = (middle, high) if fits else (low, middle)
    return low * STEP
