"""The collapse of a column of water, by every pressure solver and as measured: a picture of front and height.

python -m tests.validation.plot_dam_break --across 20 --runs runs docs/images/dam_break.png

Runs that are in the folder `runs` already, as RUNS/SOLVER_ACROSS, are not simulated again.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import matplotlib

from tests.support.fluid.solvers import SOLVERS, run
from tests.validation.dam_break import FRONT_UNIT, HEIGHT_UNIT, LAST, Curves, curves, reference, scene

COLORS = {"wcsph": "#0072b2", "pcisph": "#e69f00", "iisph": "#009e73", "dfsph": "#cc3377"}
DASHES = {"wcsph": "-", "pcisph": "--", "iisph": "-", "dfsph": (0, (2, 1.5))}


def simulated(runs: Path, across: int) -> dict[str, Curves]:
    """The curves of every solver."""
    found = {}
    for solver in SOLVERS:
        out = runs / f"{solver}_{across}"
        if not (out / "summary.json").is_file():
            run(scene(solver, across), out, LAST)
        found[solver] = curves(out, across)
    return found


def draw(found: dict[str, Curves], path: Path) -> None:
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, (fronts, heights) = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained")
    for solver, curve in found.items():
        style = {"color": COLORS[solver], "linestyle": DASHES[solver], "linewidth": 1.6, "label": solver}
        shown = curve.times < 3.5 * FRONT_UNIT
        fronts.plot(curve.times[shown] / FRONT_UNIT, curve.front[shown], **style)
        heights.plot(curve.times / HEIGHT_UNIT, curve.height, **style)
    measured = {"linestyle": "", "color": "black", "markersize": 6}
    fronts.plot(*reference("front"), marker="o", label="Martin & Moyce 1952", **measured)
    fronts.plot(
        *reference("koshizuka_oka"), marker="s", markerfacecolor="white", label="Koshizuka & Oka 1996", **measured
    )
    heights.plot(*reference("height"), marker="o", label="Martin & Moyce 1952", **measured)
    fronts.set(xlabel=r"$T = t\sqrt{2g/a}$", ylabel=r"front $Z = x/a$", xlim=(0, 3.5), ylim=(0.9, 5))
    heights.set(xlabel=r"$\tau = t\sqrt{g/a}$", ylabel=r"height $H = y/2a$", xlim=(0, 3.55), ylim=(0, 1.05))
    for axes in (fronts, heights):
        axes.grid(color="#dddddd", linewidth=0.6)
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(frameon=False)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110, metadata={"Software": None})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("picture", type=Path)
    parser.add_argument("--across", type=int, default=20, help="particles across the column")
    parser.add_argument("--runs", type=Path, required=True, help="folder of the simulations")
    arguments = parser.parse_args()
    draw(simulated(arguments.runs, arguments.across), arguments.picture)


if __name__ == "__main__":
    main()
