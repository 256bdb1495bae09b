"""Arithmetic in study files."""

from __future__ import annotations

import ast
import math
import operator
import warnings
from collections.abc import Callable, Mapping
from typing import Any

from simpleeval import SimpleEval

from scene.settings import Refused
from workflow.study.spec import Formula

FUNCTIONS = {
    name: getattr(math, name)
    for name in (
        *("sqrt", "exp", "log", "sin", "cos", "tan", "asin", "acos", "atan", "atan2"),
        *("sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "radians", "degrees", "hypot", "cbrt"),
    )
} | {"abs": abs, "min": min, "max": max}


def _real(compute: Callable[..., float]) -> Callable[..., float]:
    """Computes with floats alone: integers and texts could grow until the memory is full."""

    def computed(*values: Any) -> float:
        if not all(isinstance(value, int | float) for value in values):
            raise TypeError("this computes with numbers only")
        return compute(*map(float, values))

    return computed


_SIGNS: dict[type[ast.AST], Callable[..., float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: math.pow,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
}
OPERATORS = {sign: _real(compute) for sign, compute in _SIGNS.items()}
GRAMMAR = (ast.Expr, ast.Constant, ast.Name, ast.Call, ast.UnaryOp, ast.BinOp)
"""What a formula is made of: formats of texts could fill the memory, too."""
LONGEST = 2000
"""Characters of a formula."""
CONSTANTS = {"pi": math.pi, "e": math.e}


def evaluate(formula: Formula, names: Mapping[str, float] | None = None) -> float:
    """Value of a formula; raises Refused."""
    if isinstance(formula, int | float):
        return float(formula)
    known = {**CONSTANTS, **(names or {})}
    if len(formula) > LONGEST:
        raise Refused(f"a formula of {len(formula):,} characters", remedy=f"give one of {LONGEST:,} at most")
    try:
        with warnings.catch_warnings():
            # Assignments and second expressions are left out with a warning.
            warnings.simplefilter("error")
            arithmetic = SimpleEval(operators=OPERATORS, functions=FUNCTIONS, names=known)
            arithmetic.nodes = {kind: arithmetic.nodes[kind] for kind in GRAMMAR}
            result = float(arithmetic.eval(formula))
    except Exception as error:  # a text may make the parser and the functions raise anything
        raise Refused(
            f"'{formula}' cannot be computed: {error}",
            remedy=f"use numbers, + - * / **, the names {', '.join(known)}, and {', '.join(FUNCTIONS)}",
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
