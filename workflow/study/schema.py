"""The JSON schema of study files: `python -m workflow.study.schema` writes scenes/studies/schema.json."""

from __future__ import annotations

import json
from pathlib import Path

from common.command import end_with
from scene.descriptions import WithMeanings
from workflow.study.spec import Study

SCHEMA = Path("scenes/studies/schema.json")


def text() -> str:
    """What the file holds."""
    whole = Study.model_json_schema(schema_generator=WithMeanings)
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    return json.dumps({**head, **whole, "title": "Tidemill study"}, indent=1, sort_keys=True, ensure_ascii=False) + "\n"


def main() -> None:
    SCHEMA.write_text(text(), encoding="utf-8")
    print(f"wrote {SCHEMA}")


if __name__ == "__main__":
    end_with(main, goes_on=True)
