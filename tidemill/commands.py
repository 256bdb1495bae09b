"""The commands by name. Each but `new` is one that stands elsewhere too, such as `python -m sim check`."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version

from common.command import go_on_unheard
from common.registry import load
from scene.diagnostics.suggestions import suggestion

REFUSED = 2


@dataclass(frozen=True)
class Command:
    """What carries a command out, and what it is for. The target is `module:function`, called with the arguments and
    with what the command is called, which its help says."""

    help: str
    target: str
    called: str = ""
    """Other than `tidemill NAME`."""
    first: tuple[str, ...] = ()
    """Arguments before those that the user gives."""
    goes_on: bool = False
    """Whether it makes files, which it does to the end though nobody reads any more what it prints."""

    def __call__(self, name: str, arguments: Sequence[str]) -> int:
        if self.goes_on:
            go_on_unheard()
        return load(self.target)([*self.first, *arguments], self.called or f"tidemill {name}") or 0


def _of_sim(name: str, help: str) -> Command:
    return Command(help, "sim.__main__:main", "tidemill", (name,))


COMMANDS = {
    "new": Command("make a folder for films of your own, or copy a scene to start from", "tidemill.project:main"),
    "scenes": Command("list the scenes and studies that can be named", "workflow.catalog:main"),
    "check": _of_sim("check", "validate a scene; nothing is simulated"),
    "explain": _of_sim("explain", "say what a scene models, what it could leave out, and what it costs"),
    "run": _of_sim("run", "simulate a scene, without surfaces and pictures"),
    "live": _of_sim("live", "play a scene in the browser, and change it while it runs"),
    "render": Command("make films", "tidemill.films:render"),
    "study": Command("measure error against cost", "tidemill.films:study"),
    "wedge": Command("make a film for each combination of a scene's `wedge:`", "tidemill.films:wedge"),
    "status": Command("show how far a film is, and the time left", "workflow.status:main"),
    "preview": Command("draw a frame in seconds, without Blender", "workflow.preview:main"),
    "export": Command("write a film's geometry for other programs", "workflow.export:main", goes_on=True),
    "doctor": Command("say whether this machine can make films, and what to do if not", "tidemill.doctor.report:main"),
}
EXAMPLES = """\
examples:
  tidemill new film && cd film        a folder with a first scene
  tidemill render film                its film, in renders/film/
  tidemill render film --quality draft -n
                                      what would run
  tidemill render bunny               a scene that comes with Tidemill, from any folder
  tidemill live film                  play it in the browser

`tidemill COMMAND --help` says more.
"""


def call(arguments: Sequence[str]) -> int:
    """Carry out a command; the exit status."""
    if arguments and arguments[0] in COMMANDS:
        return COMMANDS[arguments[0]](arguments[0], arguments[1:])
    width = max(map(len, COMMANDS))
    known = "\n".join(f"  {name:<{width}}  {command.help}" for name, command in COMMANDS.items())
    parser = argparse.ArgumentParser(
        prog="tidemill",
        usage="tidemill COMMAND ...",
        description="From a scene file to a film: water, cloth and rigid bodies simulated together and rendered.",
        epilog=f"commands:\n{known}\n\n{EXAMPLES}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"tidemill {version('tidemill')}")
    if not arguments:
        parser.print_help()
        return 0
    if not arguments[0].startswith("-"):
        fix = suggestion(arguments[0], COMMANDS)
        parser.exit(REFUSED, f"tidemill: no command '{arguments[0]}'\n  fix: {fix}\n")
    parser.parse_args(arguments)
    return 0
