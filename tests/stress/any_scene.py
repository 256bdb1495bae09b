"""Scenes drawn at random from all that a scene may hold: some hundreds of particles, a few bodies and sheets."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from tests.support.fluid.solvers import SOLVERS

FPS = 50
FRAMES = 6
END = FRAMES / FPS
"""Of the run [s]."""
INTEGRATORS = ("implicit_euler", "symplectic_euler", "xpbd")
"""Of cloth; the first one meets fluid."""


class Draw:
    """One scene for each `seed`: `Draw(seed).scene()`."""

    def __init__(self, seed: int):
        self._random = np.random.default_rng(seed)
        self._places = self._free_places()
        self.names: list[str] = []
        """Of what an event may take away."""

    def scene(self) -> dict[str, Any]:
        """As plain data, without what a simulation does not know of."""
        kinds = self._some_of(["fluid", "rigid", "cloth"], least=1)
        scene: dict[str, Any] = {"fps": FPS, "containers": {"tank": self._tank()}}
        if self._chance(0.2):
            scene["gravity"] = self._vector(3.0, (0, -7, 0))
        if self._chance(0.3):
            scene["step"] = self._one_of([{"maximum": 0.002}, {"cfl": 0.25}, {"fixed": 0.0004}])
        for kind in kinds:
            scene[kind] = getattr(self, f"_{kind}")(kinds)
        scene["probes"] = self._probes(scene)
        events = [self._event(scene) for _ in range(self._number(0, 2))]
        scene["events"] = sorted(events, key=lambda event: event["at"])
        return scene

    def _free_places(self) -> Iterator[list[float]]:
        """Places [m] 0.16 m apart above still water, in a random order."""
        grid = [[x, y, z] for y in (0.3, 0.47, 0.64) for x in (-0.16, 0.0, 0.16) for z in (-0.16, 0.0, 0.16)]
        self._random.shuffle(grid)
        yield from grid

    def _tank(self) -> dict[str, Any]:
        return {"type": "box", "size": [0.56, 0.9, 0.56], "open": self._one_of([["top"], [], ["top", "left"]])}

    def _fluid(self, kinds: list[str]) -> dict[str, Any]:
        fluid: dict[str, Any] = {
            "solver": self._one_of([name for name in SOLVERS if name != "pcisph" or "cloth" not in kinds]),
            "particle_radius": 0.02,
            "bodies": {"water": {"shape": {"type": "box", "size": [0.56, 0.12, 0.56]}, "position": [0, 0.06, 0]}},
        }
        if self._chance(0.2):
            fluid["bodies"] = {}
        for number in range(self._number(0, 2)):
            fluid["bodies"][f"drop{number}"] = self._fluid_body()
        fluid["viscosity"] = self._one_of([0.0, 1e-6, 1e-4])
        if "cloth" not in kinds:
            # Light cloth asks for short steps where friction on it is explicit, and implicit friction does not meet it.
            fluid["viscosity"] = self._one_of([0.0, 1e-6, 1e-3, 0.5])
            fluid["viscosity_solver"] = self._one_of(["auto", "implicit"])
        fluid["wall_slip"] = self._one_of(["no_slip", "free_slip"])
        if self._chance(0.3):
            fluid |= {"xsph": 0.05}
        if self._chance(0.3):
            model = self._one_of(["becker2007", "akinci2013"])
            fluid |= {"surface_tension": 1.0, "surface_tension_model": model, "adhesion": self._one_of([0.0, 0.5])}
        if not fluid["bodies"] or self._chance(0.4):
            fluid["emitters"] = {"tap": self._emitter()}
            self.names.append("tap")
        if self._chance(0.3):
            fluid["drains"] = {"sink": self._drain()}
            self.names.append("sink")
        self.names += list(fluid["bodies"])[1:]
        return fluid

    def _fluid_body(self) -> dict[str, Any]:
        body = {"shape": self._shape(0.06), "position": next(self._places), "packing": self._packing()}
        if self._chance(0.5):
            body["velocity"] = self._vector(1.0)
        if self._chance(0.3):
            body["angular_velocity"] = self._vector(5.0)
        if self._chance(0.2):
            body["velocity_gradient"] = [[2.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]
        return body

    def _packing(self) -> str:
        return self._one_of(["auto", "lattice", "relaxed"])

    def _emitter(self) -> dict[str, Any]:
        shape = self._one_of([{"type": "disc", "radius": 0.05}, {"type": "rectangle", "size": [0.08, 0.08]}])
        emitter = {"shape": shape, "position": next(self._places), "rotation": [self._turn(180)]}
        emitter |= self._one_of([{"speed": 1.5}, {"rate": 0.01}])
        if self._chance(0.5):
            emitter |= {"start": self._time(), "stop": 2 * END}
        return emitter

    def _drain(self) -> dict[str, Any]:
        return {"shape": self._shape(0.08), "position": [0.1, 0.05, 0.1], "start": self._time()}

    def _rigid(self, kinds: list[str]) -> dict[str, Any]:
        bodies = {f"body{number}": self._body() for number in range(self._number(1, 4))}
        if self._chance(0.3):
            bodies["ground"] = {"shape": {"type": "plane"}, "position": [0, -0.1, 0]}
        rigid: dict[str, Any] = {"bodies": bodies}
        if self._chance(0.3):
            rigid["pairs"] = [{"between": ["body0", "tank"], "friction": 0.1, "restitution": 0.6}]
        self.names += [name for name in bodies if name.startswith("body")][1:]
        return rigid

    def _body(self) -> dict[str, Any]:
        body: dict[str, Any] = {"shape": self._shape(0.05), "position": next(self._places)}
        body |= {"rotation": [self._turn(self._random.uniform(0, 90))], "friction": self._one_of([0.0, 0.5, 1.2])}
        body["restitution"] = self._one_of([0.0, 0.5, 1.0])
        match self._one_of(["static", "prescribed", "dynamic", "dynamic", "dynamic"]):
            case "prescribed":
                body |= {"motion": "prescribed"} | self._led(body["position"])
            case "dynamic":
                body |= {"motion": "dynamic", "density": self._one_of([200.0, 700.0, 1500.0, 7800.0])}
                body |= {"velocity": self._vector(1.0), "angular_velocity": self._vector(8.0)}
                if self._chance(0.3):
                    body |= {"force": self._vector(2.0), "torque": self._vector(0.01)}
                if self._chance(0.3):
                    body["pulls"] = [{"to": [0, 0.5, 0], "period": 0.3}]
        return body

    def _led(self, start: list[float]) -> dict[str, Any]:
        """How a prescribed body moves."""
        if self._chance(0.5):
            return {"velocity": self._vector(0.5), "angular_velocity": self._vector(6.0), "start": self._time()}
        there = (np.array(start) + self._vector(0.05)).tolist()
        return {"keyframes": [{"at": 0.01, "position": start}, {"at": 0.09, "position": there}]}

    def _shape(self, size: float) -> dict[str, Any]:
        """Of no more than `size` [m] about its middle."""
        shapes = [
            {"type": "box", "size": [1.1 * size, 0.9 * size, 1.2 * size]},
            {"type": "sphere", "radius": size},
            {"type": "cylinder", "radius": 0.6 * size, "height": size},
            {"type": "capsule", "radius": 0.5 * size, "height": 0.8 * size},
            {"type": "torus", "radius": 0.6 * size, "tube_radius": 0.35 * size},
        ]
        return self._one_of(shapes)

    def _cloth(self, kinds: list[str]) -> dict[str, Any]:
        sheets = {f"sheet{number}": self._sheet(number) for number in range(self._number(1, 2))}
        self.names += list(sheets)[1:]
        integrators = INTEGRATORS[:1] if "fluid" in kinds else INTEGRATORS
        cloth: dict[str, Any] = {"integrator": self._one_of(integrators), "sheets": sheets}
        if self._chance(0.4):
            cloth["air"] = {"wind": self._vector(3.0)}
        return cloth

    def _sheet(self, number: int) -> dict[str, Any]:
        sheet: dict[str, Any] = {
            "shape": {"type": "sheet", "size": [0.3, 0.3]},
            "spacing": 0.05,
            "position": [0, 0.2 + 0.56 * number, 0],
            "mass_per_area": self._one_of([0.2, 1.0]),
            "thickness": self._one_of([0.002, 0.01]),
            "friction": self._one_of([0.0, 0.3, 1.0]),
            "bend_model": self._one_of(["dihedral", "springs"]),
        }
        if self._chance(0.5):
            sheet["pins"] = self._pins()
        if self._chance(0.3):
            sheet |= {"stretch_stiffness": 200.0, "rest_scale": 1.02, "velocity": self._vector(0.5)}
        return sheet

    def _pins(self) -> list[Any]:
        led = {"at": "left", "keyframes": [{"at": 0.02}, {"at": 0.1, "offset": self._vector(0.03)}]}
        turned = {"at": "right", "velocity": self._vector(0.2), "angular_velocity": [0, 2, 0]}
        return self._one_of([["corners"], [led], ["left", turned]])

    def _probes(self, scene: dict[str, Any]) -> dict[str, Any]:
        """Some of those that the scene can have."""
        rates = {"rate": self._one_of([70.0, 300.0])}
        found: dict[str, Any] = {}
        if "fluid" in scene:
            found |= {"level": {"type": "water_height", "x": 0.1}, "volume": {"type": "volume"}}
            found |= {"press": {"type": "pressure", "at": [0.1, 0.02, 0.1], "mean": self._chance(0.5)}}
            found |= {"front": {"type": "front", "axis": "x"}}
            if "rigid" in scene:
                found["push"] = {"type": "force", "body": "body0", "mean": self._chance(0.5)}
        if "cloth" in scene:
            found |= {"corner": {"type": "vertex", "sheet": "sheet0", "vertex": 3}}
            if "pins" in scene["cloth"]["sheets"]["sheet0"]:
                found["hold"] = {"type": "pin_force", "sheet": "sheet0"}
        return {name: found[name] | rates for name in self._some_of(sorted(found), least=0)}

    def _event(self, scene: dict[str, Any]) -> dict[str, Any]:
        """Something that changes, adds or removes, at a time that may be that of a frame."""
        at = self._one_of([self._time(), self._number(1, FRAMES - 1) / FPS])
        changes: list[Callable[[], dict[str, Any]]] = [lambda: {"set": {"gravity": self._vector(3.0, (0, -7, 0))}}]
        if "fluid" in scene:
            changes.append(lambda: {"set": {"fluid.viscosity": self._one_of([0.0, 0.01])}})
            changes.append(lambda: {"add": {"fluid": {self._new(): self._fluid_body()}}})
            changes.append(lambda: {"add": {"emitters": {self._new(): self._emitter()}}})
        if "rigid" in scene:
            changes.append(lambda: {"set": {"rigid.bodies.body0.friction": 0.2}})
            changes.append(lambda: {"add": {"rigid": {self._new(): self._body()}}})
        if "cloth" in scene:
            changes.append(lambda: {"set": {"cloth.sheets.sheet0.pins": []}})
        if self.names:
            changes.append(lambda: {"remove": [self.names.pop()]})
        return {"at": at} | self._one_of(changes)()

    def _new(self) -> str:
        return f"new{self._number(0, 10**6)}"

    def _time(self) -> float:
        return round(float(self._random.uniform(0, END)), 4)

    def _turn(self, angle: float) -> dict[str, Any]:
        return {"axis": self._one_of([[1, 0, 0], [0, 0, 1], [1, 1, 0]]), "angle": angle}

    def _vector(self, size: float, about: tuple[float, ...] = (0, 0, 0)) -> list[float]:
        return [round(float(value), 3) for value in about + self._random.uniform(-size, size, 3)]

    def _number(self, least: int, most: int) -> int:
        return int(self._random.integers(least, most + 1))

    def _chance(self, share: float) -> bool:
        return bool(self._random.random() < share)

    def _one_of(self, choices: Any) -> Any:
        return choices[self._number(0, len(choices) - 1)]

    def _some_of(self, choices: list[str], *, least: int) -> list[str]:
        number = self._number(least, len(choices))
        return [choices[index] for index in sorted(self._random.choice(len(choices), number, replace=False))]
