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


PAGES = sorted(path.relative_to(ROOT).as_posix() for path in [*ROOT.glob("*.md"), *ROOT.glob("docs/*.md")])
PATH = re.compile(r"(?<![\w/.])((?:common|scene|sim|workflow|render|live|tests)/[\w/]+\.py)\b")
EXAMPLES = {"CONTRIBUTING.md"}
"""Where files are named that somebody is to write."""


@pytest.mark.parametrize("page", PAGES)
def test_every_file_that_a_page_names_is_there(page):
    named = set(PATH.findall((ROOT / page).read_text()))
    missing = {name for name in named if not (ROOT / name).exists()}
    assert page in EXAMPLES or not missing


CODE = re.compile(r"`([^`\n]+)`")
NAME = re.compile(r"\b(?:[A-Za-z]+_[A-Za-z_]+|[A-Z][a-z]+[A-Z]\w+)\b")
"""Of more than one word, so that what is no name of ours is left out."""
FOLDERS = ("common", "scene", "sim", "render", "workflow", "live", "tests", "scenes", "studies", "profiles")


@pytest.fixture(scope="module")
def written() -> set[str]:
    """Every word of the sources, tests and scenes, and the names of their files."""
    files = [path for folder in FOLDERS for path in (ROOT / folder).rglob("*") if path.is_file()]
    files += [path for path in ROOT.iterdir() if path.is_file() and path.suffix in ("", ".toml", ".sh")]
    text = (path.read_bytes().decode(errors="ignore") for path in files if path.suffix not in (".ply", ".npz", ".pyc"))
    return {word for one in text for word in re.findall(r"\w+", one)} | {path.stem for path in files}


@pytest.mark.parametrize("page", [page for page in PAGES if page not in EXAMPLES | {"CHANGELOG.md"}])
def test_every_name_that_a_page_calls_is_there(page, written):
    prose = re.sub(r"```.*?```", "", (ROOT / page).read_text(), flags=re.DOTALL)
    missing = {name for code in CODE.findall(prose) for name in NAME.findall(code)} - written
    assert not missing
