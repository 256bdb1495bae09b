"""When a film is done, by how long its jobs take: they run as Snakemake runs them, two side by side."""

from __future__ import annotations

import heapq
from collections.abc import Sequence

from workflow.plan.timeline import Timeline

SIDE_BY_SIDE = 2
"""Jobs that share the cores, each with half of them."""


def wall(
    timeline: Timeline, segments: Sequence[float], surfaces: Sequence[float], blocks: Sequence[float], last: float, *,
    slots: int = SIDE_BY_SIDE,
) -> float:  # fmt: skip
    """Wall time [s] of a film whose jobs take these times [s]; without a surface `surfaces` is empty.

    A segment waits for the one before, its surface for it, its blocks of pictures for that; of what is ready,
    segments go first, then surfaces. `last`: of the film, which waits for all.
    """
    ready: list[tuple[int, int]] = [(_SEGMENT, 0)]
    running: list[tuple[float, int, int]] = []
    now = 0.0
    times = {_SEGMENT: segments, _SURFACE: surfaces, _BLOCK: blocks}
    while ready or running:
        while ready and len(running) < slots:
            kind, index = heapq.heappop(ready)
            heapq.heappush(running, (now + times[kind][index], kind, index))
        now, kind, index = heapq.heappop(running)
        for following in _following(timeline, kind, index, bool(surfaces)):
            heapq.heappush(ready, following)
    return now + last


_SEGMENT, _SURFACE, _BLOCK = range(3)


def _following(timeline: Timeline, kind: int, index: int, surface: bool) -> list[tuple[int, int]]:
    """What can begin once a job is done."""
    blocks = [(_BLOCK, k) for k in range(timeline.blocks) if timeline.segment_of_block(k) == index]
    if kind == _SURFACE:
        return blocks
    if kind == _BLOCK:
        return []
    later = [(_SEGMENT, index + 1)] if index + 1 < timeline.segments else []
    return later + ([(_SURFACE, index)] if surface else blocks)
