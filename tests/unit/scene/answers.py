"""The page of mistakes: what was typed into a scene, and what `check` answered."""

from __future__ import annotations

import difflib
import html
import re
from pathlib import Path

HEAD = """\
# Mistakes and their answers

Each mistake below was made in an otherwise valid scene, and each answer is what `python -m sim check` printed \
after the file and line. An error is refused with exit 2; after a warning the scene would still run. \
Written by `pytest tests/unit/scene --answers docs/mistakes.md`, {count} mistakes.
"""
MESSAGE = re.compile(
    r"^(?:\S*\.yaml:\d+: |  (?=warning: )|(?=--))(.*?)(?=^\S*\.yaml:|^\S+\.yaml \(|^  warning: |\Z)", re.M | re.S
)
SOURCE = re.compile(r"^ +\d+ \| .*\n?", re.M)
TEMPORARY = re.compile(r"\S*/pytest-\d+/(?:popen-gw\d+/)?[^/\s'\]]*")
LONGEST = 400
"""Letters of what was typed; what is longer, as nesting without end, shows nothing in a table."""


def answer(typed: bytes, right: str, options: tuple[str, ...], said: str) -> tuple[str, list[str]] | None:
    """The lines that differ from those that are right, and the messages; None if there are none, or no room."""
    try:
        lines = typed.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        return None
    new = [line[2:] for line in difflib.ndiff(right.splitlines(), lines) if line.startswith("+ ")]
    new += [" ".join(options[k : k + 2]) for k, option in enumerate(options) if option == "--set"]
    messages = [SOURCE.sub("", found).strip() for found in MESSAGE.findall(said)]
    return ("\n".join(new), messages) if new and messages and sum(map(len, new)) < LONGEST else None


def page(answered: dict[str, list[tuple[str, list[str]]]]) -> str:
    groups: dict[str, dict[str, None]] = {}
    for node, found in sorted(answered.items()):
        file, _, name = node.partition("::")
        case = name.partition("[")[2].rstrip("]") or name.removeprefix("test_").replace("_", " ")
        group = Path(file).stem.removeprefix("test_scene_").removeprefix("test_").replace("_", " ").capitalize()
        for typed, messages in found:
            row = f"| {_cell(case)} | {_code(typed)} | {_cell(chr(10).join(messages))} |"
            groups.setdefault(group, {})[row] = None
    head = "| mistake | typed | answer |\n| --- | --- | --- |"
    parts = [HEAD.format(count=sum(map(len, groups.values())))]
    parts += [f"## {group} ({len(rows)})\n\n{head}\n" + "\n".join(rows) + "\n" for group, rows in groups.items()]
    return "\n".join(parts)


def _code(text: str) -> str:
    return "<br>".join(f"<code>{_cell(line).replace('  ', '&nbsp; ')}</code>" for line in text.splitlines())


def _cell(text: str) -> str:
    text = TEMPORARY.sub("PROJECT", text)
    return html.escape(text, quote=False).replace("|", "&#124;").replace("\n", "<br>")
