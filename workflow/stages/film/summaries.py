"""The summaries of all jobs of a film as one."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from workflow.stages.film.tables import numbers

ADDED_UP = frozenset({"steps"})
"""Counts of one segment alone; the others go on from segment to segment, so that the last value counts."""


def read(folder: Path) -> dict[str, Any]:
    """The summary.json of a folder; empty where there is none that can be read."""
    try:
        data = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return data if isinstance(data, dict) else {}


def merged(stages: Mapping[str, Sequence[Path]], steps: Path | None) -> dict[str, Any]:
    """Status, versions, counts, warnings and times of the folders of each stage; `steps`: the film's steps.csv."""
    found = {stage: [read(folder) for folder in folders] for stage, folders in stages.items()}
    everything = [summary for summaries in found.values() for summary in summaries]
    simulated = found.get("simulate", [])
    result: dict[str, Any] = {
        "status": _status(everything),
        "versions": _united(everything, "versions"),
        "counts": _counts(simulated),
        "simulated_s": sum(_number(summary.get("simulated_s")) for summary in simulated),
        "warnings": _warnings(everything),
        "wall_s": {stage: _wall(summaries) for stage, summaries in found.items() if summaries},
    }
    rate = _particle_steps_per_second(steps)
    if rate is not None:
        result["particle_steps_per_s"] = rate
    return result


def volumes(surfaces: Sequence[Path]) -> tuple[list[int], list[float]]:
    """Frames, and the volume that the surface encloses in each [m^3]."""
    rows = [row for folder in surfaces for row in read(folder).get("frames", []) if isinstance(row, dict)]
    return [int(row["frame"]) for row in rows], [float(row["volume"]) for row in rows]


def _status(summaries: Iterable[Mapping[str, Any]]) -> str:
    others = {str(summary.get("status", "unknown")) for summary in summaries} - {"done"}
    return ", ".join(sorted(others)) or "done"


def _united(summaries: Iterable[Mapping[str, Any]], key: str) -> dict[str, Any]:
    united: dict[str, Any] = {}
    for summary in summaries:
        united.update(summary.get(key) or {})
    return dict(sorted(united.items()))


def _counts(summaries: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    counts: dict[str, Any] = {}
    for summary in summaries:
        for name, value in (summary.get("counts") or {}).items():
            if isinstance(value, int | float) and not isinstance(value, bool):
                counts[name] = value + counts.get(name, 0) if name in ADDED_UP else value
    return counts


def _warnings(summaries: Iterable[Mapping[str, Any]]) -> list[str]:
    texts: dict[str, None] = {}
    for summary in summaries:
        warnings = summary.get("warnings")
        for text in warnings if isinstance(warnings, list) else []:
            texts[str(text)] = None
    return list(texts)


def _wall(summaries: Iterable[Mapping[str, Any]]) -> dict[str, float]:
    """Seconds by phase, added up over the jobs of a stage."""
    seconds: dict[str, float] = {}
    for summary in summaries:
        wall = summary.get("wall_s")
        for phase, value in wall.items() if isinstance(wall, dict) else ():
            seconds[phase] = seconds.get(phase, 0.0) + _number(value)
    return {phase: round(value, 3) for phase, value in seconds.items()}


def _particle_steps_per_second(steps: Path | None) -> float | None:
    table = numbers(steps, ("n_fluid", "wall_s")) if steps is not None else {}
    if len(table) < 2:
        return None
    pairs = [(n, s) for n, s in zip(table["n_fluid"], table["wall_s"], strict=True) if math.isfinite(n * s)]
    seconds = sum(s for _, s in pairs)
    return round(sum(n for n, _ in pairs) / seconds, 1) if seconds > 0 else None


def _number(value: Any) -> float:
    return float(value) if isinstance(value, int | float) and math.isfinite(value) else 0.0
