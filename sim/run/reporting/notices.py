"""What a run says, once each, of what is, or was done, other than was asked for."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sim.bodies.obstacles import Obstacles
    from sim.cloth.untangling.report import Untangled
    from sim.rigid.model import RigidModel


class Notices:
    """`warn` takes each text as it is said."""

    def __init__(self, warn: Callable[[str], None]):
        self.warn = warn
        self.warnings: list[str] = []
        """What was said, for the summary."""
        self.untangled: dict[str, str] = {}
        """Of sheets that do not begin where they are placed, by their names."""
        self._mended: set[str] = set()

    def tell(self, text: str) -> None:
        """Warn of something once, and keep it for the summary."""
        if text not in self.warnings:
            self.warnings.append(text)
            self.warn(text)

    def tell_fallen(self, depth: float) -> None:
        """Warn of particles `depth` [m] below everything."""
        self.tell(
            f"fluid falls out of the scene: particles {depth:.3g} m below everything are taken out "
            "(particles_fallen in summary.json tells how many); a floor would keep them"
        )

    def tell_mended(self, obstacles: Obstacles) -> None:
        """Warn once of every mesh that is not what its file holds."""
        for item in obstacles.placed:
            if item.name not in self._mended and item.solid.report is not None and item.solid.report.lines():
                self._mended.add(item.name)
                self.warn(f"{item.name}: the mesh was mended: {'; '.join(item.solid.report.lines())}")

    def tell_overlaps(self, rigid: RigidModel) -> None:
        """Warn of bodies that begin inside each other: they are moved apart, which may look like a blow."""
        for one, other, depth in rigid.overlaps():
            self.tell(f"'{one}' and '{other}' begin {depth * 1000:.3g} mm inside each other: move one of them away")

    def tell_untangled(self, sheets: Iterable[Untangled]) -> None:
        """Warn of cloth that does not begin where it is placed."""
        for item in sheets:
            self.untangled[item.sheet] = item.line()
            self.warn(item.line())
