"""Symplectic Euler: the reference, explicit, in as many steps as stability asks for.

A step has to stay below 2 / w_max (sqrt(1 + z^2) - z), w_max the highest angular frequency and z its damping ratio.
By Gershgorin's theorem w_max^2 is at most the greatest sum of a row of the stiffness over its mass; for springs alone
that is 2 sum k / m.
"""

from __future__ import annotations

import math

import numpy as np

from sim.cloth.contact.collision import Collisions
from sim.cloth.fabric.arrays import numbers, vectors
from sim.cloth.fabric.mesh import ClothMesh, Elastic, fold
from sim.cloth.integrators import symplectic_euler_sums
from sim.cloth.integrators.small_steps import SmallSteps
from sim.cloth.integrators.symplectic_euler_sums import ElementForces
from sim.cloth.spec import Cloth

MOST_SUBSTEPS = 20_000
"""Of a step: more would seem to hang."""


class SymplecticEuler(SmallSteps):
    def __init__(self, mesh: ClothMesh, gravity: np.ndarray, settings: Cloth, collisions: Collisions):
        super().__init__(mesh, gravity, collisions)
        self.stable = self.stable_step(mesh, settings)
        self._elements = ElementForces(
            tension=vectors(np.zeros((mesh.springs, 3))),
            moment=numbers(np.zeros(mesh.hinges)),
            angle_gradient=vectors(np.zeros((4 * mesh.hinges, 3))),
        )

    @staticmethod
    def stable_step(mesh: Elastic, settings: Cloth) -> float:
        """The longest step [s] that it takes; known before anything is built that steps."""
        return settings.integrator_settings.share * longest_step(mesh)

    def limits(self) -> dict[str, float]:
        """Largest steps [s] by what limits them."""
        return {"cloth stiffness": self.stable * MOST_SUBSTEPS}

    def limiting_term(self, term: str) -> tuple[str, str]:
        """What one of `limits` comes from, and what would help."""
        remedy = "use cloth.integrator: implicit_euler, a lower stiffness, or a larger spacing"
        return f"the stiffness of the cloth (explicit steps of {self.stable:.2g} s)", remedy

    def substeps(self, dt: float) -> int:
        return max(1, math.ceil(dt / self.stable))

    def run(self, dt: float, number: int) -> None:
        """Take so many small steps of dt [s], however unstable."""
        mesh, contacts = self.mesh, self.collisions
        alone = self.alone
        for step in range(1 if alone else number):
            symplectic_euler_sums.step(
                alone,
                mesh.air.present,
                number,
                number - step,
                contacts.count,
                self.sweeps,
                dt,
                self.recovery(number),
                mesh.model,
                self._elements,
                contacts.projected,
                self.motion,
            )
            if not alone:
                self.project_contacts(dt, number, number - step)

    @property
    def bytes(self) -> int:
        return super().bytes + 8 * (3 * self.mesh.springs + 13 * self.mesh.hinges)


def longest_step(mesh: Elastic) -> float:
    """The longest stable step [s]; infinite without stiffness or free points."""
    if mesh.shell is not None:
        stiffness, damping = mesh.shell.row_sums()
    else:
        stiffness = _row_sums(mesh, mesh.stiffness, mesh.rigidity)
        damping = _row_sums(mesh, mesh.damping, mesh.bend_damping)
    free = ~mesh.held & (stiffness > 0)
    if not free.any():
        return math.inf
    frequency = float(np.sqrt((stiffness / mesh.mass)[free]).max())
    # The damping ratio of a mode of that frequency.
    ratio = float((damping / mesh.mass)[free].max()) / (2 * frequency)
    return 2 / frequency * (math.sqrt(1 + ratio**2) - ratio)


def _row_sums(mesh: Elastic, along: np.ndarray, bending: np.ndarray) -> np.ndarray:
    """Sums of the rows of the matrix of springs and hinges, by magnitude, shape [points]."""
    rows = np.bincount(mesh.ends.ravel(), weights=np.repeat(2 * along, 2), minlength=mesh.count)
    if mesh.hinges:
        _, slopes = fold(*(mesh.placed[mesh.corners[:, k]] for k in range(4)))
        lengths = np.linalg.norm(np.stack(slopes), axis=2) / mesh.shrinking
        weights = bending * lengths * lengths.sum(axis=0)
        rows += np.bincount(mesh.corners.T.ravel(), weights=weights.ravel(), minlength=mesh.count)
    return rows
