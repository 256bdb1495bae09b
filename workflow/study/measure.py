"""A quantity of a trial, and how far it is from its reference."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from scene.settings import Refused
from workflow.study import formula, pictures, surfaces
from workflow.study.spec import ByFormula, ByTable, Formula, Quantity

Curve = tuple[np.ndarray, np.ndarray]
"""Times [s] and values."""


@dataclass(frozen=True)
class Truth:
    """What a quantity should be: a number, or values at times [s]; the error is told in shares of `scale`."""

    values: np.ndarray
    scale: float
    times: np.ndarray | None = None


def series(quantity: Quantity, folder: Path) -> Curve:
    """All values of the quantity that the tables in a folder hold, in the order of time; raises Refused."""
    path = folder / f"{quantity.table}.csv"
    if not path.is_file():
        raise Refused(f"there is no {path.name}", location=("quantity", "table"), remedy="let the scene write it")
    times, values = [], []
    with path.open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            value = _value(quantity, row)
            time = float(row["time"])
            if value is not None and quantity.after <= time <= (quantity.until or math.inf) * (1 + 1e-9):
                times.append(time)
                values.append(value)
    if not values:
        raise Refused(
            f"{path.name} has no value of {quantity.of or 'steps'}.{quantity.column} at these times",
            location=("quantity",),
            remedy="name a probe or body of the scene and what it measures, and times within its duration",
        )
    return np.array(times), np.array(values)


def _value(quantity: Quantity, row: dict[str, str]) -> float | None:
    match quantity.table:
        case "probes":
            wanted = row["probe"] == quantity.of and row["quantity"] == quantity.column
            return float(row["value"]) if wanted else None
        case "bodies":
            return float(row[quantity.column]) if row["body"] == quantity.of and quantity.column in row else None
    return float(row[quantity.column]) if row.get(quantity.column) else None


def taken(quantity: Quantity, curve: Curve) -> float:
    """The one number that is taken from a curve; raises Refused."""
    times, values = curve
    match quantity.take:
        case "last":
            return float(values[-1])
        case "mean":
            return float(values.mean())
        case "maximum":
            return float(values.max())
        case "minimum":
            return float(values.min())
        case "change":
            return float(np.abs(values - values[0]).max())
        case "period":
            return period(times, values)
    raise ValueError(quantity.take)


def period(times: np.ndarray, values: np.ndarray) -> float:
    """Period [s] without damping of the decaying oscillation that is nearest by least squares; raises Refused."""
    from scipy.optimize import curve_fit

    even = np.linspace(times[0], times[-1], 4 * len(times))
    swing = np.interp(even, times, values)
    power = np.abs(np.fft.rfft(swing - swing.mean(), 8 * len(even)))
    start = 2 * np.pi * np.fft.rfftfreq(8 * len(even), even[1] - even[0])[max(1, int(power.argmax()))]

    def model(t, mean, cosine, sine, omega, decay):
        return mean + np.exp(-decay * (t - times[0])) * (cosine * np.cos(omega * t) + sine * np.sin(omega * t))

    spread = float(np.ptp(values)) / 2
    if not spread:
        raise Refused("nothing swings", location=("quantity", "take"), remedy="take another quantity")
    try:
        found, _ = curve_fit(model, times, values, p0=(values.mean(), spread, spread, start, 0.1))
    except (RuntimeError, TypeError) as error:
        raise Refused(f"no period is found: {error}", location=("quantity", "take")) from None
    if (times[-1] - times[0]) * abs(found[3]) < 2 * np.pi:
        raise Refused("this is less than one oscillation", location=("quantity", "take"), remedy="simulate longer")
    return float(2 * np.pi / np.hypot(found[3], found[4]))


def truth(reference: ByFormula | ByTable, quantity: Quantity, scale: Formula | None, folder: Path) -> Truth:
    """What a formula or a table says; `folder` is that of the study. Raises Refused."""
    try:
        names = formula.constants(reference.where)
        if isinstance(reference, ByTable):
            times, values = _read(folder / reference.file)
            times = times * formula.evaluate(reference.time_unit, names)
            values = values * formula.evaluate(reference.value_unit, names)
        elif quantity.take == "curve":
            if quantity.until is None:
                raise Refused("a formula over time needs an end", remedy="add until to the quantity")
            times = np.linspace(quantity.after, quantity.until, 201)
            values = np.array([formula.evaluate(reference.value, {**names, "t": float(t)}) for t in times])
        else:
            times, values = None, np.array([formula.evaluate(reference.value, names)])
        return Truth(values, _scale(scale, names, values), times)
    except Refused as refused:
        raise refused.at("reference") from None


def truth_of_trial(quantity: Quantity, scale: Formula | None, folder: Path) -> Truth:
    """What the most accurate trial found."""
    if quantity.table == "picture":
        return Truth(pictures.read(folder), 1.0 if scale is None else formula.evaluate(scale))
    if quantity.table != "surface" and quantity.take == "curve":
        times, values = series(quantity, folder)
    else:
        times, values = None, np.array([number(quantity, folder)])
    return Truth(values, _scale(scale, {}, values), times)


def number(quantity: Quantity, folder: Path) -> float:
    """What a trial found that is one number; raises Refused."""
    if quantity.table == "surface":
        return surfaces.measure(quantity, folder)
    return taken(quantity, series(quantity, folder))


def _scale(scale: Formula | None, names: dict[str, float], values: np.ndarray) -> float:
    size = float(np.abs(values).max()) if scale is None else formula.evaluate(scale, names)
    if not size > 0:
        raise Refused("an error relative to 0 has no meaning", remedy="add scale: what an error is divided by")
    return size


def _read(path: Path) -> Curve:
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise Refused(f"cannot be read: {error}", location=("file",), remedy="give a CSV file") from None
    rows = []
    for line in lines:
        try:
            rows.append([float(cell) for cell in line.split(",")[:2]])
        except ValueError:
            continue
    if len(rows) < 2 or any(len(row) < 2 for row in rows):
        raise Refused(f"{path} is no table of times and values", location=("file",), remedy="two columns of numbers")
    times, values = np.array(rows).T
    order = np.argsort(times)
    return times[order], values[order]


def error(quantity: Quantity, true: Truth, folder: Path) -> tuple[float | None, float]:
    """What a trial found (of a curve its last value, of a picture nothing), and the error: of a number the difference,
    of a curve or a picture the RMS of the differences, over the scale."""
    if quantity.table == "picture":
        return None, pictures.difference(pictures.read(folder), true.values) / true.scale
    if true.times is None:
        found = number(quantity, folder)
        return found, abs(found - float(true.values[0])) / true.scale
    times, values = series(quantity, folder)
    end = min(times[-1], quantity.until or math.inf) * (1 + 1e-9)
    kept = (true.times >= times[0] * (1 - 1e-9)) & (true.times <= end)
    if kept.sum() < 2:
        raise Refused("the simulation ends before its reference begins", location=("quantity",))
    read = np.interp(true.times[kept], times, values)
    return float(values[-1]), float(np.sqrt(np.mean((read - true.values[kept]) ** 2))) / true.scale
