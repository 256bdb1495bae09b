"""The looks: their pictures into docs/images/looks, and the page of them.

    python -m workflow.gallery.looks wood lemon   make these pictures anew
    python -m workflow.gallery.looks --all        make all of them
    python -m workflow.gallery.looks              write docs/looks.md alone

docs/gallery/looks.yaml says what is shown, on what, and in which order.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from common.command import end_with
from common.distribution import HOME
from scene.document import SceneError
from workflow.gallery.looks.exhibits import FOLDER, PAGE, exhibits
from workflow.gallery.looks.page import page
from workflow.gallery.looks.pictures import NotMade, picture


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m workflow.gallery.looks",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("names", nargs="*", help="of the file, such as lemon")
    parser.add_argument("--all", action="store_true", help="make every picture")
    options = parser.parse_args(arguments)
    try:
        shown = exhibits(HOME)
        known = {exhibit.name: exhibit for exhibit in shown.exhibits}
        for name in known if options.all else options.names:
            if name not in known:
                raise NotMade(f"docs/gallery/looks.yaml does not show {name}")
            with tempfile.TemporaryDirectory() as folder:
                picture(known[name], shown, HOME / FOLDER / f"{name}.jpg", Path(folder))
            print(f"made {name}")
    except (SceneError, NotMade) as error:
        print(f"looks: {error}", file=sys.stderr)
        return 2
    (HOME / PAGE).write_text(page(shown))
    print(PAGE)
    return 0


if __name__ == "__main__":
    end_with(main, goes_on=True)
