"""A study as a picture: error over cost, both in powers of ten."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from workflow.study.points import Point, front
from workflow.study.spec import Study

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#5a4636", "#999999")
"""Of Okabe & Ito 2008: told apart by the colour-blind, too."""
SHAPES = ("o", "s", "^", "D", "v", "P", "X", "*")
FAILED = "#d00000"
FEW_POWERS = 2.0
"""Of ten on an axis: with fewer, numbers between them are written, too."""
BETWEEN = (2, 3, 5)
SIZE = (9.5, 6.0)
"""[inch]"""


def draw(study: Study, points: Sequence[Point], name: str, folder: Path) -> None:
    """Write work_precision.png and work_precision.svg."""
    figure = Figure(figsize=SIZE, layout="constrained")
    ax = figure.subplots()
    color, shape = _legend_paths(study)
    colors, shapes = _assign(points, color, COLORS), _assign(points, shape, SHAPES)
    for point in points:
        if point.error is not None and point.cost is not None:
            _point(ax, point, colors[_key(point, color)], shapes[_key(point, shape)])
    best = front(points)
    costs, errors = [p.found[0] for p in best], [_shown(p.found[1]) for p in best]
    ax.plot(costs, errors, color="#333333", lw=1.4, alpha=0.7, zorder=1)
    ax.set(xscale="log", yscale="log")
    _failures(ax, points)
    for point in _labelled(best):
        text = ", ".join(_short(path, value) for path, value in point.chosen.items() if path not in (color, shape))
        if text:
            cost, error = point.found
            place: dict[str, Any] = {"xytext": (5, 5), "textcoords": "offset points"}
            ax.annotate(text, (cost, _shown(error)), fontsize=7, color="#555555", **place)
    _frame(figure, ax, study, name)
    handles = _handles(color, colors, "color") + _handles(shape, shapes, "marker")
    handles.append(Line2D([], [], color="#333333", lw=1.4, alpha=0.7, label="no other is cheaper and better"))
    if any(point.status != "done" for point in points):
        handles.append(Line2D([], [], color=FAILED, marker="x", ls="", label="failed, at its cost"))
    figure.legend(handles=handles, loc="outside right upper", frameon=False, fontsize="small")
    for kind in ("png", "svg"):
        metadata = {"Software": None} if kind == "png" else {"Date": None}
        figure.savefig(folder / f"work_precision.{kind}", format=kind, dpi=130, metadata=metadata)


def _legend_paths(study: Study) -> tuple[str | None, str | None]:
    """The settings that colours and shapes tell."""
    varied = [path for path in study.paths() if sum(len(grid.get(path, ())) for grid in study.grids) > 1]
    color = study.color or next((path for path in varied if path != study.shape), None)
    shape = study.shape or next((path for path in varied if path != color), None)
    return color, shape


def _key(point: Point, path: str | None) -> str:
    return str(point.chosen.get(path, "default")) if path else ""


def _assign(points: Sequence[Point], path: str | None, looks: Sequence[str]) -> dict[str, str]:
    keys = dict.fromkeys(_key(point, path) for point in points)
    return {key: looks[index % len(looks)] for index, key in enumerate(keys)}


def _shown(error: float) -> float:
    """In percent; an error of 0 has no place on a scale of powers."""
    return max(100 * error, 1e-12)


def _point(ax: Axes, point: Point, color: str, shape: str) -> None:
    x, error = point.found
    y, spread = _shown(error), [_shown(error) for error in point.errors]
    across = [[x - min(point.costs)], [max(point.costs) - x]]
    along = [[y - min(spread)], [max(spread) - y]]
    ax.errorbar([x], [y], xerr=across, yerr=along, color=color, marker=shape, ms=7, mec="white", mew=0.6, elinewidth=1)


def _failures(ax: Axes, points: Sequence[Point]) -> None:
    """Along the top, where no error is less."""
    costs = [point.cost for point in points if point.status != "done" and point.cost is not None]
    ax.plot(costs, [0.97] * len(costs), "x", color=FAILED, ms=8, mew=2, transform=ax.get_xaxis_transform(), zorder=5)


def _labelled(best: Sequence[Point], most: int = 8) -> list[Point]:
    """At most so many points of the front, evenly."""
    if len(best) <= most:
        return list(best)
    return [best[round(k * (len(best) - 1) / (most - 1))] for k in range(most)]


def _short(path: str, value: Any) -> str:
    return f"{path.rpartition('.')[2]} {value}"


def _frame(figure: Figure, ax: Axes, study: Study, name: str) -> None:
    figure.suptitle(f"{name}: {study.description}", x=0.01, ha="left", fontsize=10)
    ax.set_xlabel("wall seconds per simulated second" if study.stage == "simulate" else "wall seconds per frame")
    ax.set_ylabel(f"error of the {study.quantity.name} [%]")
    ax.spines[["top", "right"]].set_visible(False)
    ax.grid(color="#e4e7eb", lw=0.6, which="major")
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        low, high = axis.get_view_interval()
        few = low > 0 and math.log10(high / low) < FEW_POWERS
        axis.set_minor_locator(LogLocator(subs=BETWEEN if few else range(2, 10)))
        axis.set_minor_formatter(FuncFormatter(lambda value, _: f"{value:.3g}") if few else NullFormatter())
        axis.set_tick_params(which="minor", labelsize=7)


def _handles(path: str | None, looks: dict[str, str], kind: str) -> list[Line2D]:
    if path is None:
        return []
    title = Line2D([], [], ls="", label=path)
    base: dict[str, Any] = {"ls": "", "marker": "o", "color": "#666666", "ms": 7}
    return [title, *(Line2D([], [], **{**base, kind: look}, label=f"  {key}") for key, look in looks.items())]
