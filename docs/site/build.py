"""The documentation as one searchable site: python docs/site/build.py FOLDER.

On GitHub, pages link to each other as files of the repository. For the site all of them are gathered in one folder,
README.md as the first page, and links follow. Any link that leads nowhere ends the build.
"""

from __future__ import annotations

import argparse
import re
import shutil
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from sphinx.cmd.build import build_main

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
PAGES = {"README.md": "index.md", "CONTRIBUTING.md": "CONTRIBUTING.md", "CHANGELOG.md": "CHANGELOG.md"}
"""What is a page of the site and lies elsewhere, by where it lies."""
_LINK = re.compile(r"\]\((?!https?:|#|mailto:)([^)\s]+)\)")


def gather(folder: Path) -> None:
    """Put all pages, with their pictures and the scenes that they link to, into a folder."""
    shutil.copytree(ROOT / "docs", folder, ignore=shutil.ignore_patterns("site"))
    shutil.copytree(ROOT / "scenes", folder / "scenes", ignore=shutil.ignore_patterns("__pycache__"))
    for file, page in PAGES.items():
        shutil.copyfile(ROOT / file, folder / page)
    for page in folder.glob("*.md"):
        page.write_text(_LINK.sub(lambda link: f"]({_on_site(link[1])})", page.read_text()))
    with (folder / "index.md").open("a") as index:
        index.write("\n" + (HERE / "contents.md").read_text())


def _on_site(target: str) -> str:
    path, mark, anchor = target.partition("#")
    path = path.removeprefix("../").removeprefix("docs/")
    return PAGES.get(path, path) + mark + anchor


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="for the site")
    options = parser.parse_args()
    with TemporaryDirectory() as name:
        source = Path(name, "pages")
        gather(source)
        return build_main(
            ["-W", "--keep-going", "-q", "-c", str(HERE), "-b", "dirhtml", str(source), str(options.folder)]
        )


if __name__ == "__main__":
    sys.exit(main())
