"""Numbers and units as people type them: what is understood, and what would be right where that is in doubt."""

from __future__ import annotations

import re

INVISIBLE = "\u200b\u200e\u200f\u2060\ufeff"
BLANKS = "\u00a0\u2002\u2003\u2007\u2009\u200a\u202f"
"""No-break and narrow blanks, as word processors and web pages put them between a number and its unit."""
MINUS = "\N{MINUS SIGN}"
_PLAIN = str.maketrans(
    {
        **dict.fromkeys(BLANKS, " "),
        **dict.fromkeys(INVISIBLE, ""),
        MINUS: "-",
        "\N{DOT OPERATOR}": "·",
        "\N{MASCULINE ORDINAL INDICATOR}": "°",
    }
)
_RAISED = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
_QUOTES = re.compile("[\"'\u00ab\u00bb\u2018-\u201f]")
_QUOTED = re.compile(r"^\s*[\u00ab\u00bb\u2018-\u201f](.+)[\u00ab\u00bb\u2018-\u201f]\s*$")
_DASHES = re.compile(
    r"^\s*[\u2010\u2011\u2012\u2013\u2014]\s*(?=[.\d])|(?<=[eE])[\u2010\u2011\u2012\u2013\u2014](?=\d)"
)
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"


def plain(text: str) -> str:
    """The same quantity in the signs of ASCII as far as they have no other meaning: `−5 m·s⁻²` is `-5 m·s^-2`."""
    return re.sub(r"[⁻⁰¹²³⁴-⁹]+", lambda raised: f"^{raised[0].translate(_RAISED)}", text.translate(_PLAIN))


def numbers(text: str) -> list[str] | None:
    """The numbers of a text that holds some and what parts them, as `(0, 0.2, 0)` or `640x360`; None for any other."""
    parts = re.split(r"\s*(?:[,;]|(?<=\d)\s*[x\u00d7]\s*(?=\d)|\s)\s*", plain(text).strip().strip("()[]{}<>").strip())
    return parts if len(parts) > 1 and all(re.fullmatch(_NUMBER, part) for part in parts) else None


def unquoted(text: str) -> str:
    """The text without quotes around it of the kinds that are none to YAML."""
    return _QUOTED.sub(r"\1", text)


def meant(text: str) -> str:
    """What to write for what is not read as a number, since it may have been meant otherwise; empty where unknown."""
    text = plain(text).strip()
    if inches := re.fullmatch(rf"({_NUMBER})\s*[\"\u201d\u2033]", text):
        return f"write {inches[1]} in"
    bare = _QUOTES.sub("", text).strip()
    if bare and bare != text:
        return meant(bare) or f"write {bare} without these quotes"
    if _DASHES.search(text):
        return f"that is a dash: write {_DASHES.sub('-', text)} with a hyphen"
    if many := re.fullmatch(r"([-+]?\d{1,3}(?:,\d{3}){2,})(.*)", text):
        return f"write {many[1].replace(',', '')}{many[2]} without commas"
    if comma := re.fullmatch(r"([-+]?\d+),(\d+)((?:[eE][-+]?\d+)?\s*[^\d,;]*.*)", text):
        whole, part, rest = comma.groups()
        other = (
            f", or {whole}{part}{rest} if thousands were meant" if len(part) == 3 and whole.lstrip("-+") != "0" else ""
        )
        return f"decimals have a point: write {whole}.{part}{rest}{other}" if "," not in rest else ""
    if ";" in text and (parts := numbers(text)):
        return f"part values by commas, as [{', '.join(parts)}]"
    if apart := re.fullmatch(r"([-+]?\d{1,3}(?:[ '\u2019]\d{3})+)(\D*)", text):
        whole = re.sub(r"[^-+\d]", "", apart[1])
        return f"write {whole}{apart[2]} without gaps"
    if (share := re.fullmatch(r"([-+]?\d+)\s*/\s*(\d+)", text)) and int(share[2]):
        return f"write {int(share[1]) / int(share[2]):.6g}: nothing is computed here"
    return ""
