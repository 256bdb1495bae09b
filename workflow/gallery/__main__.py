"""The gallery: films of renders/ into docs/gallery, and the page of them.

    python -m workflow.gallery duck drape   collect these films, which have to be made before
    python -m workflow.gallery              write docs/gallery.md alone

docs/gallery/shots.yaml says what is shown, in which order, and which frame is the large picture.
"""

from __future__ import annotations

import argparse
import sys

from common.command import end_with
from common.distribution import HOME
from scene.document import SceneError
from workflow.gallery.collect import NotMade, collect
from workflow.gallery.page import page
from workflow.gallery.shots import PAGE, shots


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m workflow.gallery", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scenes", nargs="*", help="names of scenes, such as duck")
    options = parser.parse_args(arguments)
    try:
        known = shots(HOME)
        by_name = {shot.scene: shot for shot in known.shots}
        for name in options.scenes:
            if name not in by_name:
                raise NotMade(f"docs/gallery/shots.yaml does not show {name}")
            collect(by_name[name], HOME)
            print(f"collected {name}")
    except (SceneError, NotMade) as error:
        print(f"gallery: {error}", file=sys.stderr)
        return 2
    (HOME / PAGE).write_text(page(known, HOME))
    print(PAGE)
    return 0


if __name__ == "__main__":
    end_with(main, goes_on=True)
