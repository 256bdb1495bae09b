"""Strategies that break data and bytes at one place or more."""

from __future__ import annotations

import copy
import os
from collections.abc import Callable
from typing import Any

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

FACTOR = int(os.environ.get("FUZZ", "1"))

VALUES = st.sampled_from(
    [
        *(None, True, False, 0, -1, 1, 3, 1e-30, 1e30, -1e300, 10**400, float("nan"), float("inf")),
        *("", "x", "ball", "10 mm", "3 s", "1e999 m", "box", "mesh", "../x", "\0", "é" * 300, "<<", "#ffffff"),
        *([], [0], [0, 0, 0], [[1], 2, {}], {}, {"type": "box"}, {"type": "mesh", "file": "x"}, {"": 1}),
    ]
) | st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=20),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=4,
)


def fuzzed(examples: int) -> Callable[[Any], Any]:
    """Settings of a test that tries so many; what it finds is not kept, so that every run tries others."""
    return settings(
        max_examples=examples * FACTOR,
        deadline=None,
        database=None,
        print_blob=True,
        suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow, HealthCheck.data_too_large],
    )


def _places(group: Any) -> list[tuple[Any, Any]]:
    """Every value below a group: its container and its key there."""
    found = []
    for key in list(group) if isinstance(group, dict) else range(len(group)):
        found.append((group, key))
        if isinstance(group[key], dict | list):
            found += _places(group[key])
    return found


@st.composite
def broken(draw: Any, original: Any, most: int = 3) -> Any:
    """The data with up to so many values replaced, removed, renamed, repeated or nested."""
    data = copy.deepcopy(original)
    for _ in range(draw(st.integers(1, most))):
        places = _places(data)
        if not places:
            break
        group, key = draw(st.sampled_from(places))
        match draw(st.sampled_from(["replace", "replace", "remove", "rename", "nest", "repeat"])):
            case "remove":
                del group[key]
            case "rename" if isinstance(group, dict):
                names = st.sampled_from(["", "type", "bodies", "at", "0", "set", f"{key}x"]) | st.text(max_size=8)
                group[draw(names)] = group.pop(key)
            case "nest":
                group[key] = [group[key]]
            case "repeat":
                other, there = draw(st.sampled_from(places))
                group[key] = copy.deepcopy(other[there]) if _has(other, there) else None
            case _:
                group[key] = copy.deepcopy(draw(VALUES))
    return data


def _has(group: Any, key: Any) -> bool:
    return key in group if isinstance(group, dict) else key < len(group)


@st.composite
def broken_bytes(draw: Any, original: bytes, pieces: tuple[bytes, ...] = ()) -> bytes:
    """The bytes with some replaced, cut out, put in, or cut off at the end."""
    content = original
    some = st.binary(max_size=8)
    if pieces:
        some |= st.sampled_from(pieces)
    for _ in range(draw(st.integers(1, 4))):
        start = draw(st.integers(0, max(len(content) - 1, 0)))
        length = draw(st.sampled_from([0, 1, 2, 4, 40]) | st.just(len(content)))
        content = content[:start] + draw(some) + content[start + length :]
    return content
