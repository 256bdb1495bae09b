"""The base of every group of settings, and the error that refuses one."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Annotated, Any, TypeVar, get_args

from pydantic import BaseModel, ConfigDict, StringConstraints

Name = Annotated[str, StringConstraints(pattern=r"^[A-Za-z][A-Za-z0-9_-]{0,63}$")]
"""Name of a body, sheet, container or probe: it becomes part of file names."""


class Settings(BaseModel):
    """Immutable, typed settings; an unknown key is an error."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, allow_inf_nan=False, validate_default=False, defer_build=True
    )

    def canonical(self) -> str:
        """One JSON string for equal settings, whatever their order, spelling or unit in the file."""
        return canonical_json(self.model_dump(mode="json", exclude_none=True))


def canonical_json(data: Any) -> str:
    """The same text for equal data: keys in order, no blanks. Raises ValueError for numbers that are not finite."""
    return json.dumps(data, sort_keys=True, separators=(",", ":"), allow_nan=False)


Given = TypeVar("Given")


def given(part: Given | None) -> Given:
    """Settings or a material that a scene may lack, for those who are asked only where it has them; raises LookupError
    otherwise."""
    if part is None:
        raise LookupError("the scene has no such settings or material")
    return part


def type_names(*models: type[Settings]) -> tuple[str, ...]:
    """What stands as `type` in scenes for each of these."""
    return tuple(name for model in models for name in get_args(model.model_fields["type"].annotation))


def choices(model: type[Settings], setting: str) -> tuple[str, ...]:
    """The names that a setting chooses one of, those that installed packages add included."""
    return get_args(model.model_fields[setting].annotation)


class Refused(Exception):
    """A setting or an asset that cannot be simulated as given; the process exits with 2.

    `location` is the path of keys in the scene, `remedy` says what would be right.
    """

    def __init__(self, message: str, *, location: tuple[str | int, ...] = (), remedy: str = ""):
        super().__init__(message)
        self.message = message
        self.location = location
        self.remedy = remedy

    def at(self, *location: str | int) -> Refused:
        """The same refusal, located further out in the scene."""
        return Refused(self.message, location=(*location, *self.location), remedy=self.remedy)

    def __str__(self) -> str:
        field = ".".join(str(part) for part in self.location)
        text = f"{field}: {self.message}" if field else self.message
        return f"{text}. {self.remedy}" if self.remedy else text


@dataclass(frozen=True)
class Caution:
    """What is simulated as given, and may not be what was meant; `location` as of a refusal."""

    text: str
    location: tuple[str | int, ...] = ()
