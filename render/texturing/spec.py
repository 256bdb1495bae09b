"""Typed settings of images on bodies, and of the materials that mesh files bring."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Literal, Self

from annotated_types import Ge, Le
from pydantic import AfterValidator, Field, model_validator

from scene.settings import Settings
from scene.units import Angle, Dimensionless, PositiveLength

Fraction = Annotated[Dimensionless, Ge(0), Le(1)]
Factor = Annotated[Dimensionless, Ge(0), Le(1e6)]
PICTURES = (".hdr", ".exr", ".png", ".jpg", ".jpeg", ".tif", ".tiff")


def picture(file: str) -> str:
    """A file by whose name it is a picture; raises ValueError for others, as films."""
    if not file.lower().endswith(PICTURES):
        raise ValueError(f"the file must end in {', '.join(PICTURES)}: save the picture as one of these")
    return file


Picture = Annotated[str, Field(min_length=1), AfterValidator(picture)]
Place = tuple[str | int, ...]
"""Path of keys to a setting."""


class Textured(Settings):
    """A look that images may give to a body or to the ground."""

    texture: Picture | None = None
    """Image of the base colour, in place of `color`: a file, relative to the scene file."""
    normal_map: Picture | None = None
    """Image of the directions of fine relief, with green upwards as in OpenGL."""
    projection: Literal["uv", "box", "sphere"] | None = None
    """How images lie on a body: `uv`, as the UV coordinates of its mesh file say; `box`, upright on its sides along the
    axes of the shape as it is given, before it is turned; `sphere`, once around, with its poles above and below.
    Without it, `uv` where the file has UV coordinates, and `box` elsewhere."""
    texture_size: PositiveLength | None = None
    """Of `box`: width of the images [m], which repeat; without it, the longest edge of the body."""

    IMAGES: ClassVar[tuple[str, ...]] = ("texture", "normal_map")

    @model_validator(mode="after")
    def _images_are_there(self) -> Self:
        for setting in ("projection", "texture_size"):
            if getattr(self, setting) is not None and not any(self.images()):
                raise ValueError(f"{setting} is about images: give a texture, or leave it out")
        if self.texture_size is not None and self.projection in {"uv", "sphere"}:
            raise ValueError(f"projection {self.projection} has no texture_size: leave it out, or use box")
        return self

    def images(self) -> Iterator[tuple[Place, str, int | None]]:
        """Where an image is named, its file, and its number in it."""
        for setting in self.IMAGES:
            file = getattr(self, setting)
            if file is not None:
                yield (setting,), file, None


class Rough(Textured):
    """A look whose gloss an image may give, too."""

    roughness_map: Picture | None = None
    """Image of the roughness, black for 0 and white for 1."""

    IMAGES: ClassVar[tuple[str, ...]] = ("texture", "roughness_map", "normal_map")


Linear = tuple[Factor, Factor, Factor]


class ImportedImage(Settings):
    """An image of an imported material."""

    file: Annotated[str, Field(min_length=1)]
    """A picture, or the GLB or glTF that holds it, relative to the scene file."""
    image: Annotated[int, Ge(0)] | None = None
    """Its number in a GLB or glTF."""
    channel: Literal["red", "green", "blue"] | None = None
    """The one that counts, where that is not all of it."""
    scale: tuple[Dimensionless, Dimensionless] = (1.0, 1.0)
    """Factors on the UV coordinates, before they are turned and moved."""
    rotation: Angle = 0.0
    offset: tuple[Dimensionless, Dimensionless] = (0.0, 0.0)
    wrap: Literal["repeat", "mirror", "extend"] = "repeat"
    """What is beyond its edges."""

    @model_validator(mode="after")
    def _is_a_picture(self) -> Self:
        if self.image is None:
            picture(self.file)
        elif not self.file.lower().endswith((".glb", ".gltf")):
            raise ValueError("only a .glb or .gltf holds images: leave out image")
        return self


class ImportedMaterial(Settings):
    """One material of a mesh file, in the words of glTF; images are multiplied by the numbers beside them."""

    name: str = ""
    base: Linear = (1.0, 1.0, 1.0)
    """Base colour in linear light."""
    base_map: ImportedImage | None = None
    alpha: Fraction = 1.0
    """Opacity."""
    alpha_map: ImportedImage | None = None
    """Image whose opacity counts, or one channel of it."""
    cutoff: Fraction | None = None
    """Opacity from which on it is opaque, below it is not there."""
    metallic: Fraction = 0.0
    metallic_map: ImportedImage | None = None
    roughness: Fraction = 0.5
    roughness_map: ImportedImage | None = None
    normal_map: ImportedImage | None = None
    normal_scale: Dimensionless = 1.0
    emission: Linear = (0.0, 0.0, 0.0)
    emission_map: ImportedImage | None = None
    emission_strength: Annotated[Dimensionless, Ge(0)] = 1.0
    specular: Fraction = 0.5
    ior: Annotated[Dimensionless, Ge(0), Le(10)] = 1.5
    transmission: Fraction = 0.0
    coat: Fraction = 0.0
    coat_roughness: Fraction = 0.0

    MAPS: ClassVar[tuple[str, ...]] = (
        *("base_map", "alpha_map", "metallic_map", "roughness_map", "normal_map", "emission_map"),
    )


class Imported(Settings):
    """The materials that the body's mesh file brings (OBJ with MTL, GLB, glTF, PLY): what a body has whose file brings
    some, unless `materials` gives it another look."""

    type: Literal["imported"]
    materials: tuple[ImportedMaterial, ...] = ()
    """By their numbers in the file; read from there."""

    def images(self) -> Iterator[tuple[Place, str, int | None]]:
        """Where an image is named, its file, and its number in it."""
        for index, material in enumerate(self.materials):
            for setting in material.MAPS:
                found = getattr(material, setting)
                if found is not None:
                    yield ("materials", index, setting, "file"), found.file, found.image


def images_of(look: Any) -> Iterator[tuple[Place, str, int | None]]:
    """Where a look names images, their files, and their numbers in them."""
    return look.images() if isinstance(look, Textured | Imported) else iter(())
