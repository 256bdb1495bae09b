"""Which points of a study no other beats."""

from __future__ import annotations

import pytest

from workflow.study.points import Outcome, Point, front


def point(name: str, cost: float | None, error: float | None, status: str = "done") -> Point:
    return Point(name, {"a": name}, (Outcome(status, cost, error, error),))


POINTS = [
    point("slow", 9, 0.1),
    point("fast", 1, 0.8),
    point("worse", 2, 0.9),
    point("good", 3, 0.2),
    point("hardly better", 4, 0.199),
    point("failed", 0.1, None, "stopped"),
    point("refused", None, None, "refused"),
]


def test_the_front_goes_down_as_cost_rises():
    assert [found.name for found in front(POINTS)] == ["fast", "good", "slow"]
    assert front(POINTS[-2:]) == []


def test_repeats_count_by_their_median_and_fail_together():
    outcomes = tuple(Outcome("done", cost, 0.0, error) for cost, error in [(1, 0.3), (5, 0.1), (2, 0.2)])
    assert (Point("p", {}, outcomes).cost, Point("p", {}, outcomes).error) == (2, 0.2)
    broken = Point("p", {}, (*outcomes, Outcome("stopped", 0.5)))
    assert (broken.status, broken.error) == ("stopped", None)
    assert broken.cost == pytest.approx(1.5)
