"""The cheapest scene there is, as a file: a ball that falls."""

from __future__ import annotations

from pathlib import Path


def scene(duration: float, more: str = "") -> str:
    """The text of its scene file; `more`: lines that follow."""
    return f"""\
duration: {duration}
fps: 4
rigid:
  bodies:
    ball: {{shape: {{type: sphere, radius: 0.1}}, motion: dynamic, position: [0, 1, 0]}}
{more}"""


def written(path: Path, text: str, *replaced: tuple[str, str]) -> Path:
    """Write a text with parts of it replaced, all of which it has."""
    for old, new in replaced:
        assert old in text
        text = text.replace(old, new)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path
