"""One scene file: load it, apply a preset, check it, split it into the stages' settings."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

from annotated_types import Le, Len
from pydantic import Field

from common.distribution import HOME
from render.looks.spec import Colormap, Palette
from render.spec import RenderSpec
from render.texturing.spec import Imported, images_of
from scene import assets
from scene.diagnostics.problems import validated
from scene.diagnostics.suggestions import suggestion
from scene.diagnostics.support import refuse_unsupported
from scene.document import Document, SceneError, dotted
from scene.imported.bodies import about_image, with_imported
from scene.names import FLUID, Named, resolve, resolve_one
from scene.presets import QUALITIES, Quality, below
from scene.reader import assign, read
from scene.settings import Caution, Refused
from scene.units import PositiveDuration
from scene.wedge import MARK, Combination, combinations
from sim.foam.spec import FoamSpec
from sim.geometry.spec import MeshSurface
from sim.spec import SimulationSpec
from workflow.stages.film.spec import FilmSpec
from workflow.stages.surface.spec import SurfaceSpec

BUDGET, ACCURACY, CHANGED = "budget", "accuracy", "changed"
"""The quality of scenes whose settings were chosen for a time, for an error, and by the command of a film."""


LOOKS = {"water": "render.water", "foam": "render.foam", "ground": "render.ground.material"}
"""Where looks are given that are of no body."""


class SceneFile(SimulationSpec):
    """A scene: what is simulated, how its surface is found, how it is rendered."""

    description: str = ""
    """What the scene shows, in a sentence."""
    duration: Annotated[PositiveDuration, Le(3600)]
    """Simulated time [s]."""
    quality: Quality = "standard"
    """The preset that applies when none is requested."""
    presets: Annotated[dict[Quality, dict[str, Any]], Field(default_factory=dict)]
    """Settings that override the scene's own, by preset."""
    surface: SurfaceSpec = Field(default_factory=SurfaceSpec)
    foam: FoamSpec | None = None
    """Foam, spray and air bubbles of the fluid; none if left out, `foam: {}` for all defaults."""
    render: RenderSpec = Field(default_factory=RenderSpec)
    film: FilmSpec = Field(default_factory=FilmSpec)
    wedge: dict[str, Annotated[tuple[Any, ...], Len(1, 1000)]] = {}
    """Values to try, by the dotted path of a setting: each combination becomes a film, and `snakemake wedges/NAME`
    one sheet and one table of all."""


@dataclass(frozen=True)
class Scene:
    """A valid scene at one quality, split by stage."""

    name: str
    path: Path
    quality: str
    duration: float
    simulation: SimulationSpec
    surface: SurfaceSpec
    foam: FoamSpec | None
    render: RenderSpec
    film: FilmSpec
    wedge: tuple[Combination, ...]
    assets: dict[str, str]
    document: Document
    """With the preset and the overrides."""
    written: Document
    """As the file is."""
    overrides: tuple[str, ...] = ()

    @property
    def folder(self) -> Path:
        """Where relative paths of the scene start."""
        return self.path.parent

    @property
    def last_frame(self) -> int:
        """Frames are 0 to last_frame; frame 0 is the initial state."""
        return round(self.duration * self.simulation.fps)

    def error(self, refused: Refused) -> SceneError:
        """The refusal with its line in the scene file."""
        return SceneError([self.document.problem(refused.location, refused.message, refused.remedy)])

    def warning(self, caution: Caution) -> str:
        """The caution in one line, with its field and its line in the scene file."""
        mark, field = self.document.mark(caution.location), dotted(caution.location)
        place = f"line {mark.line}: " if mark.line and field else ""
        return f"warning: {place}{field}{': ' if field else ''}{caution.text}"


def load(path: Path, *, quality: str | None = None, overrides: Sequence[str] = (), root: Path | None = None) -> Scene:
    """Load the scene at `path`; `root` (default: the working directory) bounds what it may write. The values of its
    wedge are not looked at: `combination_of` does.

    Raises SceneError, whose text names file, line, field and remedy of every problem.
    """
    return _prepare(read(path), path, quality, overrides, root)


def _prepare(
    written: Document, path: Path, quality: str | None, overrides: Sequence[str], root: Path | None = None
) -> Scene:
    """The scene that a file holds as it is written, at a preset and with overrides."""
    document = written
    if quality is None:
        quality = document.data.get("quality", SceneFile.model_fields["quality"].default)
    if quality not in QUALITIES:
        raise SceneError(
            [document.problem(("quality",), f"no preset '{quality}'", suggestion(str(quality), QUALITIES))]
        )
    document = Document(document.source, below(document.data, str(quality)), document.marks)
    document = document.merge(("presets", str(quality)))
    for override in overrides:
        if override.partition("=")[0].partition(".")[0].strip() in {"quality", "presets"}:
            raise SceneError([f"--set {override}: presets are chosen before\n  fix: use --quality {quality}"])
        assign(document, override)
    return replace(compose(document, path, str(quality), root), written=written, overrides=tuple(overrides))


def compose(document: Document, path: Path, quality: str, root: Path | None = None) -> Scene:
    """The scene that a document holds, checked as `load` does, whose presets and overrides were applied."""
    scene = _split(document, path, quality)
    try:
        _check_across_stages(scene)
        _check_writes(scene, root or Path.cwd())
        refuse_unsupported(scene.simulation)
        scene = replace(scene, render=with_imported(scene.render, resolve(scene.simulation), scene.folder))
        digests = _find_assets(scene)
    except Refused as refused:
        raise scene.error(refused) from None
    return replace(scene, assets=digests)


def combination_of(scene: Scene, name: str, overrides: Sequence[str] = ()) -> Scene:
    """The scene, which was loaded with these overrides, at one combination of its wedge; raises SceneError."""
    known = {combination.name: combination for combination in scene.wedge}
    if name not in known:
        fix = suggestion(name, known) if known else "give the scene a `wedge:`, or leave out what follows the @"
        raise SceneError([f"{scene.path}: its wedge has no combination '{name}'\n  fix: {fix}"])
    try:
        found = _prepare(scene.written, scene.path, scene.quality, (*overrides, *known[name].overrides))
    except SceneError as error:
        mark = scene.document.mark(("wedge",))
        where = f"{mark.source}:{mark.line}: wedge: "
        raise SceneError([problem.replace("--set ", where, 1) for problem in error.problems]) from None
    return replace(found, name=f"{found.name}{MARK}{name}")


def name_of(path: Path) -> str:
    """`scenes/tiny/splash.yaml` is the scene `tiny/splash`, in the working directory and among those that come with
    this software."""
    whole = path.absolute()
    near = next((root for root in (Path.cwd(), HOME) if whole.is_relative_to(root)), Path(whole.anchor))
    parts = whole.relative_to(near).with_suffix("").parts
    return "/".join(parts[parts.index("scenes") + 1 :]) if "scenes" in parts[:-1] else path.stem


def _split(document: Document, path: Path, quality: str) -> Scene:
    whole = validated(document, SceneFile)
    frames = whole.duration * whole.fps
    if not _whole(frames):
        message = f"{whole.duration:g} s at {whole.fps:g} frames a second are {frames:.9g} frames"
        remedy = f"use a whole number of frames, for example {_seconds(max(1, math.ceil(frames)), whole.fps)} s"
        raise SceneError([document.problem(("duration",), message, remedy)])
    simulation = SimulationSpec(**{name: getattr(whole, name) for name in SimulationSpec.model_fields})
    return Scene(
        name=name_of(path),
        path=path,
        quality=quality,
        duration=whole.duration,
        simulation=simulation,
        surface=whole.surface,
        foam=whole.foam,
        render=whole.render,
        film=whole.film,
        wedge=_combinations(whole.wedge, document),
        assets={},
        document=document,
        written=document,
    )


def _combinations(wedge: dict[str, tuple[Any, ...]], document: Document) -> tuple[Combination, ...]:
    for path in wedge:
        if path.partition(".")[0] in {"quality", "presets", "wedge", "description"}:
            remedy = "give paths of settings, as fluid.viscosity; presets are chosen by --config quality=..."
            raise SceneError([document.problem(("wedge", path), "this cannot be varied", remedy)])
    try:
        return tuple(combinations(wedge))
    except Refused as refused:
        raise SceneError([document.problem(refused.location, refused.message, refused.remedy)]) from None


def _whole(frames: float) -> bool:
    return round(frames) >= 1 and abs(frames - round(frames)) <= 1e-6


def _seconds(frames: int, fps: float) -> str:
    """The shortest decimal number of seconds that has this many frames."""
    texts = (f"{frames / fps:.{digits}g}" for digits in range(1, 18))
    return next((text for text in texts if round(float(text) * fps) == frames and _whole(float(text) * fps)), "")


def _check_across_stages(scene: Scene) -> None:
    found = resolve(scene.simulation)
    if scene.foam is not None and scene.simulation.fluid is None:
        raise Refused("the scene has no fluid that could foam", location=("foam",), remedy="remove it, or add a fluid")
    if scene.render.wetness is not None and scene.simulation.fluid is None:
        message = "the scene has no fluid that could wet anything"
        raise Refused(message, location=("render", "wetness"), remedy="remove it, or add a fluid")
    if scene.render.background.type == "transparent":
        scene.film.refuse_opaque()
    _check_attributes(scene)
    for name in scene.render.named_bodies():
        location = ("render", "materials", name)
        if name in LOOKS and name not in found:
            remedy = f"give the look as {LOOKS[name]}"
            raise Refused(
                f"materials are of bodies, sheets and containers, and none is named '{name}'",
                location=location,
                remedy=remedy,
            )
        kind = resolve_one(name, found, location).kind
        if kind in FLUID:
            message = f"'{name}' is {kind}: all of the fluid has one look"
            raise Refused(message, location=location, remedy="give it as render.water, which may be of any type")
        _check_images(name, scene.render.materials[name], found[name])


def _check_images(name: str, look: Any, item: Named) -> None:
    """Images lie on rigid bodies that end somewhere."""
    shape = getattr(item.body, "shape", None)
    if item.kind == "a rigid body" and getattr(shape, "type", None) != "plane":
        return
    first = next(images_of(look), None)
    if first is not None or isinstance(look, Imported):
        where = first[0] if first is not None else ("type",)
        kind = "a plane" if item.kind == "a rigid body" else item.kind
        message = f"'{name}' is {kind}: images lie on rigid bodies alone, and on the ground"
        remedy = "give it a color, or give the image to render.ground.material, with a texture_size"
        raise Refused(message, location=("render", "materials", name, *where), remedy=remedy)


def _check_attributes(scene: Scene) -> None:
    """Colours come from attributes that the surface of the water has, if it is asked for them."""
    asked = scene.surface.attributes
    if asked and scene.simulation.fluid is None:
        message = "the scene has no fluid, whose surface could say something"
        raise Refused(message, location=("surface", "attributes"), remedy="remove it, or add a fluid")
    for path, look in scene.render.looks().items():
        if not isinstance(look, Colormap | Palette):
            continue
        location = ("render", *path)
        if path != ("water",):
            message = f"only the surface of the water has attributes that a {look.type} shows"
            raise Refused(message, location=location, remedy="give it as render.water, or use another look here")
        key, shown = ("attribute", look.attribute) if isinstance(look, Colormap) else ("type", "source")
        if shown not in asked:
            message = f"the surface has no '{shown}', since surface.attributes does not name it"
            remedy = f"give surface: {{attributes: [{', '.join((*asked, shown))}]}}"
            raise Refused(message, location=(*location, key), remedy=remedy)
        if isinstance(look, Palette):
            _check_palette(look, scene.simulation.fluid_sources(), (*location, "colors"))


def _check_palette(look: Palette, sources: Sequence[str], location: tuple[str | int, ...]) -> None:
    """Each source has its colour, and nothing else has one."""
    for name in look.colors:
        if name not in sources:
            message = f"there is no fluid body or emitter named '{name}'"
            raise Refused(message, location=(*location, name), remedy=suggestion(name, sources))
    missing = [name for name in sources if name not in look.colors]
    if missing:
        remedy = f"give {missing[0]}: '#48abc9', or another colour"
        raise Refused(f"'{missing[0]}' has no colour, and fluid comes from it", location=location, remedy=remedy)


def _check_writes(scene: Scene, root: Path) -> None:
    try:
        scene.film.copy_path(root)
    except (OSError, ValueError):
        remedy = "give a path below the project's folder, such as gallery/film.mp4"
        raise Refused("this is not a path", location=("film", "copy_to"), remedy=remedy) from None


def _find_assets(scene: Scene) -> dict[str, str]:
    """The digest of every file that the scene reads, by its name in the scene."""
    wanted = [
        ((*location, "shape", "file"), body.shape.file)
        for location, body in scene.simulation.placements()
        if isinstance(getattr(body, "shape", None), MeshSurface)
    ]
    digests = {}
    for location, file in wanted:
        try:
            digests[file] = assets.digest(assets.resolve(file, scene.folder))
        except Refused as refused:
            raise refused.at(*location) from None
    for place, file in scene.render.assets():
        if file not in digests:
            try:
                digests[file] = assets.digest(assets.resolve(file, scene.folder))
            except Refused as refused:
                raise about_image(refused, place, resolve(scene.simulation), scene.render) from None
    return digests
