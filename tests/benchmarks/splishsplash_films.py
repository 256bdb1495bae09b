"""The peer's side of two films: a duck that falls into a pool, and a bowl that is tipped, in SPlisHSPlasH.

Runs in the peer's own environment, with trimesh and scipy, and prints one line of JSON; `films_beside_peer.py` calls it
and says of what scene.

Particles start looser than at rest and a spacing off solids: denser than at rest anywhere, the peer explodes. Its
bodies stop each other when they come within 10 mm, whatever their size, so the duck has no contacts at all: it is
lighter than water, and the pool is deep. The bowl goes where its key frames take it, step by step.
"""

import argparse
import json
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pysplishsplash as sph
import trimesh
from scipy.spatial.transform import Rotation, Slerp

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.benchmarks.splishsplash_bodies import LOOSE, write_bgeo, write_obj

MEASURED_EVERY = 10
"""Steps between two looks at the densities."""


def particles(water: np.ndarray, solids: list[trimesh.Trimesh], spacing: float, tall: bool) -> np.ndarray:
    """A lattice in the convex hull of where there is water, a spacing off solids [m]; where there is room above,
    `tall`, as many as there are of ours."""
    low, high = water.min(axis=0), water.max(axis=0)
    top = low[1] + 1.5 * (high[1] - low[1]) if tall else high[1]
    ends = [(low[0], high[0]), (low[1], top), (low[2], high[2])]
    axes = [np.arange(a + spacing / 2, b - spacing / 4, LOOSE * spacing) for a, b in ends]
    points = np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], 1)
    if tall:
        return points[np.argsort(points[:, 1], kind="stable")[: len(water)]]
    points = points[trimesh.convex.convex_hull(water).contains(points)]
    for solid in solids:
        # Positive inside.
        points = points[trimesh.proximity.signed_distance(solid, points) < -spacing]
    return points


def rigid_body(number: int, file: str, body: dict) -> dict:
    x, y, z = Rotation.from_quat(body.get("rotation", [0, 0, 0, 1])).as_rotvec()
    angle = float(np.linalg.norm([x, y, z]))
    return {
        "id": number,
        "geometryFile": file,
        "translation": body.get("position", [0, 0, 0]),
        "rotationAxis": [x / angle, y / angle, z / angle] if angle else [1, 0, 0],
        "rotationAngle": angle,
        "scale": [1, 1, 1],
        "isDynamic": "density" in body,
        "isAnimated": "keys" in body,
        "density": body.get("density", 1000),
        "isWall": False,
        "collisionObjectType": 0,
        "collisionObjectScale": [1, 1, 1],
        "restitution": 0.0,
        "friction": 0.0,
        "mapInvert": body.get("hollow", False),
        "mapThickness": 0.0,
        "mapResolution": body["resolution"],
    }


def configuration(case: dict, folder: Path) -> dict:
    meshes, solids = [], []
    for number, body in enumerate(case["bodies"]):
        mesh = trimesh.Trimesh(body["points"], body["triangles"], process=False)
        file = write_obj(folder / f"body_{number}.obj", mesh, 1.0)
        meshes.append(rigid_body(number + 1, file, body))
        if body.get("holds"):
            solids.append(mesh.copy().apply_translation(body.get("position", [0, 0, 0])))
    tall = any(body.get("hollow") for body in case["bodies"])
    write_bgeo(folder / "water.bgeo", particles(np.array(case["water"]), solids, case["spacing"], tall))
    return {
        "Configuration": {
            "particleRadius": case["spacing"] / 2,
            "simulationMethod": 4,
            "boundaryHandlingMethod": 2,
            "gravitation": [0, -9.81, 0],
            "cflMethod": 1,
            "timeStepSize": 0.001,
            "cflMaxTimeStepSize": 0.005,
            "stopAt": case["seconds"],
            "DFSPH": {"maxError": 0.05, "maxErrorV": 0.1},
        },
        "Simulation": {"contactStiffnessRigidBody": 20.0},
        "Materials": [
            {"id": "Fluid", "density0": 1000, "viscosityMethod": 1, "Standard viscosity": {"viscosity": 1e-6}}
        ],
        "RigidBodies": meshes,
        "FluidModels": [{"particleFile": "water.bgeo", "translation": [0, 0, 0], "scale": [1, 1, 1]}],
    }


class Led:
    """Takes a body along its frames: pose and velocities at the time that is reached."""

    def __init__(self, body: dict, rigid: sph.StaticRigidBody):
        self.rigid, keys = rigid, body["keys"]
        self._times = np.array(keys["times"])
        self._turn = Slerp(self._times, Rotation.from_quat(keys["rotations"]))
        self._rows = np.hstack([keys[name] for name in ("positions", "velocities", "spins")])

    def go(self, now: float) -> None:
        at = min(now, self._times[-1])
        row = np.array([np.interp(at, self._times, column) for column in self._rows.T], np.float32)
        self.rigid.setPosition(row[:3])
        self.rigid.setRotation(self._turn(at).as_quat().astype(np.float32))
        self.rigid.setVelocity(row[3:6])
        self.rigid.setAngularVelocity(row[6:])
        self.rigid.updateMeshTransformation()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.parse_args()
    case = json.load(sys.stdin)
    ends: list[float] = []
    iterations: list[int] = []
    errors: list[float] = []
    bodies: list[sph.StaticRigidBody] = []
    led: list[Led] = []

    def look() -> None:
        ends.append(time.perf_counter())
        simulation = sph.Simulation.getCurrent()
        solver = simulation.getTimeStep()
        counters = sph.TimeStepDFSPH.SOLVER_ITERATIONS, sph.TimeStepDFSPH.SOLVER_ITERATIONS_V
        iterations.append(sum(solver.getValueUInt(counter) for counter in counters))
        if not bodies:
            # They are there from the first step on.
            bodies.extend(simulation.getBoundaryModel(k).getRigidBodyObject() for k in range(len(case["bodies"])))
            led.extend(Led(body, rigid) for body, rigid in zip(case["bodies"], bodies, strict=True) if "keys" in body)
        for body in led:
            body.go(sph.TimeManager.getCurrent().getTime())
        if len(ends) % MEASURED_EVERY == 0:
            density = np.array(simulation.getFluidModel(0).getFieldBuffer("density"), copy=False)[:count]
            errors.append(float(np.maximum(density / 1000 - 1, 0).mean()))

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        path = folder / "scene.json"
        path.write_text(json.dumps(configuration(case, folder)))
        base = sph.Exec.SimulatorBase()
        base.init(useGui=False, sceneFile=str(path), outputDir=name, stopAt=case["seconds"])
        base.setTimeStepCB(look)
        base.initSimulation()
        simulation = sph.Simulation.getCurrent()
        count = simulation.getFluidModel(0).numActiveParticles()
        start = time.perf_counter()
        base.runSimulation()
        places = [np.array(rigid.getPosition()).ravel().tolist() for rigid in bodies]
        water = np.array(simulation.getFluidModel(0).getFieldBuffer("position"), copy=True)[:count]
    wall = ends[-1] - ends[0]
    result = {
        "particles": count,
        "steps": len(ends) - 1,
        "wall": wall,
        "before": ends[0] - start - wall / (len(ends) - 1),
        "iterations": float(np.mean(iterations)),
        "compression": float(np.mean(errors)),
        "places": places,
        "middle": water.mean(axis=0).tolist(),
    }
    print("RESULT", json.dumps(result), flush=True)


if __name__ == "__main__":
    main()
