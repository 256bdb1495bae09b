"""The materials of a glTF or GLB file. As the specification of glTF 2.0 says, with its extensions named KHR."""

from __future__ import annotations

import math
from typing import Any
from urllib.parse import unquote

from common.imported import gltf
from render.texturing.spec import PICTURES, ImportedImage, ImportedMaterial
from scene.imported.found import Found, beside, printable
from scene.settings import Refused

Values = dict[str, Any]
_EXTENSIONS = {
    "KHR_materials_emissive_strength": {"emissiveStrength": "emission_strength"},
    "KHR_materials_ior": {"ior": "ior"},
    "KHR_materials_transmission": {"transmissionFactor": "transmission"},
    "KHR_materials_clearcoat": {"clearcoatFactor": "coat", "clearcoatRoughnessFactor": "coat_roughness"},
}
"""Those that are understood: their numbers, and what they are called here."""
_MOVED = "KHR_texture_transform"
_OF_MESHES = {"KHR_mesh_quantization", "KHR_draco_mesh_compression", "EXT_meshopt_compression", _MOVED}
_WRAP = {33071: "extend", 33648: "mirror", 10497: "repeat"}
"""What is beyond the edges of an image, as OpenGL numbers it."""


class _Reader:
    """Reads one file, which a scene calls `file`, and notes what it leaves out."""

    def __init__(self, file: str, content: bytes):
        self.file = file
        self.head, self.rest = gltf.parted(content)
        self.left_out: list[str] = []

    def materials(self) -> tuple[ImportedMaterial, ...]:
        """All of them."""
        shapes = [part for mesh in self.head.get("meshes", ()) for part in mesh.get("primitives", ())]
        if not any("material" in part for part in shapes):
            return ()
        found = tuple(ImportedMaterial(**self._material(item)) for item in self.head.get("materials", ()))
        for name in self.head.get("extensionsUsed", ()):
            if name not in {*_EXTENSIONS, *_OF_MESHES} and ("material" in name or "texture" in name):
                self._note(f"the extension {name}")
        if any("material" in part and "COLOR_0" in part.get("attributes", {}) for part in shapes):
            self._note("colours of vertices that have a material")
        return found

    def _note(self, what: str) -> None:
        if printable(what) not in self.left_out:
            self.left_out.append(printable(what))

    def _material(self, given: Values) -> Values:
        surface = given.get("pbrMetallicRoughness", {})
        red, green, blue, alpha = surface.get("baseColorFactor", (1, 1, 1, 1))
        found: Values = {
            "name": str(given.get("name", "")),
            "base": (red, green, blue),
            "metallic": surface.get("metallicFactor", 1.0),
            "roughness": surface.get("roughnessFactor", 1.0),
            "emission": tuple(given.get("emissiveFactor", (0.0, 0.0, 0.0))),
        }
        base = found["base_map"] = self._image(surface.get("baseColorTexture"))
        gloss = surface.get("metallicRoughnessTexture")
        found["roughness_map"] = self._image(gloss, channel="green")
        found["metallic_map"] = self._image(gloss, channel="blue")
        found["normal_map"] = self._image(given.get("normalTexture"))
        found["normal_scale"] = given.get("normalTexture", {}).get("scale", 1.0)
        found["emission_map"] = self._image(given.get("emissiveTexture"))
        if "occlusionTexture" in given:
            self._note("painted shadows (occlusionTexture): light is traced")
        mode = given.get("alphaMode", "OPAQUE")
        if mode != "OPAQUE":
            found["alpha"], found["alpha_map"] = alpha, base
        if mode == "MASK":
            found["cutoff"] = given.get("alphaCutoff", 0.5)
        found |= self._extended(given.get("extensions", {}))
        return {key: value for key, value in found.items() if value is not None}

    def _extended(self, extensions: Values) -> Values:
        found = {}
        for extension, settings in extensions.items():
            for key, value in settings.items():
                if key in _EXTENSIONS.get(extension, ()):
                    found[_EXTENSIONS[extension][key]] = value
                elif extension in _EXTENSIONS:
                    self._note(f"{key} of the extension {extension}")
        return found

    def _image(self, texture: Values | None, **more: Any) -> ImportedImage | None:
        """An image as a material names it; None without one, or where it is in no format that is read."""
        if texture is None:
            return None
        moved = texture.get("extensions", {}).get(_MOVED, {})
        if moved.get("texCoord", texture.get("texCoord", 0)) != 0:
            self._note("an image by the second UV coordinates")
            return None
        stored = self.head["textures"][texture["index"]]
        if "source" not in stored:
            self._note(f"an image in the format of {', '.join(stored.get('extensions', ())) or 'nothing'}")
            return None
        sampler = self.head["samplers"][stored["sampler"]] if "sampler" in stored else {}
        wraps = [_WRAP.get(sampler.get(key, 0), "repeat") for key in ("wrapS", "wrapT")]
        if len(set(wraps)) > 1:
            self._note("different ends of an image to the right and upwards")
        return ImportedImage(**self._stored(stored["source"]), **_placed(moved), wrap=wraps[0], **more)

    def _stored(self, index: int) -> Values:
        """Where an image is: a file, or a number in this one."""
        uri = self.head["images"][index].get("uri", gltf.EMBEDDED)
        if uri.startswith(gltf.EMBEDDED):
            return {"file": self.file, "image": index}
        name = unquote(uri)
        path = beside(self.file, name)
        if not name.lower().endswith(PICTURES):
            fix = f"Save it as one of {', '.join(PICTURES)}"
            raise Refused(f"it names {name!r}, which is in no format of pictures that is read", remedy=fix)
        return {"file": path}


def materials_of(file: str, content: bytes) -> Found:
    """The materials of the file that a scene calls `file`; raises Refused where what it says of them is damaged."""
    try:
        reader = _Reader(file, content)
    except ValueError:
        return Found()  # The reader of triangles says more of it.
    try:
        materials = reader.materials()
    except Refused:
        raise
    except (ValueError, KeyError, IndexError, TypeError, AttributeError, OverflowError) as error:
        what = f"what {file!r} says of its materials cannot be read ({type(error).__name__}: {printable(str(error))})"
        raise Refused(what, remedy="Export it again") from None
    return Found(materials, tuple(reader.left_out))


def _placed(moved: Values) -> Values:
    """How UV coordinates are changed, with (0, 0) at the lower left of the image; in glTF it is the upper left."""
    if not moved:
        return {}
    (x, y), turn, (across, down) = moved.get("offset", (0, 0)), moved.get("rotation", 0.0), moved.get("scale", (1, 1))
    offset = (x + down * math.sin(turn), 1 - y - down * math.cos(turn))
    return {"scale": (across, down), "rotation": math.degrees(turn), "offset": offset}
