"""What docs say is where: the index of terms in docs/architecture.md, and files that pages name."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
ROW = re.compile(r"^\| ([^|]+) \| `([\w/.]+\.py)` \| `([^`]+)` \|$", re.MULTILINE)


def test_every_term_is_where_the_index_says():
    rows = ROW.findall((ROOT / "docs" / "architecture.md").read_text())
    assert len(rows) >= 30
    assert [term for term, _, _ in rows] == sorted((term for term, _, _ in rows), key=str.lower)
    for term, file, symbol in rows:
        assert symbol in (ROOT / file).read_text(), f"{term}: no {symbol} in {file}"


PATH = re.compile(r"(?<![\w/.])((?:common|scene|sim|workflow|render|live|tests)/[\w/]+\.py)\b")
EXAMPLES = {"CONTRIBUTING.md"}
"""Where files are named that somebody is to write."""


@pytest.mark.parametrize(
    "page", sorted(path.relative_to(ROOT).as_posix() for path in [*ROOT.glob("*.md"), *ROOT.glob("docs/*.md")])
)
def test_every_file_that_a_page_names_is_there(page):
    named = set(PATH.findall((ROOT / page).read_text()))
    missing = {name for name in named if not (ROOT / name).exists()}
    assert page in EXAMPLES or not missing
