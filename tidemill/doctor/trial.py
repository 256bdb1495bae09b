"""Commands that are tried, each in a process that may crash or hang."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

LONGEST = 120.0
"""[s]"""


@dataclass(frozen=True)
class Trial:
    """How a command ended: the reason why it failed, empty where it did not; what it printed; its time [s]."""

    reason: str
    printed: str
    seconds: float


def attempt(words: Sequence[str | Path], folder: Path | None = None) -> Trial:
    """Run Python with these arguments, in a folder or where the doctor was called."""
    start = time.perf_counter()
    try:
        done = subprocess.run(
            [sys.executable, *map(str, words)], cwd=folder, capture_output=True, text=True, timeout=LONGEST, check=False
        )
    except subprocess.TimeoutExpired:
        return Trial(f"nothing came of it within {LONGEST:g} s", "", LONGEST)
    except OSError as error:
        return Trial(f"{error.filename}: {error.strerror}", "", 0.0)
    return Trial(_reason(done), done.stdout, time.perf_counter() - start)


def _reason(done: subprocess.CompletedProcess[str]) -> str:
    if done.returncode == 0:
        return ""
    if done.returncode < 0:
        return f"it crashed ({signal.Signals(-done.returncode).name})"
    lines = [line for line in done.stderr.splitlines() if line.strip()]
    return lines[-1].strip() if lines else f"it ended with exit code {done.returncode}"
