"""The peer's side of everyday scenes: a glass of water and bodies in a tank, in SPlisHSPlasH.

Set-up, once, in an environment of its own:

    python3.11 -m venv peers && peers/bin/pip install pySPlisHSPlasH==2.19.0 trimesh scipy networkx

    peers/bin/python splishsplash_bodies.py glass --wall 0.0005 --boundary volume-map
    peers/bin/python splishsplash_bodies.py ball --boundary akinci --cache maps

Where its bundled GL library crashes, put LD_PRELOAD=libGLdispatch.so.0 before the command. Prints one line of JSON.

Particles of radius spacing / 2 that are read from a file hold spacing^3 of water (`volume_over_d3` tells).

Its rigid bodies stop each other when they come within 10 mm, whatever `contactTolerance` says, which is made for bodies
of metres: let go on the ground without any water, a ball of 15 mm is flung up by 30 mm. So the scene is made `--scale`
times as large, with times and speeds as gravity has them (Froude), and what is told is scaled back.

A body is held until the water has come to rest (`--settle`), whose speed is damped meanwhile, and then let go; times
count from there. All solver settings but the longest step are the peer's defaults. `--cache` keeps meshes and maps
between runs.
"""

import argparse
import json
import tempfile
import time
from pathlib import Path

import numpy as np
import pysplishsplash as sph
import trimesh

BOUNDARIES = {"akinci": 0, "density-map": 1, "volume-map": 2}
GLASS_RADIUS, GLASS_FLOOR, GLASS_TOP, GLASS_FILL = 0.035, 0.010, 0.090, 0.065
LOOSE = 1.03
SCENES = {
    "glass": {"spacing": 0.005, "seconds": 1.5},
    "ball": {"spacing": 0.005, "seconds": 0.6, "tank": (0.12, 0.1, 0.12), "depth": 0.06, "density": 1200},
    "rise": {"spacing": 0.004, "seconds": 1.0, "tank": (0.15, 0.1, 0.14), "depth": 0.052, "density": 800.52},
    "sink": {"spacing": 0.005, "seconds": 0.36, "tank": (0.15, 0.25, 0.14), "depth": 0.131, "density": 2120},
}


def glass(wall: float) -> trimesh.Trimesh:
    """A cup along y; its bottom is as thick as its wall."""
    outer, bottom = GLASS_RADIUS + wall, GLASS_FLOOR - wall
    profile = [[0, bottom], [outer, bottom], [outer, GLASS_TOP], [GLASS_RADIUS, GLASS_TOP]]
    profile += [[GLASS_RADIUS, GLASS_FLOOR], [0, GLASS_FLOOR]]
    mesh = trimesh.creation.revolve(np.array(profile), sections=96)
    mesh.apply_transform(trimesh.transformations.rotation_matrix(-np.pi / 2, [1, 0, 0]))
    mesh.fix_normals()
    return mesh


def ball(radius: float) -> trimesh.Trimesh:
    """Of the volume of the sphere, with a vertex at its foot."""
    mesh = trimesh.creation.icosphere(subdivisions=2, radius=radius)
    mesh.apply_scale((4 / 3 * np.pi * radius**3 / mesh.volume) ** (1 / 3))
    return mesh


def body(name: str) -> tuple[trimesh.Trimesh, float]:
    """What is let go, about its centre, and how high that is."""
    if name == "ball":
        mesh = ball(0.015)
        return mesh, -float(mesh.vertices[:, 1].min())
    extents, height = {"rise": ((0.049, 0.024, 0.048), 0.012), "sink": ((0.02, 0.02, 0.02), 0.1315)}[name]
    mesh = trimesh.creation.box(extents)
    return mesh, height


def write_obj(path: Path, mesh: trimesh.Trimesh, scale: float) -> str:
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in mesh.vertices * scale]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in mesh.faces]
    text = "\n".join(lines) + "\n"
    if not path.exists() or path.read_text() != text:
        path.write_text(text)
    return path.name


def write_bgeo(path: Path, points: np.ndarray) -> None:
    header = (
        np.array([0x4267656F], ">i4").tobytes()
        + b"V"
        + np.array([5, len(points), 0, 0, 0, 0, 0, 0, 0], ">i4").tobytes()
    )
    rows = np.ones((len(points), 4), ">f4")
    rows[:, :3] = points
    path.write_bytes(header + rows.tobytes() + b"\x00\xff")


def water_in_glass(spacing: float) -> np.ndarray:
    """Looser than at rest, and a spacing off the walls: denser than at rest anywhere, the peer explodes."""
    pitch = LOOSE * spacing
    side = np.arange(-GLASS_RADIUS, GLASS_RADIUS, pitch)
    side -= side.mean()
    up = np.arange(GLASS_FLOOR + spacing / 2, GLASS_FLOOR + GLASS_FILL, pitch)
    x, y, z = (axis.ravel() for axis in np.meshgrid(side, up, side, indexing="ij"))
    inside = np.hypot(x, z) < GLASS_RADIUS - spacing
    return np.stack([x, y + spacing / 2, z], 1)[inside]


def water_in_tank(scene: dict, spacing: float, mesh: trimesh.Trimesh, height: float) -> np.ndarray:
    """A lattice that leaves the body out; as much as stands at the depth with the body in it. Off the walls as in the
    glass."""
    pitch = LOOSE * spacing
    width, tall, length = scene["tank"]
    sides = [np.arange(spacing, size - spacing, pitch) for size in (width, length)]
    x, z = (side - side.mean() for side in sides)
    y = np.arange(spacing, min(tall - spacing, 2 * scene["depth"]), pitch)
    points = np.stack([axis.ravel() for axis in np.meshgrid(x, y, z, indexing="ij")], 1)
    about = points - [0, height, 0]
    if scene["name"] == "ball":
        outside = np.linalg.norm(about, axis=1) > mesh.extents[0] / 2 + 0.9 * spacing
    else:
        outside = np.any(np.abs(about) > mesh.extents / 2 + 0.9 * spacing, axis=1)
    points = points[outside]
    sunk = mesh.volume * min(1.0, (scene["depth"] - height) / mesh.extents[1] + 0.5)
    count = round((width * length * scene["depth"] - sunk) / spacing**3)
    assert len(points) >= count, "the tank is too small"
    order = np.lexsort((np.random.default_rng(0).random(len(points)), points[:, 1]))
    return points[order[:count]]


def configuration(options: argparse.Namespace, radius: float, folder: Path, scene: dict) -> tuple[dict, float]:
    common = {"translation": [0, 0, 0], "rotationAxis": [1, 0, 0], "rotationAngle": 0, "scale": [1, 1, 1]}
    name, times = f"{options.scene}_x{options.scale:g}", options.scale
    common |= {
        "mapThickness": times * options.thickness,
        "mapResolution": 3 * [options.resolution],
        "samplingMode": options.sampling,
    }
    hollow = {"mapInvert": True, "mapThickness": -times * options.thickness}
    still = common | {"isDynamic": False, "isWall": True, "mapInvert": False}
    height = 0.0
    if options.scene == "glass":
        if options.hole:
            mesh = trimesh.creation.cylinder(GLASS_RADIUS, GLASS_TOP - GLASS_FLOOR, sections=96)
            mesh.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, [1, 0, 0]))
            mesh.apply_translation([0, (GLASS_TOP + GLASS_FLOOR) / 2, 0])
            bodies = [still | {"geometryFile": write_obj(folder / f"{name}_hole.obj", mesh, times)} | hollow]
        else:
            file = folder / f"{name}_{1000 * options.wall:g}mm.obj"
            bodies = [still | {"geometryFile": write_obj(file, glass(options.wall), times)}]
        points = water_in_glass(options.spacing)
    else:
        tank = scene["tank"]
        mesh, height = body(options.scene)
        height += options.lift
        box = trimesh.creation.box(tank)
        wall = {"geometryFile": write_obj(folder / f"{name}_tank.obj", box, times), "invertSDF": True} | hollow
        wall |= {"collisionObjectType": 2, "collisionObjectScale": [times * size for size in tank]}
        wall |= {"translation": [0, times * tank[1] / 2, 0]}
        thing = {"geometryFile": write_obj(folder / f"{name}.obj", mesh, times), "translation": [0, times * height, 0]}
        thing |= {"isDynamic": True, "density": scene["density"], "isWall": False, "mapInvert": False}
        kind, size = (1, 3 * [mesh.extents[0] / 2]) if options.scene == "ball" else (2, mesh.extents.tolist())
        thing |= {"collisionObjectType": kind, "collisionObjectScale": [times * length for length in size]}
        still |= {"restitution": 0.0, "friction": 0.0}
        bodies = [still | wall | {"id": 1}, still | thing | {"id": 2}]
        points = water_in_tank(scene, options.spacing, mesh, height)
        points = points[:8] if options.dry else points
    write_bgeo(folder / f"{options.tag}.bgeo", times * points)
    return {
        "Configuration": {
            "particleRadius": times * radius,
            "simulationMethod": 4,
            "boundaryHandlingMethod": BOUNDARIES[options.boundary],
            "gravitation": [0, -9.81, 0],
            "cflMethod": 1,
            "timeStepSize": min(0.001, options.step) * times**0.5,
            "cflMaxTimeStepSize": options.step * times**0.5,
        },
        "Simulation": {"contactStiffnessRigidBody": options.stiffness},
        "Materials": [
            {
                "id": "Fluid",
                "density0": 1000,
                "viscosityMethod": 1,
                "Standard viscosity": {"viscosity": options.viscosity * times**1.5},
            }
        ],
        "RigidBodies": bodies,
        "FluidModels": [{"particleFile": f"{options.tag}.bgeo", "translation": [0, 0, 0], "scale": [1, 1, 1]}],
    }, height


def in_the_glass(x: np.ndarray, volume: float, wall: float, spacing: float) -> dict:
    out = np.hypot(x[:, 0], x[:, 2])
    inside = (out < GLASS_RADIUS) & (x[:, 1] > GLASS_FLOOR)
    within = ~inside & (out < GLASS_RADIUS + wall) & (x[:, 1] > GLASS_FLOOR - wall) & (x[:, 1] < GLASS_TOP)
    kept = x[inside & (x[:, 1] < GLASS_TOP)]
    columns = np.floor(kept[:, [0, 2]] / spacing).astype(int)
    highest: dict = {}
    for column, y in zip(map(tuple, columns), kept[:, 1], strict=True):
        highest[column] = max(y, highest.get(column, 0))
    return {
        "level_expected_mm": 1000 * (GLASS_FLOOR + len(x) * volume / (np.pi * GLASS_RADIUS**2)),
        "level_from_centre_mm": 1000 * (GLASS_FLOOR + 2 * (kept[:, 1].mean() - GLASS_FLOOR)) if len(kept) else None,
        "level_from_columns_mm": 1000 * (np.mean(list(highest.values())) + spacing / 2) if len(kept) else None,
        "left_the_glass": len(x) - len(kept),
        "in_its_wall": int(within.sum()),
        "outermost_from_wall_d": (GLASS_RADIUS - out[inside].max()) / spacing if len(kept) else None,
        "lowest_from_floor_d": (kept[:, 1].min() - GLASS_FLOOR) / spacing if len(kept) else None,
    }


def of_the_body(name: str, table: np.ndarray) -> dict:
    """Of times, positions and velocities since the body was let go."""
    t, y = table[:, 0], table[:, 2]
    at = {
        f"y_at_{moment:g}s_mm": 1000 * float(np.interp(moment, t, y)) for moment in (0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 1.0)
    }
    result = {"y_start_mm": 1000 * y[0], "y_least_mm": 1000 * y.min(), "y_greatest_mm": 1000 * y.max()}
    result |= {key: value for key, value in at.items() if float(key[5:-4]) <= t[-1] + 0.01}
    result["aside_greatest_mm"] = 1000 * float(np.hypot(table[:, 1] - table[0, 1], table[:, 3] - table[0, 3]).max())
    if name == "rise":
        half = np.flatnonzero(y > (0.012 + 0.04425) / 2)
        result["half_way_s"] = float(t[half[0]]) if len(half) else None
        crests = [i for i in range(1, len(y) - 1) if y[i] > 0.04425 and y[i] == y[abs(t - t[i]) < 0.08].max()]
        result["crests_s"] = [round(float(t[i]), 3) for i in crests[:3]]
        result["crest_mm"] = 1000 * float(y[crests[0]]) if crests else None
        result["mean_of_last_0.37s_mm"] = 1000 * float(y[t > t[-1] - 0.37].mean())
    if name == "sink":
        passes = [np.flatnonzero(y < level) for level in (0.0845, 0.0298)]
        if all(map(len, passes)):
            since, until = np.interp([-0.0845, -0.0298], -y[: passes[1][0] + 1], t[: passes[1][0] + 1])
            result |= {"since_s": since, "until_s": until, "speed_m_s": (0.0845 - 0.0298) / (until - since)}
    return result


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", choices=SCENES)
    parser.add_argument("--boundary", choices=BOUNDARIES, default="volume-map")
    parser.add_argument("--wall", type=float, default=0.004, help="of the glass [m]")
    parser.add_argument("--hole", action="store_true", help="the glass is a closed hole in a solid, by an inverted map")
    parser.add_argument("--spacing", type=float, help="[m]")
    parser.add_argument("--resolution", type=int, default=40, help="of the maps, cells along each axis")
    parser.add_argument("--thickness", type=float, default=0.0, help="mapThickness by which solids grow [m]")
    parser.add_argument("--sampling", type=int, default=0, help="samplingMode: 0 Poisson disk, 1 regular triangles")
    parser.add_argument("--viscosity", type=float, default=1e-6, help="of the explicit, standard method [m^2/s]")
    parser.add_argument("--step", type=float, default=0.002, help="longest step [s]")
    parser.add_argument("--scale", type=float, help="size of the scene in the simulation: 50, and 1 for the glass")
    parser.add_argument("--stiffness", type=float, default=20.0, help="contactStiffnessRigidBody [1/s]")
    parser.add_argument("--lift", type=float, default=0.0, help="how much higher the body is held [m]")
    parser.add_argument("--settle", type=float, default=0.4, help="time for which a body is held [s]")
    parser.add_argument("--seconds", type=float, help="simulated time, from when a body is let go [s]")
    parser.add_argument("--cache", type=Path, help="folder for meshes and maps")
    parser.add_argument("--dry", action="store_true", help="eight particles only: a check of the body by itself")
    parser.add_argument("--dump", type=Path, help="writes x, y, z, density of the particles at the end as text")
    parser.add_argument("--track", type=Path, help="writes t, x, y, z, vx, vy, vz of the body as text")
    options = parser.parse_args()
    scene = SCENES[options.scene] | {"name": options.scene}
    options.spacing = options.spacing or scene["spacing"]
    options.seconds = options.seconds or scene["seconds"]
    options.scale = options.scale or (1.0 if options.scene == "glass" else 50.0)
    if options.scene == "glass":
        options.settle = 0.0
    radius = options.spacing / 2
    options.tag = f"{options.scene}_{options.boundary}_{time.time_ns()}"
    rows, steps, pushes, held = [], [], [], {}

    with tempfile.TemporaryDirectory() as scratch:
        folder = options.cache or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        data, height = configuration(options, radius, folder, scene)
        path = folder / f"{options.tag}.json"
        path.write_text(json.dumps(data))
        end = (options.settle + options.seconds) * options.scale**0.5
        base = sph.Exec.SimulatorBase()
        base.init(useGui=False, sceneFile=str(path.resolve()), outputDir=scratch, stopAt=end)

        def after_step() -> None:
            now = sph.TimeManager.getCurrent().getTime() / options.scale**0.5
            steps.append((time.perf_counter(), now))
            if options.scene == "glass":
                return
            thing = sph.Simulation.getCurrent().getBoundaryModel(1).getRigidBodyObject()
            if not held:
                held.update(q=np.array(thing.getRotation()), x=[0.0, options.scale * height, 0.0])
            if 0.75 * options.settle < now < options.settle and len(steps) > 1:
                pushes.append(thing.getVelocity()[1] / (now - steps[-2][1]) / options.scale**0.5)
            if now < 0.75 * options.settle:
                np.array(sph.Simulation.getCurrent().getFluidModel(0).getFieldBuffer("velocity"), copy=False)[:] *= 0.97
            if now < options.settle:
                thing.setVelocity([0.0, 0.0, 0.0])
                thing.setAngularVelocity([0.0, 0.0, 0.0])
                thing.setRotation(held["q"])
                thing.setPosition(held["x"])
            x, v = thing.getPosition() / options.scale, thing.getVelocity() / options.scale**0.5
            if now >= options.settle - options.step:
                rows.append([now, *x, *v])

        base.setTimeStepCB(after_step)
        base.initSimulation()
        simulation = sph.Simulation.getCurrent()
        fluid = simulation.getFluidModel(0)
        volume = fluid.getVolume(0) / options.scale**3
        begun = time.perf_counter()
        base.runSimulation()
        x = np.array(fluid.getFieldBuffer("position"))[: fluid.numActiveParticles()].astype(float) / options.scale
        v = np.array(fluid.getFieldBuffer("velocity"))[: fluid.numActiveParticles()].astype(float) / options.scale**0.5
        density = np.array(fluid.getFieldBuffer("density"))[: fluid.numActiveParticles()]
        result = {name: str(value) if isinstance(value, Path) else value for name, value in vars(options).items()}
        models = [simulation.getBoundaryModel(i) for i in range(simulation.numberOfBoundaryModels())]
        result |= {
            "method": simulation.getBoundaryHandlingMethod(),
            "models": [type(model).__name__ for model in models],
            "samples": [model.numberOfParticles() if hasattr(model, "numberOfParticles") else None for model in models],
            "masses": [model.getRigidBodyObject().getMass() for model in models],
            "radius": simulation.getParticleRadius(),
            "particles": len(x),
            "volume_over_d3": volume / options.spacing**3,
            "mass_over_volume": fluid.getMass(0) / fluid.getVolume(0),
            "steps": len(steps),
            "ended_at": steps[-1][1],
            "setup_s": steps[0][0] - begun,
            "stepping_s": steps[-1][0] - steps[0][0],
            "energy_per_mass": float((v**2).sum(1).mean() / 2),
            "greatest_speed": float(np.linalg.norm(v, axis=1).max()),
            "greatest_density": float(density.max()),
            "mean_density": float(density.mean()),
            "not_finite": int((~np.isfinite(x)).any(1).sum()),
        }
        if options.dump:
            np.savetxt(options.dump, np.column_stack([x, density]), header="x y z density")
        for name in (path, folder / f"{options.tag}.bgeo"):
            name.unlink()
    if options.scene == "glass":
        result |= in_the_glass(x, volume, options.wall, options.spacing)
    else:
        table = np.array(rows)
        table[:, 0] -= options.settle
        if options.track:
            np.savetxt(options.track, table, header="t x y z vx vy vz")
        tank, spill = np.array(scene["tank"]), x.copy()
        spill[:, 1] -= tank[1] / 2
        result["upward_acceleration_held_m_s2"] = float(np.mean(pushes)) if pushes else None
        result["left_the_tank"] = int(np.any(np.abs(spill) > tank / 2, axis=1).sum())
        result["level_from_centre_mm"] = 2000 * float(x[:, 1].mean())
        result["lowest_from_floor_d"] = float(np.quantile(x[:, 1], 0.01)) / options.spacing
        result["outermost_from_wall_d"] = (tank[0] / 2 - float(np.quantile(np.abs(x[:, 0]), 0.99))) / options.spacing
        result |= of_the_body(options.scene, table)
    print("RESULT", json.dumps(result, default=str), flush=True)


if __name__ == "__main__":
    main()
