"""The option --spec of the stages' commands: JSON, a file of it, or standard input."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TypeVar

from pydantic import ValidationError

from scene.settings import Refused, Settings

HELP = "the settings as JSON, the name of a file with them, or - for standard input"

Spec = TypeVar("Spec", bound=Settings)


def spec_text(given: str) -> str:
    """The JSON that the option means; raises Refused where a file cannot be read."""
    if given.lstrip().startswith("{"):
        return given
    try:
        return sys.stdin.read() if given == "-" else Path(given.removeprefix("@")).read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        raise Refused(
            f"--spec {given}: cannot be read: {error}", remedy="give JSON, the name of a file, or - for standard input"
        ) from None


def read_spec(model: type[Spec], given: str) -> Spec:
    """The settings that the option means; raises Refused."""
    try:
        return model.model_validate_json(spec_text(given))
    except ValidationError as error:
        details = error.errors(include_url=False)
        problems = "\n".join(f"  {'.'.join(map(str, part['loc'])) or '--spec'}: {part['msg']}" for part in details)
        raise Refused(f"--spec does not hold the settings of this stage\n{problems}") from None
