"""Kinds of numbers and of frames that commands take, for `type=` of argparse."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from fractions import Fraction
from typing import TypeVar

from common.frames import Frames

N = TypeVar("N", int, float)


def positive(kind: type[N]) -> Callable[[str], N]:
    """Numbers above 0."""
    return lambda text: _bounded(kind, text, lambda value: value > 0, "above 0")


def not_negative(kind: type[N]) -> Callable[[str], N]:
    """Numbers from 0 on."""
    return lambda text: _bounded(kind, text, lambda value: value >= 0, "of at least 0")


def rate(text: str) -> float:
    """Numbers above 0, and ratios of whole ones, as 24000/1001."""
    try:
        number = repr(float(Fraction(text)))
    except (ValueError, ZeroDivisionError, OverflowError):
        number = text
    return _bounded(float, number, lambda value: value > 0, "above 0, or a ratio such as 24000/1001")


def frame_range(text: str) -> Frames:
    """The value of an option --frames A:B."""
    try:
        return Frames.parse(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _bounded(kind: type[N], text: str, allowed: Callable[[N], bool], which: str) -> N:
    wanted = f"expected a {'whole ' if kind is int else ''}number {which}, got {text}"
    try:
        value = kind(text)
    except ValueError:
        raise argparse.ArgumentTypeError(wanted) from None
    if not math.isfinite(value) or not allowed(value):
        raise argparse.ArgumentTypeError(wanted)
    return value
