"""What the doctor says of one thing."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class State(Enum):
    """How something is: OK; to be known, since some films suffer from it; or wrong, so that none can be made."""

    OK = "ok"
    WARNING = "warning"
    WRONG = "wrong"


@dataclass(frozen=True)
class Finding:
    """What was looked at, how it is, and what to do about it where it is not right."""

    subject: str
    state: State
    text: str
    fix: str = ""


def ok(subject: str, text: str) -> Finding:
    """What is right."""
    return Finding(subject, State.OK, text)


def warning(subject: str, text: str, fix: str) -> Finding:
    """What some films suffer from."""
    return Finding(subject, State.WARNING, text, fix)


def wrong(subject: str, text: str, fix: str) -> Finding:
    """What keeps films from being made."""
    return Finding(subject, State.WRONG, text, fix)
