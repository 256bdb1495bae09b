"""Energies and extremes of a cloth."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from sim.cloth.fabric import energy_sums
from sim.cloth.fabric.layout import PARTITIONS
from sim.cloth.fabric.mesh import ClothMesh
from sim.device.compiler import ti


@dataclass(frozen=True)
class ClothMeasure:
    """Sums over all points, springs and hinges, and extremes."""

    kinetic_energy: float
    potential_energy: float
    """In gravity [J]."""
    elastic_energy: float
    v_max: float
    stretch_max: float
    """Greatest length of a spring, or of a line on a shell, over that at rest; of what has none at rest, 1."""

    @property
    def finite(self) -> bool:
        """Whether all energies and the greatest speed are finite."""
        return math.isfinite(self.kinetic_energy + self.potential_energy + self.elastic_energy + self.v_max)


class Meter:
    """Measures one cloth."""

    def __init__(self, mesh: ClothMesh):
        self.mesh = mesh
        self._partitions = ti.Vector.ndarray(5, ti.f64, PARTITIONS)

    def read(self) -> ClothMeasure:
        """Measure the cloth as it is now."""
        found = energy_sums.measure(self.mesh.model, self._partitions)
        whole = ClothMeasure(*(float(value) for value in found))
        if self.mesh.shell is None:
            return whole
        elastic, stretch = self._read_shell()
        return replace(whole, elastic_energy=elastic, stretch_max=stretch)

    def _read_shell(self) -> tuple[float, float]:
        from sim.cloth.shell.energy_sums import measure
        from sim.cloth.shell.shell import shell_of

        mesh, shell = self.mesh, shell_of(self.mesh)
        found = measure(shell.triangles, shell.count, mesh.points, mesh.shell_rest, self._partitions)
        return float(found[2]), float(found[4])
