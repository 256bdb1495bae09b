"""Means over time of what probes read: rows tell what happened between them, and not at one time only."""

from __future__ import annotations

from dataclasses import dataclass

from sim.run.probes.probe import Row


@dataclass
class Gathered:
    """Integrals over time of what one probe has read in every step.

    since: time of its last row [s]; until: of the last step; sums: of each quantity over the time between; impulse: of
    the force since the start [N s].
    """

    since: float
    until: float
    sums: tuple[float, ...] = ()
    impulse: tuple[float, ...] = ()

    def take(self, rows: list[Row], time: float, *, is_due: bool) -> list[Row]:
        """Add what was read at the end of a step; returns the means, with impulses of forces, where a row is due.

        A force is that of the step, and so is its product with the step the impulse.
        """
        step = time - self.until
        sums = self.sums or (0.0,) * len(rows)
        self.sums = tuple(total + step * value for total, (_, value, _) in zip(sums, rows, strict=True))
        forces = [(quantity, value) for quantity, value, unit in rows if unit == "N"]
        impulse = self.impulse or (0.0,) * len(forces)
        self.impulse = tuple(total + step * value for total, (_, value) in zip(impulse, forces, strict=True))
        self.until = time
        if not is_due:
            return []
        passed = time - self.since
        if passed > 0:
            means = zip(rows, self.sums, strict=True)
            rows = [(quantity, total / passed, unit) for (quantity, _, unit), total in means]
        self.since, self.sums = time, ()
        impulses = zip(forces, self.impulse, strict=True)
        return rows + [(name.replace("force", "impulse"), value, "N s") for (name, _), value in impulses]
