"""`pytest --rounding` perturbs by as much as it says, and perturbs all that it runs."""

from __future__ import annotations

import contextlib
import itertools
import subprocess
import sys
from pathlib import Path

import numpy as np

from tests import rounding
from tests.stress.scenes import POOL, run_segment
from tests.support import bodies, cloths
from tests.support.particles import positions, read_frame

ROOT = Path(__file__).resolve().parents[2]
SPACING = 2 * POOL["fluid"]["particle_radius"]
VARIANTS = """
from pathlib import Path

from tests import rounding as variants
from tests.conftest import *

variants.FOLDERS.append(Path(__file__).parent)
"""
SHARED = """
import pytest

@pytest.fixture(scope="module")
def made():
    from tests import rounding
    return rounding._variant

@pytest.mark.parametrize("case", [1, 2])
def test_shared(made, rounding, case):
    print(f"ran {case} of {made} in {rounding}")
"""


def under(variant: str | None):
    return rounding.perturbed(variant) if variant else contextlib.nullcontext()


def start_of_fluid(simulate, variant: str | None, name: str) -> np.ndarray:
    with under(variant):
        return positions(read_frame(simulate(POOL, 0, name), 0))


def test_fluid_starts_a_millionth_of_a_spacing_elsewhere(simulate):
    """Coordinates below 1/4 m are rounded by up to 2^-27 m in memory and once more in the file, in both runs."""
    exact = start_of_fluid(simulate, None, "exact")
    seen = [start_of_fluid(simulate, variant, variant) for variant in ("jitter1", "jitter2", "jitter3")]
    for number, places in enumerate(seen):
        way = np.abs(places - exact)
        assert way.mean() > 0.3e-6 * SPACING and way.max() < 1e-6 * SPACING + 4 * 2**-27
        assert np.abs(places - seen[number - 1]).mean() > 0.3e-6 * SPACING
    np.testing.assert_array_equal(start_of_fluid(simulate, "jitter1", "again"), seen[0])
    np.testing.assert_array_equal(start_of_fluid(simulate, None, "after"), exact)


def test_a_run_in_a_process_of_its_own_is_perturbed_too(tmp_path):
    for name, variant in (("exact", None), ("jitter", "jitter1")):
        with under(variant):
            assert run_segment(POOL, tmp_path / name, "0:0").returncode == 0
    places = [positions(read_frame(tmp_path / name, 0)) for name in ("exact", "jitter")]
    assert 0 < np.abs(places[1] - places[0]).max() < 2e-6 * SPACING


def test_cloth_and_bodies_begin_elsewhere_but_for_what_is_held():
    found = []
    for variant in (None, "jitter1", "jitter2"):
        with under(variant):
            cloth = cloths.part({"sheet": cloths.sheet((1.0, 1.0), pins=["corners"])})
            ball = bodies.part({"ball": bodies.ball(0.1, position=[0, 1, 0])})
            found.append((cloths.places(cloth), ball.position[:1].copy()))
    held = cloth.mesh.held[: len(found[0][0])].astype(bool)
    assert held.any() and not held.all()
    for (one, ball), (other, another) in itertools.pairwise(found):
        assert 0 < np.abs(one - other)[~held].max() < 2e-14 and not np.abs(one - other)[held].any()
        assert 0 < np.abs(ball - another).max() < 1e-14


def test_taichi_starts_without_fast_math_or_with_two_threads(taichi):
    from sim.device import runtime

    current_cfg = taichi.lang.impl.current_cfg

    def told(variant: str | None) -> tuple[bool, int]:
        with under(variant):
            runtime.start(threads=1, arch="cpu")
            return current_cfg().fast_math, current_cfg().cpu_max_num_threads

    wanted = {"exact-math": (False, 1), "two-threads": (True, 2), "jitter1": (True, 1), None: (True, 1)}
    assert {variant: told(variant) for variant in wanted} == wanted


def test_each_test_runs_under_each_variant_with_what_it_shares_made_anew(tmp_path):
    (tmp_path / "conftest.py").write_text(VARIANTS)
    (tmp_path / "test_shared.py").write_text(SHARED)
    told = run_pytest("-s", f"--rootdir={tmp_path}", "-c", ROOT / "pyproject.toml", tmp_path)
    wanted = [f"ran {case} of {variant} in {variant}" for variant in rounding.VARIANTS for case in (1, 2)]
    assert [line.lstrip(".") for line in told.splitlines() if "ran " in line] == wanted


def test_tests_that_simulate_nothing_are_left_out():
    told = run_pytest("--collect-only", "tests/unit/test_passing.py", "tests/verification/fluid/forces/test_xsph.py")
    assert "test_passing.py" not in told
    assert all(f"[{variant}" in told for variant in rounding.VARIANTS)


def run_pytest(*options: object) -> str:
    command = [sys.executable, "-m", "pytest", "--rounding", "-q", *map(str, options)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout
