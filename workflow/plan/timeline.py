"""How the frames of a film are cut into segments of simulation and blocks of pictures.

Segment 0 holds the frames 0 to S and segment k the frames kS+1 to (k+1)S, where frame 0 is the
initial state. Where fps allows it, whole seconds end with a segment: a film that grows by
seconds gains segments and changes none.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from common.frames import Frames

LONGEST_SEGMENT = 16
SHORTEST_USEFUL_SEGMENT = 4
SEGMENT_WITHOUT_DIVISOR = 12
BLOCK = 4


def segment_length(fps: float) -> int:
    """The largest divisor of fps that is at most 16; 12 where fps has no useful divisor."""
    if fps == round(fps):
        best = max((d for d in range(1, LONGEST_SEGMENT + 1) if round(fps) % d == 0), default=1)
        if best >= SHORTEST_USEFUL_SEGMENT or best == fps:
            return best
    return SEGMENT_WITHOUT_DIVISOR


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
        return max(1, math.ceil(self.last_frame / segment_length(self.fps)))

    @property
    def blocks(self) -> int:
        """How many blocks of pictures there are, at least 1."""
        return max(1, math.ceil(self.last_frame / self._block_length))

    def segment(self, index: int) -> Frames:
        """Frames of a segment; raises IndexError."""
        return self._part(index, self.segments, segment_length(self.fps))

    def block(self, index: int) -> Frames:
        """Frames of a block; raises IndexError."""
        return self._part(index, self.blocks, self._block_length)

    def segment_of_block(self, index: int) -> int:
        """The one segment that holds the frames of a block."""
        return index * self._block_length // segment_length(self.fps)

    def time(self, frame: int) -> float:
        """[s]"""
        return frame / self.fps

    @property
    def _block_length(self) -> int:
        return block_length(segment_length(self.fps))

    def _part(self, index: int, count: int, length: int) -> Frames:
        if not 0 <= index < count:
            raise IndexError(f"there is no part {index} of {count}")
        first = 0 if index == 0 else index * length + 1
        return Frames(first, min((index + 1) * length, self.last_frame))
