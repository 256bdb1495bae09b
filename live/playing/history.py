"""States that a live run can go back to, within a bound of memory."""

from __future__ import annotations

from sim.run.checkpoint import Checkpoint


class History:
    """States after frames, oldest first; as memory ends, every second one between the first and the last is let go."""

    def __init__(self, most_bytes: int):
        self.most_bytes = most_bytes
        self.kept: list[Checkpoint] = []

    @property
    def frames(self) -> list[int]:
        """Numbers of the frames that can be gone back to, oldest first."""
        return [checkpoint.clock.frame for checkpoint in self.kept]

    @property
    def bytes(self) -> int:
        """Memory of all states that are kept [bytes]."""
        return sum(checkpoint.bytes for checkpoint in self.kept)

    def keep(self, checkpoint: Checkpoint) -> None:
        """Add the state after a frame, and let others go while there are more than `most_bytes`."""
        self.kept.append(checkpoint)
        while self.bytes > self.most_bytes and len(self.kept) > 2:
            self.kept = [self.kept[0], *self.kept[2:-1:2], self.kept[-1]]

    def back_to(self, frame: int) -> Checkpoint:
        """The last state at or before a frame; those after it are let go."""
        self.kept = [item for item in self.kept if item.clock.frame <= frame] or self.kept[:1]
        return self.kept[-1]
