"""The report of the extremes: `pytest tests/stress --extremes extremes.md` writes the outcome of each."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

GROUPS = {
    "cloth": "Cloth",
    "wet_cloth": "Coupling",
    "floating": "Coupling",
    "leaks": "Coupling",
    "rigid": "Rigid bodies",
    "full_disks": "Files",
    "resume": "Files",
    "stops": "Files",
    "rigid_meshes": "Geometry",
    "cloth_tangled": "Geometry",
}
"""By how the name of the file begins; the longest counts. All others are of fluids."""
MEANING = "A: right within the bound of its test. B: refused before the first step, exit 2. C: stopped, exit 3, with \
the last good state kept."

_found: dict[str, tuple[str, str, float]] = {}


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--extremes", metavar="FILE", help="write the outcomes of the extremes, as Markdown")


def pytest_runtest_setup(item: pytest.Item) -> None:
    mark = item.get_closest_marker("outcome")
    if mark is not None:
        item.user_properties.append(("outcome", mark.args[0]))


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    outcome = dict(report.user_properties).get("outcome")
    if outcome is None or (report.when != "call" and report.passed):
        return
    _found[report.nodeid] = outcome, "failed" if report.failed else report.outcome, report.duration


def pytest_terminal_summary(config: pytest.Config) -> None:
    path = config.getoption("--extremes", default=None)
    if path and not hasattr(config, "workerinput"):
        Path(path).write_text(_written(), encoding="utf-8")


def _written() -> str:
    groups: dict[str, list[str]] = {}
    for node, (outcome, result, seconds) in sorted(_found.items()):
        file, _, name = node.partition("::")
        came_to = {"passed": outcome, "skipped": "expected failure"}.get(result, f"**{result}**")
        case = name.removeprefix("test_").replace("_", " ", name.partition("[")[0].count("_")).replace("|", "\\|")
        groups.setdefault(_group(file), []).append(f"| {case} | {outcome} | {came_to} | {seconds:.1f} |")
    count = Counter(outcome if result == "passed" else "other" for outcome, result, _ in _found.values())
    parts = [
        f"# Extremes\n\n{MEANING}\n\n{len(_found)} cases: {', '.join(f'{n} {k}' for k, n in sorted(count.items()))}.\n"
    ]
    for group, rows in sorted(groups.items()):
        head = "| case | expected | actual | seconds |\n| --- | --- | --- | --- |"
        parts.append(f"## {group} ({len(rows)})\n\n{head}\n" + "\n".join(rows) + "\n")
    return "\n".join(parts)


def _group(file: str) -> str:
    name = Path(file).stem.removeprefix("test_")
    known = [key for key in GROUPS if name.startswith(key)]
    return GROUPS[max(known, key=len)] if known else "Fluids"
