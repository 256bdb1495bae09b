"""What happened in the simulation, as curves over time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from workflow.stages.film.tables import numbers


@dataclass(frozen=True)
class Panel:
    """Curves that share an axis: column of steps.csv, and its name in the legend."""

    label: str
    curves: tuple[tuple[str, str], ...]
    scale: float = 1.0


PANELS = (
    Panel("energy [J]", (("kinetic_energy", "kinetic"), ("potential_energy", "potential"))),
    Panel("time step [ms]", (("dt", "time step"),), scale=1e3),
    Panel("density error [%]", (("density_error_avg", "mean"), ("density_error_max", "largest")), scale=100.0),
    Panel("iterations a step", (("pressure_iterations", "pressure"), ("divergence_iterations", "divergence"))),
    Panel("greatest speed [m/s]", (("v_max", "greatest speed"),)),
    Panel("fluid particles", (("n_fluid", "particles"),)),
    Panel("contacts", (("contacts", "contacts"),)),
)
COLORS = ("#1f77b4", "#d9822b")
WIDTH, PANEL_HEIGHT = 10.0, 1.7
"""[inch]"""


def plot(steps: Path, image: Path, *, title: str, volume: tuple[Sequence[float], Sequence[float]] = ((), ())) -> bool:
    """Draw the columns that steps.csv has to a PNG file; False where there is nothing to draw.

    `volume`: times [s], and the volume inside of the surface [m^3] then.
    """
    wanted = [column for panel in PANELS for column, _ in panel.curves]
    table = numbers(steps, ("time", *wanted))
    times = table.pop("time", [])
    panels = [panel for panel in PANELS if any(column in table for column, _ in panel.curves)]
    count = len(panels) + bool(volume[0])
    if not times or not count:
        return False
    figure = Figure(figsize=(WIDTH, PANEL_HEIGHT * count + 0.6), layout="constrained")
    figure.suptitle(title, x=0.01, ha="left", parse_math=False)
    axes = figure.subplots(count, sharex=True, squeeze=False)[:, 0]
    for ax, panel in zip(axes, panels, strict=False):
        present = [(column, name) for column, name in panel.curves if column in table]
        for (column, name), color in zip(present, COLORS, strict=False):
            ax.plot(times, [panel.scale * value for value in table[column]], color=color, lw=1.2, label=name)
        ax.set_ylabel(panel.label)
        if len(present) > 1:
            ax.legend(frameon=False, loc="upper right", fontsize="small", ncols=len(present))
    if volume[0]:
        axes[-1].plot(*volume, color=COLORS[0], lw=1.2, marker=".", ms=3)
        axes[-1].set_ylabel("volume inside [m³]")
    for ax in axes:
        ax.spines[["top", "right"]].set_visible(False)
        ax.grid(color="#e4e7eb", lw=0.6)
        ax.margins(x=0.01)
    axes[-1].set_xlabel("time [s]")
    figure.align_ylabels(axes)
    figure.savefig(image, format="png", dpi=110, metadata={"Software": None})
    return True
