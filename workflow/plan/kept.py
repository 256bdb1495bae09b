"""What was chosen for a scene, kept beside its results together with a key of all that it follows from."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from common.files import write_json
from workflow.plan.jobs import RESULTS


def key_of(*parts: Any) -> str:
    """32 hexadecimal digits of what a choice follows from, all of it JSON."""
    return hashlib.sha256(json.dumps(parts).encode()).hexdigest()[:32]


def kept(name: str, kind: str, key: str) -> dict[str, Any] | None:
    """The last choice of its kind for the scene with a name; none where it follows from anything else."""
    try:
        data = json.loads(_place(name, kind).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return data if isinstance(data, dict) and data.get("key") == key else None


def keep(name: str, kind: str, key: str, choice: Mapping[str, Any]) -> None:
    """Keep a choice, in place of the last one."""
    place = _place(name, kind)
    place.parent.mkdir(parents=True, exist_ok=True)
    write_json(place, {"key": key, **choice})


def _place(name: str, kind: str) -> Path:
    return Path(RESULTS, name, f"{kind}.json")
