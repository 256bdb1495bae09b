"""docs/looks.md, from docs/gallery/looks.yaml."""

from __future__ import annotations

import textwrap

from workflow.gallery.looks.exhibits import FOLDER, Exhibit, Exhibits


def page(shown: Exhibits) -> str:
    """The page in Markdown."""
    return "\n\n".join(["# Looks", shown.intro.strip(), *map(_entry, shown.exhibits)]) + "\n"


def _entry(exhibit: Exhibit) -> str:
    lines = "render:\n" + textwrap.indent(exhibit.lines.strip(), "  ")
    picture = FOLDER.relative_to("docs") / f"{exhibit.name}.jpg"
    return "\n\n".join(
        [f"## {exhibit.name}", exhibit.says.strip(), f"![{exhibit.seen}]({picture})", f"```yaml\n{lines}\n```"]
    )
