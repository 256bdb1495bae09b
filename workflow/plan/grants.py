"""What users grant by `--config`, and no scene can: an installed Blender that renders, and folders to read meshes from.

Both go to the environment, in which jobs find them. On clusters, where Snakemake reads the rules again in every job, it
hands `--config` on.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from render import program
from scene import assets
from scene.settings import Refused
from workflow.plan.lookup import stop

KEYS = ("blender", "allow")


def grant(config: Mapping[str, Any]) -> None:
    """Grant what the configuration says; ends the process where that cannot be."""
    blender, allowed = config.get("blender"), config.get("allow", ())
    if blender is not None:
        program.choose(str(blender))
    try:
        assets.allow(map(str, allowed) if isinstance(allowed, list | tuple) else [str(allowed)])
    except Refused as refused:
        stop(f"--config allow: {refused.message}\n  fix: {refused.remedy}")
