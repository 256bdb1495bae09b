"""What a run counts as it steps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass
class Counts:
    """What was added, removed or repeated, for the summary."""

    particles_started: int = 0
    particles_without_room: int = 0
    particles_removed_by_events: int = 0
    particles_emitted: int = 0
    particles_drained: int = 0
    particles_fallen: int = 0
    """Particles that have fallen so far below everything in the scene that they are out of it."""
    particles_blocked: int = 0
    """Particles that emitters would have sent into what was in the way."""
    particles_held_off: int = 0
    """Times that a particle was brought back to its side of a thin solid, or it would have passed through."""
    particles_over_limit: int = 0
    """Particles that emitters would have sent while there were as many as fluid.max_particles allows."""
    retries: int = 0
    steps_repeated: int = 0
    steps_capped: int = 0
    """Steps in which one of the two below happened."""
    pressure_capped: int = 0
    """Steps in which a pressure solver stopped at its cap of iterations, with a larger error than asked for."""
    viscosity_capped: int = 0
    """Steps in which the solver of implicit viscosity did."""
    contacts_capped: int = 0
    """Steps in which the sweeps over contacts of rigid bodies did."""
    cloth_capped: int = 0
    """Steps in which Newton's method or conjugate gradients of cloth ended at a cap."""
    cloth_held_back: int = 0
    """Times that a point of cloth could not go all its way in a step, or it would have passed through something."""

    def add_step(self, stats: Mapping[str, float]) -> None:
        """Count what the solvers tell of one step: what ended at a cap, and what was held off or back."""
        capped, viscosity_capped = stats.get("capped", 0), stats.get("viscosity_capped", 0)
        self.steps_capped += int(capped > 0)
        self.pressure_capped += int(capped > viscosity_capped)
        self.viscosity_capped += int(viscosity_capped > 0)
        self.particles_held_off += int(stats.get("held_off", 0))
        self.contacts_capped += int(stats.get("contacts_capped", 0) > 0)
        self.cloth_capped += int(stats.get("cloth_capped", 0) > 0)
        self.cloth_held_back += int(stats.get("cloth_held_back", 0))
