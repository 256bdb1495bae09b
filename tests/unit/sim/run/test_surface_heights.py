"""Heights at which the surface is looked for."""

from __future__ import annotations

import numpy as np

from sim.run.probes.water_height import heights_from_top

H = 0.04


def test_a_column_is_searched_from_top_to_bottom():
    heights = heights_from_top(np.arange(0.01, 0.3, 0.02), H)
    np.testing.assert_allclose(np.diff(heights), -H / 16)
    assert heights[0] > 0.29 + H
    assert heights[-1] < 0.01 - H


def test_a_drop_far_above_costs_nothing():
    heights = heights_from_top(np.array([0.0, 0.01, 1e6]), H)
    assert len(heights) < 200
    for particle in (0.0, 1e6):
        assert np.count_nonzero(np.abs(heights - particle) < H) >= 31
