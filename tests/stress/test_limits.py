"""Defaults stay away from where settings break, and theory says where that is: `python -m tests.stress.limits`."""

from __future__ import annotations

import pytest

from tests.stress.limits import PRECISION, limits


@pytest.mark.slow
def test_explicit_cloth_breaks_where_its_highest_frequency_says():
    """Its default is at most half of that."""
    limit = limits()["symplectic"]
    found, nothing_broke = limit.find()
    assert not nothing_broke
    assert limit.theory / PRECISION <= found <= limit.theory * PRECISION
    assert limit.room(found) * PRECISION >= 2
