"""Settings of what installed packages add, by their names: what groups named `extra` hold."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Any

from pydantic import BeforeValidator, SerializeAsAny, ValidationError, WithJsonSchema

from common.registry import added
from scene.diagnostics.suggestions import suggestion
from scene.settings import Settings

Added = Annotated[Settings, SerializeAsAny(), WithJsonSchema({"type": "object"})]


def of_packages(*kinds: str) -> BeforeValidator:
    """Reads settings of these kinds of additions (`common.registry.KINDS`) as those who add them have declared them."""
    return BeforeValidator(partial(_read, kinds))


def _read(kinds: tuple[str, ...], values: Any) -> Any:
    if not isinstance(values, dict):
        return values
    known = {name: settings for kind in kinds for name, settings in added(kind).items()}
    for name in values:
        if name not in known:
            fix = suggestion(name, known) if known else "no installed package adds any: remove it"
            wanted = " or ".join(kind.removesuffix("s") for kind in kinds)
            raise ValueError(f"no {wanted} '{name}': {fix}")
    return {name: _checked(name, known[name], value) for name, value in values.items()}


def _checked(name: str, model: type[Settings], value: Any) -> Settings:
    try:
        return value if isinstance(value, Settings) else model.model_validate(value or {})
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        raise ValueError(f"{'.'.join(map(str, (name, *first['loc'])))}: {first['msg']}") from None
