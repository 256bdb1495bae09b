"""Frames cut into segments and blocks."""

from __future__ import annotations

import pytest

from workflow.plan.timeline import Timeline, block_length, segment_length

SPANS = [
    (fps, seconds)
    for fps in (1, 4, 5, 7, 12, 23, 24, 25, 26, 29.97, 30, 48, 50, 60, 120)
    for seconds in (1, 2, 3.5, 32, 32.1, 300, 1000)
]


@pytest.mark.parametrize(
    ("fps", "length"),
    [
        (24, 12),
        (30, 15),
        (60, 15),
        (50, 10),
        (48, 16),
        (25, 5),
        (12, 12),
        (16, 16),
        (23, 12),
        (34, 12),
        (29.97, 12),
        (1, 1),
    ],
)
def test_segment_length(fps, length):
    assert segment_length(fps) == length


@pytest.mark.parametrize(("segment", "block"), [(12, 4), (15, 5), (16, 4), (10, 5), (5, 5), (13, 13), (8, 4), (1, 1)])
def test_block_length(segment, block):
    assert block_length(segment) == block


def all_frames(parts):
    return [frame for part in parts for frame in range(part.first, part.last + 1)]


@pytest.mark.parametrize(("fps", "seconds"), SPANS)
def test_segments_and_blocks_hold_every_frame_once(fps, seconds):
    timeline = Timeline(fps, max(1, round(fps * seconds)))
    expected = list(range(timeline.last_frame + 1))
    assert all_frames(timeline.segment(k) for k in range(timeline.segments)) == expected
    assert all_frames(timeline.block(b) for b in range(timeline.blocks)) == expected


@pytest.mark.parametrize(("fps", "seconds"), SPANS)
def test_a_block_lies_in_its_segment(fps, seconds):
    timeline = Timeline(fps, max(1, round(fps * seconds)))
    for index in range(timeline.blocks):
        block, segment = timeline.block(index), timeline.segment(timeline.segment_of_block(index))
        assert segment.first <= block.first <= block.last <= segment.last


@pytest.mark.parametrize("fps", [24, 25, 30, 50, 60])
def test_whole_seconds_end_with_a_segment_so_that_a_longer_film_only_adds(fps):
    short, long = Timeline(fps, 2 * fps), Timeline(fps, 3 * fps)
    assert [short.segment(k) for k in range(short.segments)] == [long.segment(k) for k in range(short.segments)]
    assert [short.block(b) for b in range(short.blocks)] == [long.block(b) for b in range(short.blocks)]


@pytest.mark.parametrize("fps", [24, 25, 29.97, 60])
def test_a_longer_film_changes_nothing_but_the_last_part(fps):
    long = Timeline(fps, 20_000)
    for last in (1, 500, 768, 769, 780, 5_000, 12_345):
        short = Timeline(fps, last)
        assert [short.segment(k) for k in range(short.segments - 1)] == [
            long.segment(k) for k in range(short.segments - 1)
        ]
        assert [short.block(b) for b in range(short.blocks - 1)] == [long.block(b) for b in range(short.blocks - 1)]


def test_a_film_of_any_length_has_some_hundreds_of_segments():
    """64, and 32 more for each doubling; the longest has 1 of 32 to 64 of all frames."""
    assert [Timeline(24, 768 << doublings).segments for doublings in range(5)] == [64, 96, 128, 160, 192]
    film = Timeline(24, 10_000)
    assert film.segments == 181
    assert film.blocks == 541
    assert max(len(film.segment(k)) for k in range(film.segments)) == 192


def test_a_part_that_does_not_exist():
    with pytest.raises(IndexError):
        Timeline(24, 24).segment(2)
