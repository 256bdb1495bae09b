"""What is reported of cloth that was placed through something."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from scene.settings import Refused
from sim.cloth.untangling.placement import Intersections, Placement

NOTICEABLE = 0.01
"""Points that went further than this share of the thickness were moved."""


@dataclass(frozen=True)
class Untangled:
    """What became of a sheet that was placed through something, or was in the way of another."""

    sheet: str
    crossings: int
    """Edges through triangles, points beyond walls, and pieces inside solids."""
    through: list[str]
    """What it was placed through."""
    points: int
    """How many were moved."""
    furthest: float
    """By how much at most [m]."""

    def line(self) -> str:
        """What the user is told: through what the sheet is placed, how often, and how far its points were moved."""
        moved = f"{self.points} of its points were moved by up to {self.furthest * 1000:.3g} mm"
        if not self.crossings:
            return f"the sheet '{self.sheet}' was in the way of another: {moved}"
        through = f"{_listed(self.sheet, self.through)}, {self.crossings} times"
        return f"the sheet '{self.sheet}' is placed through {through}: {moved}, and it begins there"


def count_through(placement: Placement, found: Intersections) -> dict[str, Counter[str]]:
    """How often each sheet is through what."""
    counts: dict[str, Counter[str]] = {item.name: Counter() for item in placement.sheets}
    ends = np.column_stack([found.crossings.ends[:, 0], placement.corners(found.crossings)[:, 0]])
    pairs = [(placement.name(one), placement.name(other)) for one, other in ends]
    pairs += [(placement.name(point), placement.solids.wall_names[wall]) for point, wall in found.beyond]
    pairs += [(placement.name(points[0]), body.name) for points, body in found.inside]
    for one, other in pairs:
        for sheet, partner in {(one, other), (other, one)}:
            if sheet in counts:
                counts[sheet][partner] += 1
    return counts


def report(placement: Placement, before: np.ndarray, through: dict[str, Counter[str]]) -> list[Untangled]:
    """Of sheets that were through something, or were moved since points were at the places `before` [m]."""
    found = []
    for item, own in zip(placement.sheets, placement.of_sheet, strict=True):
        displacement = np.linalg.norm(placement.places[own] - before[own], axis=1)
        points = int((displacement > NOTICEABLE * item.sheet.thickness).sum())
        count = through[item.name]
        if points or count:
            found.append(Untangled(item.name, count.total(), list(count), points, float(displacement.max())))
    return found


def refusal(placement: Placement, found: Intersections) -> Refused:
    """Names the sheet that is through most."""
    through = count_through(placement, found)
    sheet = max(through, key=lambda name: through[name].total())
    listed = _listed(sheet, list(through[sheet]))
    return Refused(
        f"the sheet is placed through {listed}, and no way apart was found that leaves its pins where they are",
        location=("cloth", "sheets", sheet),
        remedy="move it or what it is placed through, or let it hang on other pins",
    )


def _listed(sheet: str, others: list[str]) -> str:
    names = ["itself" if name == sheet else f"'{name}'" for name in others]
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)
