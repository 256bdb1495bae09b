"""Arithmetic in study files."""

from __future__ import annotations

import math

import pytest

from scene.settings import Refused
from workflow.study.formula import constants, evaluate


def test_numbers_functions_and_names():
    assert evaluate(3) == 3.0
    assert evaluate("2 * pi / sqrt(g * k)", {"g": 9.81, "k": 4.0}) == pytest.approx(2 * math.pi / math.sqrt(39.24))
    assert constants({"a": 2, "b": "a**2", "c": "a + b"}) == {"a": 2, "b": 4, "c": 6}


@pytest.mark.parametrize(
    "text",
    [
        "unknown + 1",
        "1 +",
        "__import__('os').getcwd()",
        "().__class__",
        "9**9**9**9",
        "1 / 0",
        "sqrt(-1)",
        "'text'",
        "exp(1000)",
        "[1, 2]",
        "0 * 1e999",
        "a = 3",
        "1; 2",
    ],
)
def test_what_is_no_number_is_refused(text):
    with pytest.raises(Refused):
        evaluate(text)


def test_a_refusal_names_the_name():
    with pytest.raises(Refused) as refused:
        constants({"a": 1, "b": "c"})
    assert refused.value.location == ("where", "b")
