"""When a film is done, by hand."""

from __future__ import annotations

import pytest

from workflow.budget.schedule import wall
from workflow.plan.timeline import Timeline

TWO_SEGMENTS = Timeline(24, 24)
"""Of 12 frames, each with three blocks."""


def test_blocks_run_beside_the_next_segment():
    # 0 to 10: segment; 10 to 20: the next beside two blocks; the other four by twos.
    assert wall(TWO_SEGMENTS, [10, 10], [], [5] * 6, 2) == 32
    assert wall(TWO_SEGMENTS, [10, 10], [], [5] * 6, 2, slots=1) == 52


def test_surfaces_go_before_pictures():
    # 10 to 14: surface beside the segment; then a block to 19; segment at 20 gives its surface to 24, a block to 24.
    assert wall(TWO_SEGMENTS, [10, 10], [4, 4], [5] * 6, 0) == 34
    assert wall(TWO_SEGMENTS, [10, 10], [4, 4], [5] * 6, 0, slots=1) == 58


@pytest.mark.parametrize("last", [1, 11, 25, 100])
def test_no_slot_does_more_than_it_can(last):
    timeline = Timeline(24, last)
    segments, blocks = [3.0] * timeline.segments, [7.0] * timeline.blocks
    work = sum(segments) + sum(blocks)
    found = wall(timeline, segments, [], blocks, 0)
    assert max(work / 2, sum(segments) + 7) <= found <= work
