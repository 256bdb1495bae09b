"""The wave along a row of dominoes after van Leeuwen (2010), Am. J. Phys. 78, 721: "The domino effect".

Every domino turns about the lower edge ahead of it, which does not slide. One that strikes the next stays in contact
with it, and its upper edge slides down the face that it leans on, with Coulomb's friction. So the tilts of all that
have been struck follow from that of the foremost: an ordinary differential equation, with a jump at every blow.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

G = 9.81
STEPS = 400
"""Of tilt, from one blow to the next; ten times as many change no time by more than 1e-4 of it."""
NUDGE = 1e-6
"""Of tilt [rad], for derivatives at a blow."""


@dataclass(frozen=True)
class Row:
    """Equal dominoes: height, thickness and distance from one to the next [m]; friction between two of them."""

    number: int
    height: float
    thickness: float
    pitch: float
    friction: float

    @property
    def striking(self) -> float:
        """The tilt [rad] at which a domino meets the next."""
        return float(np.arcsin((self.pitch - self.thickness) / self.height))

    def tilts(self, foremost: np.ndarray, number: int) -> np.ndarray:
        """Of the `number` that lean on one another, the foremost last: h sin(tilt - next) = p cos(next) - d."""
        found = [np.asarray(foremost, dtype=np.float64)]
        for _ in range(number - 1):
            ahead = found[-1]
            found.append(ahead + np.arcsin((self.pitch * np.cos(ahead) - self.thickness) / self.height))
        return np.stack(found[::-1])

    def weights(self, tilts: np.ndarray) -> np.ndarray:
        """How much of a torque on each arrives at the foremost: the ratios of the arms of the force at each contact."""
        found = [np.ones_like(tilts[-1])]
        for one, ahead in zip(tilts[-2::-1], tilts[:0:-1], strict=True):
            between = one - ahead
            struck = self.height * np.cos(between) - self.pitch * np.sin(ahead) - self.friction * self.thickness
            strikes = self.height * (np.cos(between) + self.friction * np.sin(between))
            found.append(found[-1] * struck / strikes)
        return np.stack(found[::-1])

    def pull(self, tilts: np.ndarray) -> np.ndarray:
        """Of gravity: torque over moment of inertia, both about the edge [rad/s^2]."""
        lever = self.height * np.sin(tilts) - self.thickness * np.cos(tilts)
        return 1.5 * G * lever / (self.height**2 + self.thickness**2)

    def fall(self, number: int, low: float, squared: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Tilts of the foremost of `number`, from `low` to where it strikes, when it has them [s], and its spins.

        sum w (g a + b y) = sum w pull, with its tilts' first and second derivatives g and b by the foremost's, and
        y = spin^2, a = (dy/dtilt) / 2; `squared` is y at `low` [rad^2/s^2].
        """
        edges = np.linspace(low, self.striking, STEPS + 1)
        width = edges[1] - edges[0]
        before, now, after = (self.tilts(at, number) for at in (edges[:-1], (edges[1:] + edges[:-1]) / 2, edges[1:]))
        weights = self.weights(now)
        inertia = (weights * (after - before)).sum(axis=0) / width
        bend = (weights * (after - 2 * now + before)).sum(axis=0) / (width / 2) ** 2 / inertia * width
        drive = 2 * (weights * self.pull(now)).sum(axis=0) / inertia * width
        squares = [squared]
        for gain, loss in zip(drive, bend, strict=True):
            squares.append((squares[-1] * (1 - loss) + gain) / (1 + loss))
        spins = np.sqrt(squares)
        return edges, np.concatenate(([0.0], np.cumsum(2 * width / (spins[1:] + spins[:-1])))), spins

    def blow(self, number: int) -> float:
        """The next one's spin after the blow over that of the foremost of `number` before it."""
        after = (self.tilts(np.array(NUDGE), number + 1) - self.tilts(np.array(0.0), number + 1)) / NUDGE
        low, high = (self.tilts(np.array(self.striking - nudge), number) for nudge in (NUDGE, 0.0))
        weights = self.weights(self.tilts(np.array(0.0), number + 1))
        return float((weights[:-1] * (high - low) / NUDGE).sum() / (weights * after).sum())


def arrivals(row: Row, start: float, seen: float) -> np.ndarray:
    """When each domino but the first has the tilt `seen` [s], the first let go at rest at the tilt `start` [rad]."""
    time, low, squared, found = 0.0, start, 0.0, []
    for number in range(1, row.number + 1):
        tilts, times, spins = row.fall(number, low, squared)
        if number > 1:
            found.append(time + np.interp(seen, tilts, times))
        time, low, squared = time + times[-1], 0.0, (spins[-1] * row.blow(number)) ** 2
    return np.array(found)
