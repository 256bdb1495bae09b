"""Velocity Verlet (Swope et al. 1982) without contacts; and symplectic Euler by another name."""

from sim.cloth.contact.applied_forces import pulls
from sim.cloth.integrators.symplectic_euler import SymplecticEuler


class Same(SymplecticEuler):
    pass


class Verlet:
    STATISTICS = ("cloth_substeps",)
    past = None
    bytes = 0

    def __init__(self, mesh, gravity, settings, collisions):
        self.mesh = mesh
        self.gravity = gravity
        self.settings = settings.integrator_settings

    def limits(self):
        return {"patience": self.settings.longest}

    def limiting_term(self, term):
        return f"the {term} of this integrator", "raise cloth.extra.verlet.longest"

    def advance(self, dt):
        points, number = self.mesh.points, self.settings.substeps
        position, velocity = points.position.to_numpy(), points.velocity.to_numpy()
        for _ in range(number):
            velocity += 0.5 * dt / number * self.acceleration()
            position += dt / number * velocity
            points.position.from_numpy(position)
            velocity += 0.5 * dt / number * self.acceleration()
        points.velocity.from_numpy(velocity)
        return {"cloth_substeps": number}

    def acceleration(self):
        return self.gravity + pulls(self.mesh) / self.mesh.mass[:, None]
