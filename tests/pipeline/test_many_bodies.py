"""Settings reach their stage whatever their length: Linux lets one argument of a command have 128 KiB."""

from __future__ import annotations

ARGUMENT = 128 * 1024
"""[bytes] MAX_ARG_STRLEN of Linux: 32 pages of 4 KiB."""
SIDE = 12
PLANE = "{motion: static, shape: {type: plane}}"
BODY = "{motion: dynamic, density: 500, shape: {type: box, size: [0.1, 0.1, 0.1]}"


def boxes() -> str:
    """A scene of loose boxes above a floor, on a lattice, apart."""
    places = ((x, y, z) for x in range(SIDE) for y in range(SIDE) for z in range(SIDE))
    lines = [
        f"    box_{index}: {BODY}, position: [{0.2 * x:.1f}, {0.2 * y + 1:.1f}, {0.2 * z:.1f}]}}"
        for index, (x, y, z) in enumerate(places)
    ]
    head = ["duration: 0.25", "fps: 4", "rigid:", "  bodies:", f"    floor: {PLANE}"]
    return "\n".join([*head, *lines, "render: {resolution: [65, 49], samples: 1}"]) + "\n"


def test_settings_longer_than_an_argument_reach_the_simulation_and_the_pictures(fresh):
    """As 600 boxes did not: "Argument list too long", exit 126 and no log."""
    fresh.scene.write_text(boxes())
    segment = fresh.results / "simulation" / "000"
    fresh.dry_run()
    assert not (fresh.folder / "results" / "specs").exists(), "a plan writes nothing"
    fresh.make(segment.relative_to(fresh.folder).as_posix())
    rows = (segment / "bodies.csv").read_text().splitlines()
    assert len(rows) == 1 + 2 * SIDE**3
    assert max(file.stat().st_size for file in (fresh.folder / "results" / "specs").iterdir()) > ARGUMENT


def test_an_edit_names_another_file_of_settings_and_the_two_can_be_compared(project):
    """The reason that Snakemake gives has their names."""
    before = {file.name: file.read_text() for file in (project.folder / "results" / "specs").iterdir()}
    project.edit("samples: 1", "samples: 2")
    assert project.make().stages == {"render", "film"}
    after = {file.name: file.read_text() for file in (project.folder / "results" / "specs").iterdir()}
    (new,) = after.keys() - before.keys()
    lines = set(after[new].splitlines())
    assert any(lines ^ set(old.splitlines()) == {' "samples": 1,', ' "samples": 2,'} for old in before.values())
