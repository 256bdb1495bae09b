"""From YAML to a document.

YAML is read by the rules of version 1.2 where 1.1 surprises: `1e-4` is a number, `on` and `no`
are text, a key given twice is an error, `<<` merges nothing, and no Python object is ever
constructed. Signs that only look like those of YAML are read as these: a minus sign before a number,
no-break blanks before keys and values, and characters that cannot be seen.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import yaml

from scene.diagnostics.slips import of_comment
from scene.diagnostics.suggestions import suggestion
from scene.document import Document, Location, Mark, SceneError
from scene.notation import BLANKS, INVISIBLE, MINUS, plain

MAX_BYTES = 10_000_000
MAX_DEPTH = 40
MAX_VALUES = 1_000_000
MAX_REPEATED = 50_000
"""Bounds of a scene: they stop what is no scene, and aliases that expand without end: those repeat values."""


def read(path: Path) -> Document:
    """Read a scene file; raises SceneError."""
    try:
        content = path.read_bytes()
        text = content.decode("utf-8-sig")
    except FileNotFoundError:
        siblings = [other.name for other in path.parent.glob("*.yaml")] if path.parent.is_dir() else []
        hint = (
            suggestion(path.name, siblings) if siblings else "give the path of a scene file such as scenes/bunny.yaml"
        )
        raise SceneError([f"{path}: no such scene file\n  fix: {hint}"]) from None
    except (OSError, ValueError) as error:
        raise SceneError([f"{path}: cannot be read: {error}\n  fix: give a UTF-8 text file in YAML"]) from None
    if len(content) > MAX_BYTES:
        raise SceneError([f"{path}: larger than any scene file, {len(content):,} bytes\n  fix: give a scene file"])
    return parse(text, source=str(path))


def parse(text: str, *, source: str) -> Document:
    """Parse YAML text; raises SceneError with the line of what is wrong."""
    text = _visible(text)
    reader = _Reader(source, text)
    try:
        root = yaml.compose(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        raise SceneError([reader.syntax_problem(error)]) from None
    except yaml.YAMLError as error:
        reason = str(error).splitlines()[0]
        raise SceneError([f"{source}: not YAML: {reason}\n  fix: give a UTF-8 text file in YAML"]) from None
    if root is None:
        raise SceneError([f"{source}: the file is empty\n  fix: start from scenes/tiny/splash.yaml"])
    if not isinstance(root, yaml.MappingNode):
        raise SceneError([f"{source}:1: a scene is a mapping of settings\n  fix: start with `duration: 2`"])
    reader.document.data = reader.construct(root, ())
    return reader.document


def assign(document: Document, assignment: str) -> None:
    """Apply `path.to.key=value` to a document, the value in YAML; raises SceneError where it cannot be."""
    path, equals, text = assignment.partition("=")
    keys: Location = tuple(int(part) if part.isdecimal() else part for part in path.strip().split("."))
    source = f"--set {assignment}"
    if not equals or "" in keys:
        raise SceneError([f"{source}: expected path.to.key=value\n  fix: --set fluid.viscosity=0.01"])
    try:
        value = parse(f"value: {text}", source=source).data["value"]
    except SceneError:
        remedy = "quote lists for the shell, as --set gravity='[0, -1.62, 0]'"
        raise SceneError([f"{source}: '{text}' is no value of a setting\n  fix: {remedy}"]) from None
    document.put(keys, value, source)


_BEFORE_KEY = re.compile(rf"^[ {BLANKS}]+", re.MULTILINE)
_AFTER_KEY = re.compile(rf"^( *(?:- +)*[\"']?[\w-]+[\"']?:)[{BLANKS}]+", re.MULTILINE)


def _visible(text: str) -> str:
    """The text without what cannot be seen, and with blanks of YAML where others would hide its structure."""
    text = text.translate(dict.fromkeys(map(ord, INVISIBLE)))
    return _AFTER_KEY.sub(r"\1 ", _BEFORE_KEY.sub(lambda blanks: " " * len(blanks[0]), text))


class _Loader(yaml.SafeLoader):
    """SafeLoader with the numbers and booleans of YAML 1.2, and a bound on the nesting."""

    def __init__(self, stream: str):
        super().__init__(stream)
        self._depth = 0

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        self._depth += 1
        if self._depth > MAX_DEPTH:
            raise yaml.MarkedYAMLError(problem=TOO_MUCH, problem_mark=self.peek_event().start_mark)
        node = super().compose_node(parent, index)
        self._depth -= 1
        if isinstance(node, yaml.ScalarNode):
            try:
                # Escapes may spell a character in two halves, as JSON does.
                node.value = node.value.encode("utf-16", "surrogatepass").decode("utf-16")
            except UnicodeDecodeError:
                raise yaml.MarkedYAMLError(problem=HALF, problem_mark=node.start_mark) from None
        return node


HALF = "an escape that is half of a character"
TOO_MUCH = "more nesting or more values than a scene can have"

_Loader.yaml_implicit_resolvers = {
    first: [(tag, regexp) for tag, regexp in resolvers if tag.rpartition(":")[2] == "null"]
    for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
_Loader.add_implicit_resolver("tag:yaml.org,2002:bool", re.compile(r"^(?:true|True|false|False)$"), list("tTfF"))
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:int", re.compile(rf"^[-+{MINUS}]?[0-9]+$"), list(f"-+{MINUS}0123456789")
)
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(
        rf"^(?:[-+{MINUS}]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+{MINUS}]?[0-9]+)?"
        r"|[-+]?\.(?:inf|Inf)|\.(?:nan|NaN))$"
    ),
    list(f"-+{MINUS}.0123456789"),
)


def _number(text: str) -> float:
    return float(plain(text).lower().replace(".inf", "inf").replace(".nan", "nan"))


def _integer(text: str) -> int | float:
    # Python refuses to read thousands of digits; no setting needs more than a float holds.
    return int(plain(text)) if len(text) < 19 else float(plain(text))


_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x84\x86-\x9f]")
"""What no text needs: messages and lists of scenes show texts in terminals."""
_TAG = "tag:yaml.org,2002:"
_SCALARS: dict[str, Callable[[str], Any]] = {
    f"{_TAG}str": str,
    f"{_TAG}int": _integer,
    f"{_TAG}float": _number,
    f"{_TAG}bool": {"true": True, "True": True, "false": False, "False": False}.__getitem__,
    f"{_TAG}null": lambda text: None,
}
_TAGS = {
    yaml.ScalarNode: frozenset(_SCALARS),
    yaml.SequenceNode: frozenset({f"{_TAG}seq"}),
    yaml.MappingNode: frozenset({f"{_TAG}map"}),
}


class _Reader:
    """Builds a document from the nodes of a YAML file."""

    def __init__(self, source: str, text: str):
        self.document = Document(source, {})
        self._seen: set[int] = set()
        self._repeated = 0
        # The line ends of YAML, not the many more of str.splitlines.
        self._lines = re.split("\r\n|[\r\n\x85\u2028\u2029]", text)

    def syntax_problem(self, error: yaml.MarkedYAMLError) -> str:
        mark, problem = error.problem_mark, error.problem or error.context or "not YAML"
        at_end = mark is None or not "".join(self._lines[mark.line :]).strip()
        context = error.context_mark or mark
        begin = 0 if at_end or context is None else context.line
        cause = self._cause(begin, mark.line if mark else 0)
        if cause is not None:
            line, problem, remedy = cause
            self.document.marks[("",)] = self._mark(line + 1)
            return self.document.problem(("",), problem, remedy)
        if at_end and error.context_mark is not None:
            mark = error.context_mark
        line = mark.line + 1 if mark else 0
        self.document.marks[("",)] = self._mark(line)
        return self.document.problem(("",), problem, _syntax_remedy(problem))

    def _cause(self, first: int, last: int) -> tuple[int, str, str] | None:
        """The line, from 0, of what often makes the lines `first` to `last` no YAML, what is wrong and what would be
        right."""
        for line in range(first, min(last + 1, len(self._lines))):
            remedy = of_comment(self._lines[line])
            if remedy:
                return line, "a colour is taken for a comment", remedy
        for line in range(max(last - 1, 0), last):
            key = _NO_COLON.match(self._lines[line])
            if key:
                return line, f"no ': ' between '{key[1]}' and its value", f"write `{key[1]}: {key[2]}`"
        return None

    def construct(self, node: yaml.Node, location: Location) -> Any:
        """Plain data of a node; every value's line is noted on the way."""
        marks = self.document.marks
        mark = marks.setdefault(location, self._mark(node.start_mark.line + 1))
        self._repeated += id(node) in self._seen
        self._seen.add(id(node))
        if len(location) > MAX_DEPTH or len(marks) > MAX_VALUES or self._repeated > MAX_REPEATED:
            raise SceneError([self.document.problem(location[:1], TOO_MUCH, _syntax_remedy(TOO_MUCH))])
        if node.tag not in _TAGS[type(node)]:
            marks[location] = self._mark(node.start_mark.line + 1)
            tag = node.tag.replace(_TAG, "!!")
            remedy = "remove the tag: settings are plain numbers, text, lists and mappings"
            raise SceneError([self.document.problem(location, f"the YAML tag '{tag}' is not allowed here", remedy)])
        if isinstance(node, yaml.SequenceNode):
            return [self.construct(item, (*location, index)) for index, item in enumerate(node.value)]
        if isinstance(node, yaml.MappingNode):
            return self._mapping(node, location)
        if found := _CONTROL.search(node.value):
            marks[location] = self._mark(node.start_mark.line + 1)
            message = f"holds the control character U+{ord(found[0]):04X}"
            raise SceneError([self.document.problem(location, message, "remove it")])
        try:
            return _SCALARS[node.tag](node.value)
        except (ValueError, KeyError):
            kind = node.tag.replace(_TAG, "!!")
            remedy = "remove the tag, or give a value of its kind"
            marks[location] = mark
            raise SceneError([self.document.problem(location, f"'{node.value}' is no {kind}", remedy)]) from None

    def _mapping(self, node: yaml.MappingNode, location: Location) -> dict[str, Any]:
        data: dict[str, Any] = {}
        for key_node, value_node in node.value:
            line = key_node.start_mark.line + 1
            key = str(key_node.value) if isinstance(key_node, yaml.ScalarNode) else ""
            here = (*location, key)
            first = self.document.marks.get(here)
            self.document.marks[here] = self._mark(line)
            if not key or key_node.tag not in _SCALARS or _CONTROL.search(key):
                remedy = "a key is a word, as in `radius: 0.1`"
                raise SceneError([self.document.problem(here, "this cannot be the name of a setting", remedy)])
            if key == "<<":
                remedy = "write the settings out, or override them in presets"
                raise SceneError([self.document.problem(here, "merge keys are not part of YAML 1.2", remedy)])
            if key in data and first is not None:
                message = f"'{key}' is given twice, first in line {first.line}"
                remedy = "give each body, and each key, a name of its own"
                raise SceneError([self.document.problem(here, message, remedy)])
            data[key] = self.construct(value_node, here)
        return data

    def _mark(self, line: int) -> Mark:
        text = self._lines[line - 1] if 0 < line <= len(self._lines) else ""
        return Mark(self.document.source, line, text)


_NO_COLON = re.compile(r"^\s*(?:- +)*([A-Za-z_]\w*)(?:\s*[=\uff1a]\s*|:|\s+)([^\s:#=\[{\uff1a].*?|[\[{].*[\]}])\s*$")
"""A key that is not parted from its value as YAML wants it."""


def _syntax_remedy(problem: str) -> str:
    """What is most often meant by a message of the YAML parser."""
    for words, remedy in (
        ("\\t", "write spaces instead of tabs"),
        ("mapping values are not allowed", "indent keys of one group alike, and put text that holds ': ' in quotes"),
        ("another document", "keep one scene in a file: remove the line `---`"),
        ("undefined alias", "define it before with &, or put text that begins with * in quotes"),
        (TOO_MUCH, "write the values out in plain lists and groups"),
        ("'<stream end>'", "close the bracket"),
        ("end of stream", "close the quotes"),
    ):
        if words in problem:
            return remedy
    return "check indentation, quotes and brackets in this line and the one before"
