"""What is no YAML, or too much of it, is refused; what YAML 1.1 misreads is read as it looks."""

from __future__ import annotations

import pytest

BOMB = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]\n" for i in range(1, 12)
)

BROKEN = {
    "tab": ("x:\n\ty: 1", "\ty", "spaces instead of tabs"),
    "open bracket": ("x: [1, 2", "x: [", "close the bracket"),
    "open quotes": ('x: "abc', 'x: "', "close the quotes"),
    "two colons": ("x: y: z", "x: y", "in quotes"),
    "unknown alias": ("x: *nope", "x: *", "undefined alias 'nope'", "&"),
    "second document": ("---\nx: 1", "---", "one scene in a file"),
    "merge key": ("x: {<<: {a: 1}}", "x: {", "merge keys"),
    "list as a key": ("? [a, b]\n: 1", "? [", "name of a setting"),
    "no name": ('"": 1', '""', "name of a setting"),
    "local tag": ("x: !thing 3", "x: !", "'!thing'", "remove the tag"),
    "binary tag": ("x: !!binary aGVsbG8=", "x: !", "!!binary"),
    "set tag": ("x: !!set {a, b}", "x: !", "!!set"),
    "wrong whole number": ("x: !!int abc", "x: !", "'abc' is no !!int"),
    "wrong number": ("x: !!float abc", "x: !", "'abc' is no !!float"),
    "wrong truth": ("x: !!bool abc", "x: !", "'abc' is no !!bool"),
    "wrong node": ("x: !!map abc", "x: !", "!!map"),
    "alias within itself": ("x: &x [*x]", "x: &", "more nesting or more values"),
    "alias bomb": (BOMB, "", "more nesting or more values"),
    "merge bomb": (BOMB.replace("[", "{<<: [").replace("]", "]}"), "a0: ", "merge keys"),
    "deep list": (f"x: {'[' * 5000}{']' * 5000}", "x: [", "more nesting or more values"),
    "deep mapping": (f"x: {'{a: ' * 5000}{'}' * 5000}", "x: {", "more nesting or more values"),
    "deep indentation": ("\n".join(f"{'  ' * depth}x{depth}:" for depth in range(500)), "x39:", "more nesting"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_broken_yaml(bench, scene, case):
    more, at, *words = BROKEN[case]
    bench.refuses(scene(more=more), *words, at=at)


def test_no_python_object_is_made(bench, scene, tmp_path):
    trace = tmp_path / "trace"
    call = f"!!python/object/apply:os.system ['touch {trace}']"
    bench.refuses(
        scene(more=f"description: {call}"), "description", "python/object", "remove the tag", at="description"
    )
    bench.refuses(scene(more=f"? {call}\n: 1"), "name of a setting", at="? !!python")
    bench.refuses(scene(), "no value of a setting", options=("--set", f"description={call}"))
    assert not trace.exists()


FILES = {
    "empty": (b"", "the file is empty"),
    "a comment": (b"# nothing\n", "the file is empty"),
    "a list": (b"- a\n- b\n", "a scene is a mapping"),
    "a word": (b"hello\n", "a scene is a mapping"),
    "binary": (bytes(range(256)), "UTF-8"),
    "control characters": (b"a: \x07\n", "not YAML"),
    "zero byte": (b"a: \x00\n", "not YAML"),
    "utf-16": ("fps: 12\n".encode("utf-16"), "UTF-8"),
}


@pytest.mark.parametrize("case", FILES)
def test_a_file_that_is_no_scene(bench, case):
    content, words = FILES[case]
    said = bench.refuses(content, words)
    assert str(bench.path) in said


def test_a_file_that_is_too_large(bench, monkeypatch):
    monkeypatch.setattr("scene.reader.MAX_BYTES", 1000)
    bench.refuses(b"a: b\n" * 300, "larger than any scene file, 1,500 bytes")


def test_a_folder_is_no_scene(bench):
    status, said = bench.check(path=bench.folder)
    assert status == 2 and "cannot be read" in said


def test_numbers_of_yaml_1_2(bench, scene):
    text = scene(more="film: {crf: +018}\nsurface: {cube_size: 1.}\nrender: {exposure: -.5}")
    bench.accepts(text.replace("25 mm", "2.5e-2") + "gravity: [0, -1e1, 0]\n")


def test_signs_that_look_like_those_of_yaml(bench, scene):
    """A minus sign, no-break blanks before keys and values, and what cannot be seen."""
    text = scene(more="gravity: [0, \u22129.81, 0]\nrender: {exposure: \u22121e\u22121}\ndescription: 5\u00a0mm")
    text = text.replace("  particle_radius: 25 mm", "\u00a0\u00a0particle_radius:\u202f25\u00a0mm")
    bench.accepts(text.replace("viscosity", "visco\u200bsity"))


def test_lines_count_as_in_an_editor(bench, scene):
    bench.refuses(scene(more="frames: 1").replace("\n", "\r\n").encode(), "unknown key 'frames'", at="frames")
    bench.refuses(("\ufeff" + scene(more="frames: 1")).encode(), "unknown key 'frames'", at="frames")
    bench.accepts("\ufeff" + scene())
