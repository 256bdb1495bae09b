"""The peer's side of the benchmark: the dam break in SPlisHSPlasH.

Runs in the peer's own environment and prints one line of JSON; `dam_break.py` calls it.

The peer makes its volume maps inside `runSimulation`, before the first step, which takes seconds: the clock runs from
the end of the first step to that of the last. A particle of radius r holds (2 r)^3 of water, as ours do (`mass`).
"""

import argparse
import json
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pysplishsplash as sph

METHODS = {"wcsph": 0, "pcisph": 1, "iisph": 3, "dfsph": 4}
BOUNDARIES = {"akinci": 0, "density-map": 1, "volume-map": 2}
CFL_OF_FACTOR_1 = 0.4
"""How far the fastest particle goes in a step at the peer's factor 1, in d."""
MEASURED_EVERY = 10
"""Steps between two looks at the densities."""


def scene(options: argparse.Namespace) -> dict:
    layers = round(1.0 / (2 * options.radius))
    low = [-2 + 2 * options.radius, 2 * options.radius, -(layers - 1) * options.radius]
    return {
        "Configuration": {
            "particleRadius": options.radius,
            "simulationMethod": METHODS[options.method],
            "boundaryHandlingMethod": BOUNDARIES[options.boundary],
            "gravitation": [0, -9.81, 0],
            "cflMethod": 1,
            "cflFactor": options.cfl / CFL_OF_FACTOR_1,
            "timeStepSize": 0.005,
            "cflMaxTimeStepSize": 0.005,
            "stopAt": options.seconds,
            "DFSPH": {
                "enableDivergenceSolver": True,
                "minIterations": 2,
                "maxIterations": 100,
                "maxError": 0.05,
                "maxIterationsV": 100,
                "maxErrorV": 0.1,
            },
        },
        "Materials": [
            {"id": "Fluid", "density0": 1000, "viscosityMethod": 1, "Standard viscosity": {"viscosity": 0.01}}
        ],
        "RigidBodies": [
            {
                "geometryFile": str(Path(sys.prefix) / "bin/data/models/UnitBox.obj"),
                "translation": [0, 1.5, 0],
                "scale": [4, 3, 1.5],
                "rotationAxis": [1, 0, 0],
                "rotationAngle": 0,
                "isDynamic": False,
                "isWall": True,
                "mapInvert": True,
                "mapThickness": 0.0,
                "mapResolution": [40, 30, 15],
            }
        ],
        "FluidBlocks": [{"denseMode": 0, "start": low, "end": [x + 1 for x in low]}],
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--method", choices=METHODS, required=True)
    parser.add_argument("--boundary", choices=BOUNDARIES, required=True)
    parser.add_argument("--radius", type=float, required=True, help="particle radius [m]")
    parser.add_argument("--seconds", type=float, required=True, help="simulated time [s]")
    parser.add_argument("--cfl", type=float, default=CFL_OF_FACTOR_1, help="way of a step, in d (default: 0.4)")
    options = parser.parse_args()
    ends: list[float] = []
    iterations: list[int] = []
    errors: list[float] = []

    def look() -> None:
        ends.append(time.perf_counter())
        simulation = sph.Simulation.getCurrent()
        if options.method == "dfsph":
            solver = simulation.getTimeStep()
            counters = sph.TimeStepDFSPH.SOLVER_ITERATIONS, sph.TimeStepDFSPH.SOLVER_ITERATIONS_V
            iterations.append(sum(solver.getValueUInt(counter) for counter in counters))
        if len(ends) % MEASURED_EVERY == 0:
            density = np.array(simulation.getFluidModel(0).getFieldBuffer("density"), copy=False)[:particles]
            errors.append(float(np.maximum(density / 1000 - 1, 0).mean()))

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.json"
        path.write_text(json.dumps(scene(options)))
        base = sph.Exec.SimulatorBase()
        base.init(useGui=False, sceneFile=str(path), outputDir=folder, stopAt=options.seconds)
        base.setTimeStepCB(look)
        base.initSimulation()
        model = sph.Simulation.getCurrent().getFluidModel(0)
        particles, mass = model.numActiveParticles(), model.getMass(0)
        start = time.perf_counter()
        base.runSimulation()
    if len(ends) < 2:
        sys.exit("too short: fewer than two steps")
    wall = ends[-1] - ends[0]
    result = {
        "particles": particles,
        "mass": mass,
        "steps": len(ends) - 1,
        "wall": wall,
        "before": ends[0] - start - wall / (len(ends) - 1),
        "iterations": float(np.mean(iterations or [0.0])),
        "compression": float(np.mean(errors or [0.0])),
    }
    print("RESULT", json.dumps(result), flush=True)


if __name__ == "__main__":
    main()
