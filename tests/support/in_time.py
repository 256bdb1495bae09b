"""Cases for which there is only time in the slow tests."""

from __future__ import annotations

from typing import Any

import pytest


def in_time(*cases: Any) -> list:
    """Cases of `parametrize`, each a value or a tuple of values, that run with `pytest -m slow`."""
    return [pytest.param(*(case if isinstance(case, tuple) else (case,)), marks=pytest.mark.slow) for case in cases]
