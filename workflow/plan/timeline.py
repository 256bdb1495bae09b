"""How the frames of a film are cut into segments of simulation and blocks of pictures.

Frame 0 is the initial state, and segment k holds the S frames from kS+1 on; segment 0 frame 0 as well. Where fps allows
it, whole seconds end with a segment: a film that grows by seconds gains segments and changes none.

The longer the film, the longer segments are towards its end, so that it has no more than some hundreds: from the frame
EQUAL S on they have 2 S frames, from 2 EQUAL S on 4 S, and so on. Where a film is cut up to some frame does not depend
on how far it goes on. None of the longer ones has more than a thirty-second of the frames before it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

from common.frames import Frames

LONGEST_SEGMENT = 16
SHORTEST_USEFUL_SEGMENT = 4
SEGMENT_WITHOUT_DIVISOR = 12
BLOCK = 4
EQUAL = 64
"""Segments before the first that is twice as long."""


@cache
def segment_length(fps: float) -> int:
    """The largest divisor of fps that is at most 16; 12 where fps has no useful divisor."""
    if fps == round(fps):
        best = max((d for d in range(1, LONGEST_SEGMENT + 1) if round(fps) % d == 0), default=1)
        if best >= SHORTEST_USEFUL_SEGMENT or best == fps:
            return best
    return SEGMENT_WITHOUT_DIVISOR


@cache
def block_length(segment: int) -> int:
    """The divisor of the segment's length that is nearest to 4 frames, so that the last cores end together."""
    divisors = [d for d in range(1, segment + 1) if segment % d == 0]
    return min(divisors, key=lambda d: (abs(math.log(d / BLOCK)), -d))


@dataclass(frozen=True)
class Timeline:
    """The frames 0 to `last_frame` at `fps` frames per second."""

    fps: float
    last_frame: int

    @property
    def segments(self) -> int:
        """How many segments of simulation there are, at least 1."""
        pieces = max(1, math.ceil(self.last_frame / self._segment_length))
        return _segment_at(pieces - 1) + 1

    @property
    def blocks(self) -> int:
        """How many blocks of pictures there are, at least 1."""
        whole = self.segments - 1
        start, length = _begin(whole)
        rest = self.last_frame - start * self._segment_length
        return whole * self._blocks_in_segment + max(1, math.ceil(rest / (length * self._block_length)))

    def segment(self, index: int) -> Frames:
        """Frames of a segment; raises IndexError."""
        self._refuse_outside(index, self.segments)
        start, length = _begin(index)
        return self._part(start * self._segment_length, length * self._segment_length)

    def block(self, index: int) -> Frames:
        """Frames of a block; raises IndexError."""
        self._refuse_outside(index, self.blocks)
        start, length = _begin(self.segment_of_block(index))
        frames = length * self._block_length
        return self._part(start * self._segment_length + index % self._blocks_in_segment * frames, frames)

    def segment_of_block(self, index: int) -> int:
        """The one segment that holds the frames of a block."""
        return index // self._blocks_in_segment

    def time(self, frame: int) -> float:
        """[s]"""
        return frame / self.fps

    @property
    def _segment_length(self) -> int:
        return segment_length(self.fps)

    @property
    def _block_length(self) -> int:
        return block_length(self._segment_length)

    @property
    def _blocks_in_segment(self) -> int:
        return self._segment_length // self._block_length

    def _refuse_outside(self, index: int, count: int) -> None:
        if not 0 <= index < count:
            raise IndexError(f"there is no part {index} of {count}")

    def _part(self, before: int, length: int) -> Frames:
        return Frames(before + 1 if before else 0, min(before + length, self.last_frame))


def _begin(segment: int) -> tuple[int, int]:
    """Where a segment begins and how long it is, both in lengths of the first one."""
    if segment < EQUAL:
        return segment, 1
    doublings, later = divmod(segment - EQUAL, EQUAL // 2)
    length = 2 << doublings
    return EQUAL // 2 * length + later * length, length


def _segment_at(place: int) -> int:
    """The segment that holds a place, which is in lengths of the first one."""
    doublings = (place // EQUAL).bit_length()
    if not doublings:
        return place
    return EQUAL // 2 * (doublings + 1) + (place - (EQUAL << doublings - 1) >> doublings)
