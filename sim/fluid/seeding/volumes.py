"""How much of the fluid that was asked for there is, and what would bring more."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from sim.fluid.seeding.seed import Seed
from sim.fluid.seeding.sources import Source

TOLERANCE = 0.02
"""Share of a volume by which that of the particles may differ from it without a warning."""
MOST = 0.5
"""Share of a body that may be where something else is."""


@dataclass(frozen=True)
class Volume:
    """The volumes of one fluid body [m^3]: of its shape (`asked`), what solids and other fluid leave of that (`free`),
    and that of its particles (`given`); thickness: of the shape where it is thickest [m]."""

    name: str
    asked: float
    free: float
    given: float
    homeless: int
    thickness: float
    spacing: float

    @classmethod
    def of(cls, source: Source, found: Seed) -> Volume:
        """Of the fluid body that a source asks for, with the particles found for it."""
        each = source.spacing**3
        given, homeless = len(found.points) * each, found.number - len(found.points)
        return cls(source.name, source.solid.volume, found.volume, given, homeless, source.thickness, source.spacing)

    def line(self) -> str:
        """What was asked for and what there is."""
        taken = self.asked - self.free
        left = f", of which solids and other fluid take {litres(taken)}" if taken > self.spacing**3 / 2 else ""
        return f"{self.name}: {litres(self.given)} of {litres(self.asked)}{left}"

    def warnings(self) -> Iterator[str]:
        """What the user should know: most of the shape is not free, it is thinner than a layer, or particles do not
        fill it."""
        if self.free < MOST * self.asked:
            yield (
                f"'{self.name}' has room for {litres(self.free)} of its {litres(self.asked)} only: the rest is outside "
                "of the containers, or where solids or other fluid are; make it smaller, or move it"
            )
        if self.thickness < (1 - 1e-3) * self.spacing:
            yield (
                f"'{self.name}' is {1000 * self.thickness:.3g} mm thick, less than the distance of particles, "
                f"{1000 * self.spacing:.3g} mm, and is one loose layer; "
                f"a particle_radius of {self.thickness / 4:.3g} m makes two"
            )
        if abs(self.given - self.free) > TOLERANCE * self.free:
            what = f"'{self.name}' has {litres(self.given)} of the {litres(self.free)} that are free"
            if self.homeless:
                yield (
                    f"{what}: {self.homeless:,} particles have no room in gaps narrower than they are; "
                    f"try a particle_radius of {self.spacing / 4:.3g} m"
                )
            else:
                fine = (self.free * 2 * TOLERANCE) ** (1 / 3) / 2
                yield f"{what}: particles are too large for this volume; a particle_radius of {fine:.3g} m would do"


def litres(volume: float) -> str:
    """A volume [m^3] in the unit in which it is easily read."""
    if volume >= 1:
        return f"{volume:.4g} m^3"
    return f"{1e3 * volume:.4g} l" if volume >= 1e-3 else f"{1e6 * volume:.4g} ml"
