"""The index of terms in docs/architecture.md leads to where they are."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROW = re.compile(r"^\| ([^|]+) \| `([\w/.]+\.py)` \| `([^`]+)` \|$", re.MULTILINE)


def test_every_term_is_where_the_index_says():
    rows = ROW.findall((ROOT / "docs" / "architecture.md").read_text())
    assert len(rows) >= 30
    assert [term for term, _, _ in rows] == sorted((term for term, _, _ in rows), key=str.lower)
    for term, file, symbol in rows:
        assert symbol in (ROOT / file).read_text(), f"{term}: no {symbol} in {file}"
