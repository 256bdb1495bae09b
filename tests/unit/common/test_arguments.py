"""Numbers and frames on command lines are what they may be, or refused by name."""

from __future__ import annotations

import argparse
import subprocess
import sys

import pytest

from common.arguments import not_negative, positive, rate


@pytest.mark.parametrize(("kind", "text", "value"), [(int, "3", 3), (float, "0.5", 0.5), (float, "2", 2.0)])
def test_a_number_is_taken(kind, text, value):
    assert positive(kind)(text) == not_negative(kind)(text) == value


@pytest.mark.parametrize("text", ["-3", "nan", "inf", "-inf", "three", "", "1e400"])
@pytest.mark.parametrize("kind", [int, float])
@pytest.mark.parametrize("among", [positive, not_negative])
def test_what_is_none_is_refused(among, kind, text):
    with pytest.raises(argparse.ArgumentTypeError, match=r"expected a .*number"):
        among(kind)(text)


def test_none_at_all_is_no_number_above_it():
    assert not_negative(int)("0") == 0
    with pytest.raises(argparse.ArgumentTypeError, match="whole number above 0, got 0"):
        positive(int)("0")


@pytest.mark.parametrize(
    "command",
    [
        "sim run scenes/tiny/splash.yaml --out out --threads 0",
        "sim run scenes/tiny/splash.yaml --out out --threads -3",
        "sim live scenes/tiny/splash.yaml --threads -3",
        "sim live scenes/tiny/splash.yaml --history nan",
        "workflow.reconstruct --spec {} --simulation . --frames 0:1 --out out --threads -1",
        "workflow.foam --spec {} --simulation . --frames 0:1 --out out --threads -1",
        "workflow.study.trial --stage simulate --out out --limit nan -- true",
        "render --spec {} --simulation . --frames 0:1 --out out --fps nan",
        "sim run scenes/tiny/splash.yaml --out out --frames 3:1",
        "render --spec {} --simulation . --out out --frames 3",
        "workflow.reconstruct --spec {} --simulation . --out out --frames a:b",
    ],
)
def test_commands_name_the_option(command, tmp_path):
    """Some ran with all processors, others ended with a traceback."""
    module, *options = command.replace(" out", f" {tmp_path}/out").split()
    done = subprocess.run([sys.executable, "-m", module, *options], capture_output=True, text=True, timeout=60)
    wrong = options[-2] if "--limit" not in options else "--limit"
    assert done.returncode == 2 and f"argument {wrong}: expected" in done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("text", "value"), [("24", 24), ("23.976", 23.976), ("24000/1001", 24000 / 1001), ("1e-3", 1e-3)]
)
def test_a_rate_may_be_a_ratio(text, value):
    assert rate(text) == value


@pytest.mark.parametrize("text", ["0", "-24", "24000/0", "fast", "nan", "1/-2", "1e999", ""])
def test_what_is_no_rate_is_refused(text):
    with pytest.raises(argparse.ArgumentTypeError, match="above 0, or a ratio such as 24000/1001"):
        rate(text)
