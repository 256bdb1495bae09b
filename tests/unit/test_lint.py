"""The sources are clean by the project's own rules: those of .pre-commit-config.yaml."""

from __future__ import annotations

import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]
CONFIG = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text(encoding="utf-8"))
HOOKS = {hook["id"]: hook for repository in CONFIG["repos"] for hook in repository["hooks"]}


@pytest.mark.parametrize("name", HOOKS)
def test_sources_are_clean(name):
    python, *command = shlex.split(HOOKS[name]["entry"])
    assert python == "python", "a command of this environment, which needs no download"
    done = subprocess.run([sys.executable, *command], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_what_is_looked_at():
    assert list(HOOKS) == ["ruff-check", "ruff-format", "snakefmt", "codespell", "mypy"]
    assert {(hook["language"], hook["pass_filenames"]) for hook in HOOKS.values()} == {("system", False)}
