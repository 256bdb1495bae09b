"""What is remembered of jobs that another attempt would not help: those refused or stopped for their settings."""

from __future__ import annotations

from pathlib import Path

MEANINGS = {
    2: "refused its settings",
    3: "stopped the simulation",
}
"""Exit codes with which a command would end each time."""


def _verdict_file(failed: Path) -> Path:
    return failed.with_name(f"{failed.name}.verdict")


def judge(failed: Path, plan: str, code: int) -> None:
    """Note for which plan a command ended in a way that another attempt would not change."""
    _verdict_file(failed).unlink(missing_ok=True)
    if code in MEANINGS:
        failed.parent.mkdir(parents=True, exist_ok=True)
        _verdict_file(failed).write_text(f"{code} {plan}\n")


def verdict(failed: Path, plan: str) -> int | None:
    """The exit code of an earlier attempt at the same, where it says that another would end the same way."""
    try:
        code, _, judged = _verdict_file(failed).read_text().strip().partition(" ")
    except OSError:
        return None
    return int(code) if judged == plan and code.isdecimal() and int(code) in MEANINGS else None
