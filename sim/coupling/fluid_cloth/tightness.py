"""No particle goes through cloth: the ways of both in a step are looked at (Li et al. 2021, ACCD), and a particle that
would come too near is kept on its side, and takes part in the motion of the cloth there.
"""

from __future__ import annotations

import numpy as np

from sim.cloth.contact.detection.surfaces import Tree
from sim.cloth.fabric.arrays import integers, numbers, vectors
from sim.cloth.model import ClothModel
from sim.coupling.fluid_cloth import tightness_sums
from sim.device.double import vec3
from sim.fluid.system import FluidSystem

GAP = 0.1
"""Of a particle from the cloth, in spacings of particles: pressure keeps them half a spacing apart."""


class Tightness:
    """Keeps the particles of a system on their side of the cloth; `origin` of the system's coordinates [m]."""

    def __init__(self, cloth: ClothModel, system: FluidSystem, origin: np.ndarray):
        self.cloth, self.system = cloth, system
        self._origin = vec3(*origin)
        self._gap = GAP * system.spec.spacing
        mesh = cloth.mesh
        self._tree = Tree(mesh.triangles, mesh.points.position.to_numpy())
        self._thick = numbers(np.full(mesh.total, self._gap))
        self._hits = tightness_sums.Hits(integers(np.zeros(1)), vectors(np.zeros((1, 3))))
        self.held_off = 0
        """Particles that were kept on their side in the last step."""
        self.through = 0
        """Particles for which there was no place in the last step."""

    def keep(self, dt: float) -> None:
        """Keep particles that have gone dt [s] with their velocities on their side of the cloth, which has gone from
        the start to the end of its step."""
        system, mesh = self.system, self.cloth.mesh
        if system.count > self._hits.struck.shape[0]:
            room = system.particles.capacity
            self._hits = tightness_sums.Hits(integers(np.zeros(room)), vectors(np.zeros((room, 3))))
        start, place = self.cloth.integrator.trial.start, mesh.points.position
        self._tree.enclose(self._thick, start, place)
        found = tightness_sums.keep(
            system.count,
            dt,
            self._gap,
            self._origin,
            self._tree.tree,
            start,
            place,
            system.particles.position,
            system.particles.velocity,
            self._hits,
        )
        self.held_off, self.through = int(found[0]), int(found[1])
        if self.held_off:
            self._share_momentum()

    def _share_momentum(self) -> None:
        """Let particles that were held off and the cloth there part no faster than they come together: one after the
        other, as often as it takes."""
        system, mesh = self.system, self.cloth.mesh
        triangles = self._hits.struck.to_numpy()[: system.count]
        rows = np.flatnonzero(triangles >= 0)
        weights = self._hits.weight.to_numpy()[rows]
        members = self._tree.member.to_numpy().reshape(-1, 3)[triangles[rows]]
        place = mesh.points.position.to_numpy()
        speed = mesh.points.velocity.to_numpy()
        velocity = system.particles.velocity.to_numpy()
        moving = velocity[rows, :3].astype(np.float64)
        position = system.particles.position.to_numpy()[rows, :3] + np.array(self._origin)
        layer_mass_ratio = np.where(mesh.held, 0.0, 1.0 / mesh.mass)
        for row, (corners, weight) in enumerate(zip(members, weights, strict=True)):
            apart = position[row] - weight @ place[corners]
            normal = apart / max(float(np.linalg.norm(apart)), 1e-30)
            closing = float(normal @ (moving[row] - weight @ speed[corners]))
            if closing >= 0:
                continue
            given = weight * layer_mass_ratio[corners]
            impulse = -closing / (1.0 / system.mass + float(weight @ given))
            moving[row] += impulse / system.mass * normal
            speed[corners] -= np.outer(given, impulse * normal)
        velocity[rows, :3] = moving
        system.particles.velocity.from_numpy(velocity)
        mesh.points.velocity.from_numpy(speed)
