"""Names that a word may have been meant for."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def similar(word: str, known: Iterable[str], most: int = 1) -> list[str]:
    """At most this many of the `known` names that look like `word`, the closest first, whatever their case."""
    by_lower: dict[str, list[str]] = {}
    for name in sorted(known):
        by_lower.setdefault(name.lower(), []).append(name)
    # Where several are offered, more distant ones may be among them.
    close = difflib.get_close_matches(word.lower(), by_lower, n=most, cutoff=0.6 if most == 1 else 0.5)
    if most == 1:
        close = [name for name in close if _alike(word.lower(), name)]
    return [name for lower in close for name in by_lower[lower]][:most]


def _alike(word: str, name: str) -> bool:
    """Whether two words have more in common than `speed` and `shape`, or begin as `body` and `bodies` do."""
    return word[:2] == name[:2] or difflib.SequenceMatcher(None, word, name).ratio() > 0.6


def suggestion(word: str, known: Iterable[str]) -> str:
    """`did you mean ...?` or the list of what is known."""
    known = sorted(known)
    close = similar(word, known)
    return f"did you mean '{close[0]}'?" if close else f"known here: {', '.join(known)}"
