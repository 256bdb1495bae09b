"""The example of docs/scenes.md is a valid scene."""

from __future__ import annotations

import re


def test_the_example_is_valid(bench, project):
    blocks = re.findall(r"```yaml\n(.*?)```", (project / "docs" / "scenes.md").read_text(), re.DOTALL)
    bench.accepts(blocks[0])
