"""Cloth that is placed through itself, another sheet or a solid is moved apart before the first step.

Round by round: contours along which surfaces cross are found (`contours`), the piece that is on the wrong side of the
other surface is pushed back through it (`pushing`), and the cloth follows as a whole (`relaxation`), so that a sheet
that nothing holds goes aside rather than being stretched. A contour that cuts nothing off is made shorter. What is
inside a solid altogether goes out the shortest way.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from scene.settings import Refused
from sim.cloth.untangling.filled import Filled
from sim.cloth.untangling.placement import Intersections, Placement
from sim.cloth.untangling.pushing import Pushing
from sim.cloth.untangling.relaxation import relax
from sim.cloth.untangling.report import Untangled, count_through, refusal, report

if TYPE_CHECKING:
    from sim.cloth.contact.solids import Solids
    from sim.cloth.fabric.state import ClothState
    from sim.cloth.model import PlacedSheet

ROUNDS = 100
FORCE, GROWTH, MOST_FORCE = 0.1, 1.1, 1e3
"""How firmly cloth is pushed in the first round; by how much more in each; and at most."""
WORSE = 4
"""With so many times the crossings of the start it is given up."""


def untangle(
    sheets: list[PlacedSheet], state: ClothState, solids: Solids, up: np.ndarray
) -> tuple[list[PlacedSheet], list[Untangled]]:
    """The sheets with the places where they begin, and what was done; those in `state` stay where they are. `up`: unit
    vector against gravity, by which cloth goes where it may as well go down.

    Raises Refused where there is no way out.
    """
    placement = Placement(sheets, state, solids)
    reports = _resolve(placement, up) if placement.begins.any() else []
    moved = {item.sheet for item in reports}
    rows = zip(sheets, placement.of_sheet, strict=True)
    return [replace(item, moved=placement.places[own]) if item.name in moved else item for item, own in rows], reports


def _resolve(placement: Placement, up: np.ndarray) -> list[Untangled]:
    """Move cloth until it is through nothing; returns what was done."""
    before = placement.places.copy()
    found = placement.intersect(as_placed=True)
    if not found:
        return []
    through = count_through(placement, found)
    _refuse_pins_inside(placement)
    try:
        _move_apart(placement, Pushing(placement, up, one_by_one=False), found)
    except Refused:
        # Sheets that go out of each other's way all at once may hinder one another.
        placement.places = before.copy()
        _move_apart(placement, Pushing(placement, up, one_by_one=True), found)
    return report(placement, before, through)


def _move_apart(placement: Placement, pushing: Pushing, found: Intersections) -> None:
    force, most = FORCE, WORSE * (len(found.crossings) + len(placement.sheets))
    for _ in range(ROUNDS):
        if len(found.crossings) > most:
            raise refusal(placement, replace(found, beyond=np.zeros((0, 2), int), inside=[]))
        if len(found.crossings) or len(found.beyond):
            _push(placement, pushing, found, force)
            force = min(GROWTH * force, MOST_FORCE)
        elif found.inside:
            for points, body in found.inside:
                _take_out(placement, points, body)
        else:
            break
        found = placement.intersect()
    else:
        raise refusal(placement, found)


def _push(placement: Placement, pushing: Pushing, found: Intersections, force: float) -> None:
    """Let cloth follow one round of pushes."""
    free, crossings = placement.free, found.crossings
    stuck = ~(free[crossings.ends].any(axis=1) | free[placement.corners(crossings)].any(axis=1))
    if stuck.any():
        alone = crossings.take(np.flatnonzero(stuck))
        raise refusal(placement, Intersections(alone, np.zeros((0, 2), int), []))
    pushes = pushing.pushes(found)
    moved = np.unique(placement.piece[pushes.points[pushes.weight != 0]])
    followers = free & np.isin(placement.piece, moved)
    placement.places = relax(placement.places, placement.springs, placement.rest, followers, pushes, force)


def _take_out(placement: Placement, points: np.ndarray, body: Filled) -> None:
    displacement = body.way_out(placement.places[points])
    length = np.linalg.norm(displacement)
    placement.places[points] += displacement * (1 + 2 * placement.half[points].max() / length)


def _refuse_pins_inside(placement: Placement) -> None:
    for body in placement.filled:
        points = np.flatnonzero(placement.held & placement.begins)
        points = points[placement.within(body, points)]
        if len(points):
            place = np.round(placement.places[points[0]], 4).tolist()
            raise Refused(
                f"a pin holds the sheet inside '{body.name}', at {place}",
                location=("cloth", "sheets", placement.name(points[0]), "pins"),
                remedy=f"pin it elsewhere, or move it or '{body.name}'",
            )
