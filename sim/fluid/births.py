"""When particles came into a scene, and from where.

They are numbered as they come, so that a list of births says it of all of them: those from a number on, up to that of
the next birth, came at one time from one fluid body or emitter.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np


@dataclass
class Births:
    """first: identity of the first particle; time [s]; source: index into `names`; shape [n] each.

    Arrays are replaced when births are added, never changed, so that copies of this may share them.
    """

    names: tuple[str, ...] = ()
    """Of fluid bodies and emitters, in the order of their first births."""
    first: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int32))
    time: np.ndarray = field(default_factory=lambda: np.zeros(0, np.float64))
    source: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int32))

    def add(self, first: int, time: float, name: str) -> None:
        """Particles from identity `first` on come at `time` [s] from what is called `name`."""
        if name not in self.names:
            self.names = (*self.names, name)
        self.first = np.append(self.first, np.int32(first))
        self.time = np.append(self.time, float(time))
        self.source = np.append(self.source, np.int32(self.names.index(name)))

    def add_bodies(self, tag: np.ndarray, names: Sequence[str], time: float) -> None:
        """Particles of fluid bodies come at `time` [s]; tag: their identities, ascending, and indices of their bodies
        into `names`, shape [n, 2]."""
        for row in np.flatnonzero(np.diff(tag[:, 1], prepend=-1)):
            self.add(int(tag[row, 0]), time, names[tag[row, 1]])

    def fault(self, tag: np.ndarray) -> str | None:
        """Why this cannot be the births of particles with these tags, shape [m, 2]; None where it can."""
        if len(tag) and not (len(self.first) and self.first[0] <= tag[:, 0].min()):
            return "particles have no birth"
        if (np.diff(self.first) <= 0).any() or (self.time < 0).any():
            return "births are not in order"
        if ((self.source < 0) | (self.source >= len(self.names))).any():
            return "births are of unknown sources"
        return None
