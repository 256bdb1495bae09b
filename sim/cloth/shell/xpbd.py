"""Extended position-based dynamics of a shell, in small steps."""

from __future__ import annotations

import numpy as np

from sim.cloth.contact.collision import Collisions
from sim.cloth.fabric.arrays import integers, numbers, vectors
from sim.cloth.fabric.coloring import colored
from sim.cloth.fabric.mesh import ClothMesh
from sim.cloth.integrators import xpbd_sums
from sim.cloth.integrators.small_steps import SmallSteps
from sim.cloth.shell import xpbd_sums as sums
from sim.cloth.shell.curvature import Bending
from sim.cloth.shell.shell import shell_of
from sim.cloth.shell.xpbd_sums import ShellMultipliers
from sim.cloth.spec import Cloth


class ShellXPBD(SmallSteps):
    """Strains of triangles and curvatures of points as constraints; those without a common point are solved side by
    side."""

    def __init__(self, mesh: ClothMesh, gravity: np.ndarray, settings: Cloth, collisions: Collisions):
        super().__init__(mesh, gravity, collisions)
        self.settings = settings.integrator_settings
        shell = self._shell = shell_of(mesh)
        self._multipliers = ShellMultipliers(
            stress_multiplier=vectors(np.zeros((shell.triangles, 3))),
            area_multiplier=numbers(np.zeros(shell.triangles)),
            bend_multiplier=vectors(np.zeros((3 * shell.count, 3))),
        )
        order, self._face_colors = colored(shell.membrane.corners, mesh.count)
        self._faces = integers(order)
        stars = _stars(shell.bending)
        order, self._star_colors = colored(stars, mesh.count) if len(stars) else (np.zeros(0, int), [])
        self._stars = integers(stars[order, 0])

    def limits(self) -> dict[str, float]:
        """Largest steps [s] by what limits them: none."""
        return {}

    def substeps(self, dt: float) -> int:
        return self.settings.substeps

    def run(self, dt: float, number: int) -> None:
        mesh, multipliers = self.mesh, self._multipliers
        points, rest, air = mesh.points, mesh.shell_rest, mesh.air
        for left in range(number, 0, -1):
            self._damp(dt)
            tables = points, air.drag, multipliers, self.motion
            sums.predict(air.present, self._shell.triangles, mesh.count, dt, left, self.gravity, air.wind, *tables)
            for _ in range(self.settings.iterations):
                for first, last in self._face_colors:
                    sums.project_strains(first, last, dt, self._faces, points, rest, multipliers)
                for first, last in self._star_colors:
                    sums.project_curvatures(first, last, dt, self._stars, points, rest, multipliers)
            self.project_contacts(dt, number, left)
            xpbd_sums.finish(mesh.count, dt, points, self.motion)

    def _damp(self, dt: float) -> None:
        """Slow strains and curvatures for dt [s]."""
        points, rest = self.mesh.points, self.mesh.shell_rest
        for first, last in self._face_colors if self._shell.membrane.delay.any() else ():
            sums.damp_strains(first, last, dt, self._faces, points, rest)
        for first, last in self._star_colors if self._shell.bending.delay.any() else ():
            sums.damp_curvatures(first, last, dt, self._stars, points, rest)

    @property
    def bytes(self) -> int:
        return super().bytes + 8 * (7 * self._shell.triangles + 12 * self.mesh.count)


def _stars(bending: Bending) -> np.ndarray:
    """Points that have a curvature, each with those beside it, and filled up with itself, shape [n, most]."""
    count = np.diff(bending.first)
    own = np.flatnonzero(count)
    most = int(count.max(initial=0))
    found = np.repeat(own[:, None], most + 1, axis=1)
    row = np.repeat(np.arange(len(own)), count[own])
    found[row, 1 + np.arange(len(row)) - np.repeat(bending.first[own], count[own])] = bending.points
    return found
