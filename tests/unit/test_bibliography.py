"""Whom sources and docs cite is in docs/bibliography.md, and nobody else; all are cited in the same way.

`Author 2005`, `Author & Author 2007, eq. 7`, `Author et al. 2014, 2017` from three authors on; works of the same
authors and year are told apart by a letter.
"""

from __future__ import annotations

import re
from collections import defaultdict
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BIBLIOGRAPHY = ROOT / "docs" / "bibliography.md"
SOURCES = ["common", "scene", "sim", "render", "workflow", "live"]

AUTHOR = r"(?:[Dd]e |[Vv]an )?[A-ZÀ-Þ][\w'-]+"
YEAR = r"(?:1[5-9]|20)\d\d[a-z]?"
CITATION = re.compile(rf"({AUTHOR}(?: & {AUTHOR}| et al\.)?) ({YEAR}(?:, {YEAR})*)\b")
OTHERWISE = re.compile(
    rf"{AUTHOR}(?: et al\.?)?,? \({YEAR}\)"  # Author (2005)
    rf"|{AUTHOR}(?: et al\.)?'s? {YEAR}\b"
    rf"|{AUTHOR},? and {AUTHOR},? {YEAR}\b"
    rf"|{AUTHOR}, {AUTHOR}(?: & {AUTHOR})? {YEAR}\b"
    rf"|{AUTHOR} (?:& {AUTHOR}|et al\.), {YEAR}\b"
    rf"|{AUTHOR} et al {YEAR}\b"
)
ENTRY = re.compile(
    r"- \*\*(?P<label>[^*]+)\*\* (?P<authors>[^*]+): \*(?P<title>[^*]+)\*\. (?P<published>.+?)\.?\n"
    r"(?:  (?P<address>doi:\S+|<\S+>)\n)?"
    r"  Cited in (?P<modules>.+)\n"
)
DOI = re.compile(r"doi:10\.\d{4,5}/\S*[^\s.,;]")


def texts() -> dict[str, str]:
    """Sources and docs by their path, each as one line."""
    paths = [path for folder in SOURCES for path in (ROOT / folder).rglob("*.py")]
    paths += [path for path in (ROOT / "docs").glob("*.md") if path != BIBLIOGRAPHY]
    return {
        path.relative_to(ROOT).as_posix(): re.sub(r"\s*\n\s*(?:# )?", " ", path.read_text(encoding="utf-8"))
        for path in sorted(paths)
    }


def cited(text: str) -> set[str]:
    """The works that a text cites, as `Author 2005`."""
    return {f"{authors} {year}" for authors, years in CITATION.findall(text) for year in years.split(", ")}


def citations() -> dict[str, list[str]]:
    """Where each work is cited."""
    found = defaultdict(list)
    for path, text in texts().items():
        for label in cited(text):
            found[label].append(path)
    return found


def entries() -> dict[str, re.Match[str]]:
    """What docs/bibliography.md lists."""
    text = BIBLIOGRAPHY.read_text(encoding="utf-8")
    found = list(ENTRY.finditer(text))
    assert len(found) == text.count("\n- "), "an entry lacks authors, title, where it was published, or its modules"
    labels = [entry["label"] for entry in found]
    assert len(set(labels)) == len(labels), "listed twice"
    return dict(zip(labels, found, strict=True))


def order(label: str) -> str:
    """By which entries are sorted: what an author wrote alone, then with one other, then with more."""
    return label.translate(str.maketrans("öüé&", "ouea")).lower()


@pytest.mark.parametrize(
    ("text", "works"),
    [
        ("(Lamb 1932, sec. 137)", {"Lamb 1932"}),
        ("De Saxcé & Feng 1998", {"De Saxcé & Feng 1998"}),
        ("Macklin et al. 2016, 2019", {"Macklin et al. 2016", "Macklin et al. 2019"}),
        ("Provot 1997, Akinci et al. 2013a", {"Provot 1997", "Akinci et al. 2013a"}),
        ("MOST_TRIALS = 2000", set()),
    ],
)
def test_citations_are_recognized(text, works):
    assert cited(text) == works


@pytest.mark.parametrize(
    "text",
    [
        "Monaghan (1992)",
        "Ihmsen et al. (2014)",
        "Mehrotra's 1992",
        "Baraff and Witkin 1998",
        "Bridson, Marino and Fedkiw 2003",
        "Bender, Koschier 2017",
        "Morris, Fox & Zhu 1997",
        "Becker & Teschner, 2007",
        "Bender et al 2019",
    ],
)
def test_other_styles_are_recognized(text):
    assert OTHERWISE.search(text)


def test_all_are_cited_in_one_style():
    found = {path: [match[0] for match in OTHERWISE.finditer(text)] for path, text in texts().items()}
    assert not {path: matches for path, matches in found.items() if matches}


def test_cited_works_are_listed():
    listed = entries()
    assert not {label: paths for label, paths in citations().items() if label not in listed}


def test_listed_works_are_cited_where_they_say():
    found = citations()
    said = {label: re.findall(r"`([^`]+)`", entry["modules"]) for label, entry in entries().items()}
    assert not {label: found[label] for label, modules in said.items() if sorted(modules) != found[label]}


def test_entries_are_sorted_and_agree_with_their_labels():
    labels = list(entries())
    assert labels == sorted(labels, key=order)
    for label, entry in entries().items():
        *_, year = label.split()
        assert year.rstrip("abc") in entry["published"], label
        names = re.split(r", | & ", entry["authors"])
        assert ("et al." in label) == (len(names) > 2), label
        assert ("&" in label) == (len(names) == 2), label
        first = re.split(r" & | et al\.| (?=\d)", label)[0]
        assert names[0].endswith(first), label


def test_dois_have_their_form():
    addresses = {label: entry["address"] for label, entry in entries().items() if entry["address"]}
    assert not {
        label: address
        for label, address in addresses.items()
        if not DOI.fullmatch(address) and not re.fullmatch(r"<https?://\S+>", address)
    }
