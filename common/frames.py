"""A range of frames of a film."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass


@dataclass(frozen=True)
class Frames:
    """The frames `first` to `last`, both included."""

    first: int
    last: int

    def __str__(self) -> str:
        return f"{self.first}:{self.last}"

    def __len__(self) -> int:
        return self.last - self.first + 1

    def __iter__(self) -> Iterator[int]:
        return iter(range(self.first, self.last + 1))

    def __contains__(self, frame: object) -> bool:
        return frame in range(self.first, self.last + 1)

    @classmethod
    def parse(cls, text: str) -> Frames:
        """The frames of the text `A:B`, both included; raises ValueError."""
        first, colon, last = text.partition(":")
        if not (colon and first.isdecimal() and last.isdecimal() and int(first) <= int(last)):
            raise ValueError(f"expected FIRST:LAST, such as 0:12, got '{text}'")
        return cls(int(first), int(last))
