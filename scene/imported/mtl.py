"""The materials of an OBJ: files in MTL, as Wavefront described it, with what modelling programs have added."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from common.imported import wavefront
from render.texturing.spec import PICTURES, ImportedImage, ImportedMaterial
from scene.imported.found import Found, beside, printable
from scene.settings import Refused

MOST_BYTES = 10_000_000
"""Of one MTL file."""
Read = Callable[[str], bytes]
"""Takes the name of a file, as a scene would name it, and returns what is in it; raises Refused."""
Values = dict[str, Any]

_MAPS: dict[str, tuple[str, Values, str | None]] = {
    "map_kd": ("base_map", {"base": (1.0, 1.0, 1.0)}, None),
    "map_ke": ("emission_map", {"emission": (1.0, 1.0, 1.0)}, None),
    "map_d": ("alpha_map", {}, "red"),
    "map_pr": ("roughness_map", {"roughness": 1.0}, "red"),
    "map_pm": ("metallic_map", {"metallic": 1.0}, "red"),
    "norm": ("normal_map", {}, None),
    "map_kn": ("normal_map", {}, None),
}
"""The setting of an image, the numbers that it stands in for, and the channel that counts; of keys in any case, as
map_Kd, map_Pr, map_Pm, map_Kn."""
_OF_NO_LIGHT = {"ka", "map_ka", "illum", "tf", "sharpness", "map_aat"}
"""What says nothing, or nothing that traced light would not find by itself."""
_LEFT_OUT = {
    "bump": "relief by heights",
    "map_bump": "relief by heights",
    "disp": "displacement",
    "decal": "a decal",
    "refl": "a painted reflection",
    "map_ks": "an image of the gloss",
    "map_ns": "an image of the gloss",
    "aniso": "anisotropy",
    "anisor": "the direction of anisotropy",
    "ps": "a sheen",
}
"""What no picture shows, as map_Bump."""
_VECTORS = ("-s", "-o", "-t")
_OPTIONS = {
    **dict.fromkeys(_VECTORS, 3),
    "-mm": 2,
    **dict.fromkeys(("-bm", "-blendu", "-blendv", "-boost", "-cc", "-clamp", "-imfchan", "-texres", "-type"), 1),
}
"""Of images, and how many words follow, at most."""


def materials_of(file: str, content: bytes, read: Read) -> Found:
    """The materials of the OBJ that a scene calls `file`, in the order in which faces name them.

    Raises Refused for an MTL file that is not there or cannot be read, and for an image in no format that is read.
    """
    libraries, used = wavefront.libraries(content), wavefront.materials(content)
    if not libraries or not used:
        return Found()
    known: dict[str, Values] = {}
    left_out: list[str] = []
    names = tuple(beside(file, library) for library in libraries)
    for name in names:
        _add(name, _text(name, read), known, left_out)
    for name in (name for name in used if name not in known):
        _note(left_out, f"the material {name!r}, which is not in {', '.join(libraries)}")
    materials = (ImportedMaterial(name=name, **{"base": (0.8, 0.8, 0.8)} | known.get(name, {})) for name in used)
    return Found(tuple(materials), tuple(left_out), names)


def _text(name: str, read: Read) -> str:
    content = read(name)
    if len(content) > MOST_BYTES or b"\0" in content:
        raise Refused(f"the materials {name!r} are no text of at most 10 MB", remedy="Export the mesh again")
    return content.decode("utf-8", "replace")


def _add(name: str, text: str, known: dict[str, Values], left_out: list[str]) -> None:
    """Add what a file says of materials to what is known, by their names."""
    values: Values = {}
    for number, words in _lines(text):
        key, rest = words[0].lower(), words[1:]
        try:
            if key == "newmtl":
                values = known.setdefault(" ".join(rest), {})
            elif key in _MAPS:
                _take_image(name, key, rest, values, left_out)
            elif key in _VALUES:
                _take_value(key, rest, values)
            elif key not in _OF_NO_LIGHT:
                _note(left_out, f"{_LEFT_OUT.get(key, 'a setting')} ({words[0]})")
        except (ValueError, IndexError):
            line = " ".join(words)[:80]
            raise Refused(f"line {number} of {name!r} says nothing: {line!r}", remedy="Export the mesh again") from None


def _lines(text: str) -> Iterator[tuple[int, list[str]]]:
    for number, line in enumerate(text.splitlines(), 1):
        words = line.partition(" #")[0].split()
        if words and not words[0].startswith("#"):
            yield number, words


def _note(left_out: list[str], what: str) -> None:
    if printable(what) not in left_out:
        left_out.append(printable(what))


def _take_value(key: str, words: list[str], values: Values) -> None:
    """What was said before stays, or came from an image; but `Pr` says more of roughness than `Ns`."""
    setting, convert = _VALUES[key]
    if key == "pr" and "roughness_map" not in values:
        values[setting] = convert(words)
    values.setdefault(setting, convert(words))


def _take_image(name: str, key: str, words: list[str], values: Values, left_out: list[str]) -> None:
    setting, stands_for, channel = _MAPS[key]
    image = _image(name, words, left_out)
    # The same picture again holds the opacity beside the colours.
    with_colors = setting == "alpha_map" and "base_map" in values and values["base_map"].file == image["file"]
    values[setting] = ImportedImage(**image, channel=None if with_colors else channel)
    values.update(stands_for)


def _image(name: str, words: list[str], left_out: list[str]) -> Values:
    """The settings of an image: options, then a name that may hold blanks."""
    found: Values = {}
    while words and words[0].lower() in _OPTIONS:
        option, words = words[0].lower(), words[1:]
        given: list[str] = []
        while words and len(given) < _OPTIONS[option] and (option not in _VECTORS or _is_number(words[0])):
            given, words = [*given, words[0]], words[1:]
        if option == "-s":
            found["scale"] = (*map(float, given[:2]), 1.0)[:2]
        elif option == "-o":
            found["offset"] = (*map(float, given[:2]), 0.0)[:2]
        elif option == "-clamp":
            found["wrap"] = "extend" if given == ["on"] else "repeat"
        else:
            _note(left_out, f"the option {option} of an image")
    file = " ".join(words)
    if not file:
        raise ValueError("no file")
    if not file.lower().endswith(PICTURES):
        fix = f"Save it as one of {', '.join(PICTURES)}"
        raise Refused(f"{name!r} names {file!r}, which is in no format of pictures that is read", remedy=fix)
    return found | {"file": beside(name, file)}


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _color(words: list[str]) -> tuple[float, float, float]:
    red, *others = (max(0.0, float(word)) for word in words[:3])
    green, blue = others if len(others) == 2 else (red, red)
    return (red, green, blue)


def _share(words: list[str]) -> float:
    return min(1.0, max(0.0, float(words[-1])))


_VALUES: dict[str, tuple[str, Callable[[list[str]], Any]]] = {
    "kd": ("base", _color),
    "ks": ("specular", lambda words: min(1.0, sum(_color(words)) / 3)),
    "ke": ("emission", _color),
    # What the exponent of Phong's highlight says of roughness, as Blender reads it.
    "ns": ("roughness", lambda words: 1 - (min(1000.0, max(0.0, float(words[0]))) / 1000) ** 0.5),
    "pr": ("roughness", _share),
    "ni": ("ior", lambda words: min(10.0, max(1.0, float(words[0])))),
    "d": ("alpha", _share),
    "tr": ("alpha", lambda words: 1 - _share(words)),
    "pm": ("metallic", _share),
    "pc": ("coat", _share),
    "pcr": ("coat_roughness", _share),
}
"""The setting of a number or colour, and what it is of what the file says."""
