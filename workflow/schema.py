"""The JSON schema of scene files, by which editors complete and check them, and the tables made from it.

`python -m workflow.schema` writes scenes/schema.json, `python -m workflow.schema --markdown` writes
docs/scene-reference.md.
"""

from __future__ import annotations

import argparse
import copy
import json
from pathlib import Path
from typing import Any

from common.command import end_with
from scene.descriptions import WithMeanings
from scene.load import SceneFile
from scene.presets import QUALITIES

SCHEMA = Path("scenes/schema.json")
REFERENCE = Path("docs/scene-reference.md")

Node = dict[str, Any]

PRESET = "Preset_"
"""Begins the names of the definitions in which every setting may be left out."""


def schema() -> Node:
    """The schema of a scene file; a preset is a scene of which everything may be left out."""
    whole = _named(SceneFile.model_json_schema(schema_generator=WithMeanings))
    definitions = whole.pop("$defs")
    top = {key: value for key, value in whole.items() if key != "required"}
    top["properties"] = {
        key: value for key, value in whole["properties"].items() if key not in {"presets", "quality", "description"}
    }
    partial = {f"{PRESET}{name}": _partial(node) for name, node in definitions.items()}
    partial[f"{PRESET}Scene"] = _partial(top) | {"title": "Preset", "description": "Settings that a preset overrides."}
    whole["properties"]["presets"] = {
        "type": "object",
        "description": whole["properties"]["presets"]["description"],
        "additionalProperties": False,
        "properties": {quality: {"$ref": f"#/$defs/{PRESET}Scene"} for quality in QUALITIES},
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **whole,
        "title": "Tidemill scene",
        "$defs": definitions | partial,
    }


def text() -> str:
    """What scenes/schema.json holds."""
    return json.dumps(schema(), indent=1, sort_keys=True, ensure_ascii=False) + "\n"


def _named(node: Any) -> Any:
    """The same schema, in which names that do not fit their pattern are wrong rather than unchecked."""
    if isinstance(node, list):
        return [_named(item) for item in node]
    if not isinstance(node, dict):
        return node
    closed = {"additionalProperties": False} if "patternProperties" in node else {}
    return {key: _named(value) for key, value in node.items()} | closed


def _partial(node: Any) -> Any:
    """The same schema with nothing required: members of a union can then not be told apart."""
    if isinstance(node, list):
        return [_partial(item) for item in node]
    if not isinstance(node, dict):
        return node
    node = copy.copy(node)
    if isinstance(node.get("required"), list):
        del node["required"]
    if "discriminator" in node:
        del node["discriminator"]
        node["anyOf"] = node.pop("oneOf")
    if "$ref" in node:
        node["$ref"] = node["$ref"].replace("#/$defs/", f"#/$defs/{PRESET}")
    return {key: value if key == "default" else _partial(value) for key, value in node.items()}


def markdown() -> str:
    """What docs/scene-reference.md holds: a table of settings for every group."""
    whole = schema()
    definitions = whole["$defs"]
    lines = [
        "# Settings of a scene file",
        "",
        "Made by `python -m workflow.schema --markdown`; [scenes.md](scenes.md) explains how to use them.",
        "A plain number is in the unit shown; a quantity in another unit of the same kind, such as `10 mm`, is",
        "converted. *required* marks settings without a default.",
    ]
    for name in ["", *_reached(whole)]:
        node = definitions[name] if name else whole
        lines += ["", f"## {name or 'Scene'}", "", _one_line(node.get("description", "")), ""]
        lines += ["| setting | value | range | default | meaning |", "| --- | --- | --- | --- | --- |"]
        for key, field in node["properties"].items():
            cells = (
                f"`{key}`",
                _kind(field),
                _range(field),
                _default(key, field, node),
                _one_line(field.get("description", "")),
            )
            lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines) + "\n"


def _reached(whole: Node) -> list[str]:
    """Names of the groups of settings, in the order in which a reader of the scene meets them."""
    found: list[str] = []

    def visit(node: Any) -> None:
        if isinstance(node, list):
            for item in node:
                visit(item)
        elif isinstance(node, dict):
            name = node.get("$ref", "").removeprefix("#/$defs/")
            if name and name not in found and not name.startswith(PRESET):
                found.append(name)
                visit(whole["$defs"][name]["properties"])
            for key, value in node.items():
                if key != "default":
                    visit(value)

    visit(whole["properties"])
    return found


def _kind(field: Node) -> str:
    """A field's values in words, with links to the groups."""
    if "unit" in field:
        return "number" if field["unit"] == "1" else f"number [{field['unit']}]"
    if "$ref" in field:
        name = field["$ref"].removeprefix("#/$defs/")
        return "preset" if name.startswith(PRESET) else f"[{name}](#{name.lower()})"
    if "enum" in field:
        return ", ".join(f"`{value}`" for value in field["enum"])
    if "const" in field:
        return f"`{field['const']}`"
    for union in ("oneOf", "anyOf"):
        if union in field:
            kinds = [_kind(member) for member in field[union] if member.get("type") != "null"]
            return " or ".join(dict.fromkeys(kinds))
    match field.get("type"):
        case "array" if "prefixItems" in field:
            kinds = [_kind(item) for item in field["prefixItems"]]
            return f"list of {len(kinds)}: {' and '.join(dict.fromkeys(kinds))}"
        case "array":
            return f"list of {_kind(field.get('items', {}))}"
        case "object":
            members = field.get("additionalProperties") or field.get("patternProperties") or {}
            members = next(iter(members.values())) if "patternProperties" in field else members
            return f"by name: {_kind(members)}" if isinstance(members, dict) and members else "settings"
        case "boolean":
            return "`true` or `false`"
        case "string":
            return "text"
        case "integer":
            return "whole number"
        case "number":
            return "number"
    return "any value"


def _range(field: Node) -> str:
    """The bounds of a number, or of the numbers of a list."""
    for nested in (field, *field.get("anyOf", ()), *field.get("prefixItems", ())):
        if nested is not field and (inner := _range(nested)):
            return inner
        low, above = nested.get("minimum"), nested.get("exclusiveMinimum")
        high, below = nested.get("maximum"), nested.get("exclusiveMaximum")
        parts = [f"> {above:g}"] if above is not None else []
        parts += [f"≥ {low:g}"] if low is not None else []
        parts += [f"< {below:g}"] if below is not None else []
        parts += [f"≤ {high:g}"] if high is not None else []
        if parts:
            return ", ".join(parts)
    return ""


def _default(key: str, field: Node, group: Node) -> str:
    if key in group.get("required", ()):
        return "*required*"
    default = field.get("default")
    if default is None or (isinstance(default, dict | str) and not default):
        return ""
    return "its own" if isinstance(default, dict) else f"`{json.dumps(default)}`"


def _one_line(words: str) -> str:
    return " ".join(words.split())


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(
        prog="python -m workflow.schema", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--markdown", action="store_true", help="write the tables instead of the schema")
    path, content = (REFERENCE, markdown()) if parser.parse_args(arguments).markdown else (SCHEMA, text())
    path.parent.mkdir(exist_ok=True)
    path.write_text(content, encoding="utf-8")
    print(f"wrote {path}")


if __name__ == "__main__":
    end_with(main, goes_on=True)
