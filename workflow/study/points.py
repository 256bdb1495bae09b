"""The trials of a study as points of error over cost, and which of them no other beats in both."""

from __future__ import annotations

import statistics
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from workflow.study.spec import Overrides

BETTER = 0.99
"""Share of an error below which another counts as less: what costs more has to be worth it."""


@dataclass(frozen=True)
class Outcome:
    """One simulation: cost in wall seconds per simulated second; value and error only of those that were done."""

    status: str
    cost: float | None
    value: float | None = None
    error: float | None = None
    figures: Mapping[str, Any] = field(default_factory=dict)
    message: str = ""


@dataclass(frozen=True)
class Point:
    """All repeats of one trial; bounds are the least and the greatest of them."""

    name: str
    chosen: Overrides
    outcomes: tuple[Outcome, ...]

    @property
    def status(self) -> str:
        """`done` where all repeats were, else how the first other one ended."""
        return next((outcome.status for outcome in self.outcomes if outcome.status != "done"), "done")

    @property
    def found(self) -> tuple[float, float]:
        """Cost and error, of a point that has both."""
        cost, error = self.cost, self.error
        if cost is None or error is None:
            raise ValueError(f"{self.name} has no cost, or no error")
        return cost, error

    @property
    def cost(self) -> float | None:
        """Median of `costs`; None where there are none."""
        costs = self.costs
        return statistics.median(costs) if costs else None

    @property
    def costs(self) -> list[float]:
        """Of the repeats that have one."""
        return [outcome.cost for outcome in self.outcomes if outcome.cost is not None]

    @property
    def error(self) -> float | None:
        """Median of `errors`; None where there are none, or a repeat was not done."""
        errors = self.errors
        return statistics.median(errors) if errors and self.status == "done" else None

    @property
    def errors(self) -> list[float]:
        """Of the repeats that have one."""
        return [outcome.error for outcome in self.outcomes if outcome.error is not None]


def front(points: Iterable[Point]) -> list[Point]:
    """Points of which no other has both less error and less cost, by rising cost (Pareto)."""
    done = [point for point in points if point.error is not None and point.cost is not None]
    kept: list[Point] = []
    for point in sorted(done, key=lambda point: point.found):
        if not kept or point.found[1] < BETTER * kept[-1].found[1]:
            kept.append(point)
    return kept
