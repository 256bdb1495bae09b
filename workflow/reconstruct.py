"""Particles become a surface: a folder of fluid_00042.ply, a folder of surface_00042.ply.

example: the frames 0 to 12 of a simulation with particles of 1 cm radius
  python -m workflow.reconstruct --spec '{"particle_radius": 0.01}' \\
      --simulation run/simulation --frames 0:12 --out run/surface

--spec takes JSON, the name of a file with it, or - for standard input: particle_radius [m],
rest_density [kg/m^3], walls (each with normal and offset [m]) and vessels (names of containers)
that the surface ends flush with, as it does with the bodies of the simulation, and `surface`, the
section of that name of a scene. The meshes carry normals (nx ny nz) and the fluid's velocity
(vx vy vz), and open in MeshLab, ParaView and Blender; `surface: {attributes: [speed]}` adds what it
names. For `age` give fps, too; of `source`, a list of sources (names of fluid bodies and emitters)
says which there are. A frame without particles gives a mesh without vertices.

exit codes: 0 done, 1 failed, 2 refused (settings or files cannot be used as they are)
"""

from __future__ import annotations

import argparse
import functools
import os
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

from common.arguments import frame_range, positive
from common.command import end_with
from common.files import write_json, write_whole
from common.frames import Frames
from common.signals import at_once
from common.stopwatch import Stopwatch
from scene.settings import Refused
from scene.spec_option import HELP, read_spec
from workflow.stages import stage
from workflow.stages.stage import exit_code
from workflow.stages.surface.spec import ReconstructSpec


def run(spec: ReconstructSpec, simulation: Path, frames: Frames, out: Path, *, threads: int = 1) -> None:
    """Write surface_*.ply and summary.json to `out`; raises Refused for particles that cannot be used."""
    watch = Stopwatch()
    with watch.phase("import"):
        os.environ["RAYON_NUM_THREADS"] = str(threads)
        import numpy as np

        from common.ply import BadPly, columns, read_points, write_surface
        from workflow.stages.bodies import Bodies
        from workflow.stages.surface.attributes import sampled
        from workflow.stages.surface.known import Known
        from workflow.stages.surface.surface import reconstruct
    out.mkdir(parents=True, exist_ok=True)
    with watch.phase("load"):
        stage.refuse_spoiled([simulation], "fluid_", frames=frames)
        bodies = Bodies([simulation] if spec.surface.walls else [])
        of_particles = Known.of(spec, simulation)
    rows = []
    for frame in frames:
        with watch.phase("load"):
            path = simulation / f"fluid_{frame:05d}.ply"
            try:
                particles = read_points(path)
                positions, velocities = columns(particles, "xyz"), columns(particles, ("vx", "vy", "vz"))
                known = of_particles.columns(particles, frame)
            except FileNotFoundError:
                remedy = f"simulate the frames {frames} first"
                raise Refused(f"{path} is missing", remedy=remedy) from None
            except BadPly as error:
                raise Refused(str(error), remedy=f"delete it, and simulate the frames {frames} again") from None
            if not (np.isfinite(positions).all() and np.isfinite(velocities).all()):
                raise Refused(
                    f"{path} holds numbers that are not finite",
                    remedy=f"delete it, and simulate the frames {frames} again",
                )
            solids = bodies.solids(frame, spec.vessels if spec.surface.walls else ())
        with watch.phase("splashsurf"), at_once():
            numbers = particles["id"] if "id" in particles.dtype.names else None
            surface = reconstruct(positions, velocities, spec, numbers=numbers, solids=solids, threads=threads)
        with watch.phase("attributes"):
            particles_here = positions, velocities, known
            found = sampled(of_particles.names, surface.vertices, *particles_here, 2 * spec.particle_radius)
        with watch.phase("write"):
            write = functools.partial(write_surface, **vars(surface), attributes=found)
            write_whole(out / f"surface_{frame:05d}.ply", write)
        rows.append(
            {
                "frame": frame,
                "particles": len(positions),
                "vertices": len(surface.vertices),
                "triangles": len(surface.triangles),
                "volume": surface.volume,
            }
        )
        print(f"surface of frame {frame}: {len(positions)} particles, {len(surface.triangles)} triangles")
    summary = {
        "status": "done",
        "versions": {"pysplashsurf": version("pysplashsurf"), "numpy": np.__version__},
        "threads": threads,
        "frames": rows,
        "wall_s": watch.report(),
    }
    write_json(out / "summary.json", summary)


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m workflow.reconstruct", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--spec", required=True, metavar="JSON", help=HELP)
    parser.add_argument("--simulation", required=True, type=Path, metavar="DIR", help="folder with fluid_*.ply")
    parser.add_argument("--frames", required=True, type=frame_range, metavar="A:B", help="first and last frame")
    parser.add_argument("--out", required=True, type=Path, metavar="DIR", help="folder for the meshes and summary.json")
    parser.add_argument("--threads", type=positive(int), default=1, metavar="N", help="CPU threads (default 1)")
    given = parser.parse_args(argv)

    def work() -> None:
        spec = read_spec(ReconstructSpec, given.spec)
        run(spec, given.simulation, given.frames, given.out, threads=given.threads)

    return exit_code(work, "reconstruct")


if __name__ == "__main__":
    end_with(main, goes_on=True)
