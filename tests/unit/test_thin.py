"""`pytest --thin N` leaves no test out, and of the cases of each one in N."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
CASES = """
import pytest

@pytest.mark.parametrize("case", range(5))
def test_many(case):
    pass

@pytest.mark.slow
@pytest.mark.parametrize("case", range(4))
def test_slow(case):
    pass

def test_single():
    pass
"""


@pytest.mark.parametrize(
    ("options", "chosen"),
    [
        (["--thin", "2"], ["many[0]", "many[2]", "many[4]", "single"]),
        (["--thin", "3", "-m", "slow"], ["slow[0]", "slow[3]"]),
    ],
)
def test_which_cases_run(tmp_path, options, chosen):
    (tmp_path / "conftest.py").write_text("from tests.conftest import *\n")
    (tmp_path / "test_cases.py").write_text(CASES)
    words = [sys.executable, "-m", "pytest", "--collect-only", "-q", "-c", str(ROOT / "pyproject.toml"), str(tmp_path)]
    done = subprocess.run([*words, *options], cwd=ROOT, capture_output=True, text=True)
    found = [line.rpartition("::test_")[2] for line in done.stdout.splitlines() if "::" in line]
    assert found == chosen, done.stdout + done.stderr


def test_none_of_them_is_refused():
    done = subprocess.run([sys.executable, "-m", "pytest", "--thin", "0"], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == pytest.ExitCode.USAGE_ERROR and "must be at least 1" in done.stderr
