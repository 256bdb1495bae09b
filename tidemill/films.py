"""What Snakemake makes: films, studies and wedges, called by name."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

from tidemill import DISTRIBUTION, SNAKEFILE

REFUSED = 2
SNAKEFILES = ("Snakefile", "snakefile", "workflow/Snakefile", "workflow/snakefile")
"""Where Snakemake looks for the rules of a folder of one's own."""
PROFILE = Path("profiles/default")


def render(arguments: Sequence[str], called: str) -> NoReturn:
    """Make the films of scenes."""
    parser = _parser(called, "Make films: renders/NAME/ with the film, its frames, plots and tables.", "scene")
    parser.add_argument("--quality", metavar="Q", help="draft, standard or final (default: the scene's)")
    parser.add_argument("--budget", metavar="TIME", help="the finest film that takes this long, such as 10min")
    parser.add_argument("--error", metavar="BOUND", help="the cheapest film within the error, such as 10%%")
    parser.add_argument(
        "--set", action="append", metavar="PATH=VALUE", help="another setting, such as render.resolution=[1280,720]"
    )
    _add_grants(parser)
    parser.add_argument("--keep", choices=("all", "film"), help="whether to keep the results that a film is made of")
    _make("renders", parser, arguments)


def study(arguments: Sequence[str], called: str) -> NoReturn:
    """Carry out studies."""
    _make(
        "studies",
        _parser(called, "Measure error against cost: studies/NAME/ with plot and tables.", "study"),
        arguments,
    )


def wedge(arguments: Sequence[str], called: str) -> NoReturn:
    """Make the films of wedges."""
    about = "Make a film for each combination of a scene's `wedge:`: wedges/NAME/ compares them."
    parser = _parser(called, about, "scene")
    parser.add_argument("--quality", metavar="Q", help="draft, standard or final (default: the scene's)")
    _add_grants(parser)
    _make("wedges", parser, arguments)


def _add_grants(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--blender", metavar="PATH", help="an installed Blender that renders, instead of the package's")
    parser.add_argument("--allow", metavar="DIR", help="let scenes read files below this folder, too")


def _parser(called: str, about: str, what: str) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog=called,
        description=f"{about} Work that is done is kept: run it again after an edit, or after it was stopped.",
        epilog="Whatever follows -- goes to Snakemake: -- --forcerun film --report report.html",
    )
    parser.add_argument("names", nargs="+", metavar="NAME", help=f"of a {what}; `tidemill scenes` lists them")
    parser.add_argument("-n", "--dry-run", action="store_true", help="say what would run, and why")
    parser.add_argument("-c", "--cores", metavar="N", help="cores to use (default: all)")
    return parser


def _make(target: str, parser: argparse.ArgumentParser, arguments: Sequence[str]) -> NoReturn:
    own, rest = _split(arguments)
    options = vars(parser.parse_args(own))
    names, dry, cores = (options.pop(key) for key in ("names", "dry_run", "cores"))
    config = [f"{key}={_written(value)}" for key, value in options.items() if value is not None]
    if config and any(word.partition("=")[0] in ("--config", "-C") for word in rest):
        given = ", ".join(f"--{word.partition('=')[0]}" for word in config)
        parser.exit(REFUSED, f"{parser.prog}: {given} and --config cannot both be given\n  fix: say all by --config\n")
    words = [f"{target}/{name}" for name in names]
    words += ["--dry-run"] if dry else []
    words += ["--cores", cores] if cores else []
    _snakemake([*words, *rest, *(["--config", *config] if config else [])])


def _written(value: str | list[str]) -> str:
    """As Snakemake reads it, in YAML."""
    return value if isinstance(value, str) else json.dumps(value)


def _split(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """What is before `--`, and what is behind it."""
    words = list(arguments)
    end = words.index("--") if "--" in words else len(words)
    return words[:end], words[end + 1 :]


def _snakemake(words: list[str]) -> NoReturn:
    """Become Snakemake, with the rules and the profile of the working directory, or with those that come with this
    software where it has none."""
    if not any(Path(name).is_file() for name in SNAKEFILES):
        words = ["--snakefile", SNAKEFILE, *words]
    if not PROFILE.is_dir():
        words = ["--workflow-profile", str(DISTRIBUTION / PROFILE), *words]
    sys.stdout.flush()
    sys.stderr.flush()
    os.execv(sys.executable, [sys.executable, "-m", "snakemake", *words])
