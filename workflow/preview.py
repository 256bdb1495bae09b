"""A picture of one frame in seconds, from the files of the simulation and of the surface, without Blender.

    python -m workflow.preview bunny                      the last frame that there is
    python -m workflow.preview bunny --frame 24           that one, to results/bunny/standard/preview/00024.png
    python -m workflow.preview bunny --particles          the particles, also where the surface is there
    python -m workflow.preview scenes/bunny.yaml --simulation out --out frame.png

The camera is that of the film. Particles are coloured by their speed, from dark to bright; the picture says how fast.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from common.command import as_called, end_with
from common.distribution import HOME
from common.ply import BadPly, columns, read_points
from common.simulation_files import BadTable, BodyTable, frames_of_files
from render.content.axes import z_up, z_up_columns
from render.content.framing import View, view_of
from render.content.ply import read_mesh
from render.errors import RenderError, Unusable
from render.inputs import Inputs
from scene.document import SceneError
from scene.load import Scene, load
from scene.presets import QUALITIES
from scene.settings import Refused
from workflow.plan.jobs import Plan
from workflow.plan.shelf import SCENE_FILES

WATER, FOAM, CLOTH, CONTAINER = "#3f8fb5", "#f3f7f9", "#b23a48", "#8a949b"
COMMAND = "python -m workflow.preview"
BODIES = ("#e4572e", "#f3a712", "#669bbc", "#a8c686", "#8d6a9f")
BACKGROUND = ("#e9e6df", "#b9cbd6")
"""Below and above."""
PAINT = ("red", "green", "blue")
WIDTH = 960


@dataclass(frozen=True)
class Frame:
    """Where the files of one frame are."""

    number: int
    simulation: Path
    surface: Path | None
    foam: Path | None = None


def frames(simulations: list[Path], surfaces: list[Path], foams: Sequence[Path] = ()) -> dict[int, Frame]:
    """All frames of which a simulation left files, by number."""
    meshed = {_number(path): path.parent for folder in surfaces for path in folder.glob("surface_*.ply")}
    foamed = {_number(path): path.parent for folder in foams for path in folder.glob("foam_*.ply")}
    found: dict[int, Frame] = {}
    for folder in simulations:
        table = BodyTable(folder)
        numbers = frames_of_files(folder) or set(table.times() if table.path.exists() else ())
        found |= {number: Frame(number, folder, meshed.get(number), foamed.get(number)) for number in sorted(numbers)}
    return found


def draw(
    scene: Scene, frame: Frame, out: Path, *, particles: bool = False, size: tuple[int, int] | None = None
) -> None:
    """Write the picture of a frame; raises Unusable and BadPly for files that cannot be drawn."""
    import pyvista
    from vtkmodules.vtkCommonCore import vtkLogger

    # It warns wherever there is no display.
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)
    width, height = scene.render.resolution
    size = (WIDTH, round(WIDTH * height / width))
    time = frame.number / scene.simulation.fps
    inputs = Inputs(frame.simulation, frame.surface, frame.foam)
    plotter = pyvista.Plotter(off_screen=True, window_size=list(size))
    plotter.enable_anti_aliasing("msaa")
    plotter.set_background(BACKGROUND[0], top=BACKGROUND[1])  # type: ignore[arg-type]  # the wrapper's type leaves out self
    for path in inputs.containers().values():
        points, triangles = _mesh(path)
        edges = pyvista.make_tri_mesh(points, triangles).extract_feature_edges(30)
        plotter.add_mesh(edges, color=CONTAINER, line_width=2)
    poses = inputs.poses([frame.number])[frame.number]
    for index, (name, path) in enumerate(inputs.bodies().items()):
        points, triangles = _mesh(path)
        if name in poses:
            points = points @ _rotation(poses[name].rotation).T + poses[name].position
            color = _color(scene, name, _painted(path) or BODIES[index % len(BODIES)])
            _add(plotter, points, triangles, color)
    for name in inputs.sheets():
        sheet = inputs.sheet(name, frame.number)
        if sheet is not None:
            _add(plotter, *_mesh(sheet), _color(scene, name, CLOTH))
    surface, colours = inputs.water(frame.number), ""
    fluid = frame.simulation / f"fluid_{frame.number:05d}.ply"
    if surface is not None and not particles:
        _add(plotter, *_mesh(surface), WATER)
    elif scene.simulation.fluid is not None and fluid.exists():
        colours = _add_particles(plotter, fluid, scene.simulation.fluid.particle_radius)
    foam = inputs.bubbles(frame.number)
    if foam is not None:
        _add_foam(plotter, foam)
    _place(plotter.camera, view_of(scene.render.camera, inputs.extent(), size, time))
    plotter.add_text(f"{scene.name}  frame {frame.number}{colours}", font_size=9, color="#333333")
    out.parent.mkdir(parents=True, exist_ok=True)
    plotter.screenshot(out)
    plotter.close()


def _add(plotter: Any, points: np.ndarray, triangles: np.ndarray, color: Any) -> None:
    import pyvista

    if len(triangles):
        mesh = pyvista.make_tri_mesh(points, triangles)
        look = {"color": color}
        if isinstance(color, list):
            mesh["paint"] = np.column_stack(color).astype(np.uint8)
            look = {"scalars": "paint", "rgb": True}
        plotter.add_mesh(mesh, **look, smooth_shading=True, split_sharp_edges=True, specular=0.3)


def _add_particles(plotter: Any, path: Path, radius: float) -> str:
    """Draw particles; returns what their colours mean."""
    import pyvista

    points = read_points(path)
    if not len(points):
        return ""
    cloud = pyvista.PolyData(z_up_columns(*(points[axis] for axis in "xyz")).reshape(-1, 3))
    speed = np.linalg.norm(columns(points, ("vx", "vy", "vz")), axis=1)
    fastest = max(float(np.percentile(speed, 99)), 1e-3)
    actor = plotter.add_mesh(
        cloud,
        scalars=speed,
        clim=(0.0, fastest),
        cmap="YlGnBu_r",
        style="points_gaussian",
        emissive=False,
        render_points_as_spheres=True,
        show_scalar_bar=False,
    )
    actor.mapper.scale_factor = radius
    return f"  speed 0 to {fastest:.2g} m/s"


def _add_foam(plotter: Any, path: Path) -> None:
    import pyvista

    points = read_points(path)
    if len(points):
        cloud = pyvista.PolyData(z_up_columns(*(points[axis] for axis in "xyz")).reshape(-1, 3))
        actor = plotter.add_mesh(cloud, color=FOAM, style="points_gaussian", emissive=False)
        actor.mapper.scale_factor = float(points["radius"].mean())


def _mesh(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Points, z up [m], shape [n, 3], and triangles."""
    mesh = read_mesh(path)
    points = z_up_columns(*(np.asarray(mesh.columns[axis]) for axis in "xyz")).reshape(-1, 3)
    return points, np.asarray(mesh.triangles, dtype=np.int64).reshape(-1, 3)


def _painted(path: Path) -> Any:
    """Colours of the vertices, from 0 to 255, where the file has them."""
    mesh = read_mesh(path)
    return [mesh.columns[name] for name in PAINT] if mesh.has(*PAINT) else None


def _color(scene: Scene, name: str, default: str) -> Any:
    """That of a thing's look."""
    return getattr(scene.render.materials.get(name), "color", None) or default


def _place(camera: Any, view: View) -> None:
    camera.position, camera.focal_point, camera.up = view.position, view.target, z_up((0, 1, 0))
    if view.shown is None:
        camera.view_angle = np.degrees(view.height_angle)
    else:
        camera.parallel_projection = True
        camera.parallel_scale = view.shown[1] / 2


def _rotation(quaternion: tuple[float, float, float, float]) -> np.ndarray:
    w, x, y, z = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _number(path: Path) -> int:
    found = re.search(r"_(\d+)\.ply$", path.name)
    if found is None:
        raise ValueError(f"{path} has no number")
    return int(found[1])


def unfinished(folder: Path) -> Iterator[Path]:
    """Folders of the parts beside each other in `folder` that are there, and of those that are being made."""
    yield from sorted(path for path in folder.glob("[0-9]*") if path.is_dir())
    yield from sorted(folder.glob(".*.partial-*"))


def main(arguments: list[str] | None = None, called: str = COMMAND) -> int:
    parser = argparse.ArgumentParser(
        prog=called,
        description=as_called(__doc__, called),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("scene", help="name of a scene, such as bunny, or its file")
    parser.add_argument("--frame", type=int, metavar="N", help="default: the last one available")
    parser.add_argument("--quality", choices=QUALITIES, help="of the film (default: the scene's)")
    parser.add_argument("--simulation", type=Path, metavar="DIR", help="a run's folder in place of the film's")
    parser.add_argument("--particles", action="store_true", help="draw particles also where there is a surface")
    parser.add_argument("--out", type=Path, metavar="FILE", help="the picture, such as frame.png")
    options = parser.parse_args(arguments)
    try:
        scene = load(SCENE_FILES.locate(options.scene), quality=options.quality)
        results = Path(Plan(scene, HOME).results)
        simulations = [options.simulation] if options.simulation else [*unfinished(results / "simulation")]
        surfaces = [] if options.simulation else [*unfinished(results / "surface")]
        foams = [] if options.simulation else [*unfinished(results / "foam")]
        known = frames(simulations, surfaces, foams)
        if not known:
            where = options.simulation or results / "simulation"
            raise Unusable(f"there are no frames in {where}: simulate the scene first")
        number = max(known) if options.frame is None else options.frame
        if number not in known:
            raise Unusable(f"there is no frame {number}: there are {min(known)} to {max(known)}")
        out = options.out or results / "preview" / f"{number:05d}.png"
        draw(scene, known[number], out, particles=options.particles)
    except (SceneError, Refused, RenderError, BadPly, BadTable, OSError) as error:
        print(f"preview: {error}", file=sys.stderr)
        return 2
    print(out)
    return 0


if __name__ == "__main__":
    end_with(main, goes_on=True)
