"""An earlier version of this project, beside the present one."""

from __future__ import annotations

import statistics
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).parents[2]


@contextmanager
def earlier(revision: str) -> Iterator[Path]:
    """A folder with the sources of this revision of git, which goes at the end."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "before"
        subprocess.run(["git", "worktree", "add", "--quiet", "--detach", folder, revision], cwd=ROOT, check=True)
        try:
            yield folder
        finally:
            subprocess.run(["git", "worktree", "remove", "--force", folder], cwd=ROOT, check=True)


def change(old: Sequence[float], new: Sequence[float], unit: str) -> str:
    """Medians of what both measured in the same turns, their ratio, and the range of the ratios of turns."""
    ratios = sorted(b / a for a, b in zip(old, new, strict=True))
    before, after = statistics.median(old), statistics.median(new)
    return f"  {before:,.4g} -> {after:,.4g} {unit}: {after / before:.2f} times ({ratios[0]:.2f} to {ratios[-1]:.2f})"
