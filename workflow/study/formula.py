"""Arithmetic in study files."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping

from simpleeval import InvalidExpression, SimpleEval

from scene.settings import Refused
from workflow.study.spec import Formula

FUNCTIONS = {
    name: getattr(math, name)
    for name in (
        *("sqrt", "exp", "log", "sin", "cos", "tan", "asin", "acos", "atan", "atan2"),
        *("sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "radians", "degrees", "hypot", "cbrt"),
    )
} | {"abs": abs, "min": min, "max": max}
CONSTANTS = {"pi": math.pi, "e": math.e}


def evaluate(formula: Formula, names: Mapping[str, float] | None = None) -> float:
    """Value of a formula; raises Refused."""
    if isinstance(formula, int | float):
        return float(formula)
    try:
        with warnings.catch_warnings():
            # Assignments and second expressions are left out with a warning.
            warnings.simplefilter("error")
            value = SimpleEval(functions=FUNCTIONS, names={**CONSTANTS, **(names or {})}).eval(formula)
        result = float(value)
    except (Warning, InvalidExpression, SyntaxError, ArithmeticError, ValueError, TypeError, MemoryError) as error:
        known = ", ".join([*CONSTANTS, *(names or {})])
        raise Refused(
            f"'{formula}' cannot be computed: {error}",
            remedy=f"use numbers, + - * / **, the names {known}, and {', '.join(FUNCTIONS)}",
        ) from None
    if not math.isfinite(result):
        raise Refused(f"'{formula}' is {result}", remedy="mend the formula")
    return result


def constants(where: Mapping[str, Formula]) -> dict[str, float]:
    """Values of names, each defined by those before it; raises Refused."""
    values: dict[str, float] = {}
    for name, formula in where.items():
        try:
            values[name] = evaluate(formula, values)
        except Refused as refused:
            raise refused.at("where", name) from None
    return values
