"""A heap that rests is solved before its sweeps over contacts end at their cap."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from sim.run.reporting.shortfalls import MANY
from tests.support.bodies import ground, part, step
from tests.support.in_time import in_time
from tests.support.meshes import body, write


def ell() -> trimesh.Trimesh:
    """An L with arms of 0.3 m, 0.1 m wide and high, that lies flat: its faces meet those of others in many points."""
    corners = np.array([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)]) / 10
    count = len(corners)
    outline = np.column_stack((corners[:, 0], np.zeros(count), -corners[:, 1]))
    caps = np.array([(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)])
    k = np.arange(count)
    after = (k + 1) % count
    sides = np.vstack((np.column_stack((k, after, after + count)), np.column_stack((k, after + count, k + count))))
    height = np.array([0, 0.1, 0])
    vertices = np.vstack((outline, outline + height)) - [0.15, 0.05, -0.15]
    return trimesh.Trimesh(vertices, np.vstack((caps[:, ::-1], caps + count, sides)), process=False)


@pytest.mark.parametrize("rounding", [1, *in_time(0, 2, 3, 4)])
def test_sweeps_over_a_heap_at_rest_end_below_their_cap(tmp_path, rounding):
    """Six L shapes and two rings on them, each up to some 1e-7 m elsewhere: which of the many points of two faces are
    contacts, and what they bore before, is chosen by rounding. They stay where they are, to a thousandth of their size,
    while rings rock on the points of a mesh that bear them, by gaps and overlaps of a ten-thousandth."""
    mesh = ell()
    assert mesh.is_watertight and mesh.volume > 0
    path = write(tmp_path / "ell.off", mesh)
    off = np.random.default_rng(rounding).normal(scale=1e-7, size=(8, 3)) * (rounding > 0)
    bodies = {}
    for k in range(6):
        layer, side = divmod(k, 2)
        turned = [{"axis": (0, 1, 0), "angle": 17 + 35 * layer + 90 * side}]
        place = np.array([0.34 * side - 0.17, 0.0501 + 0.1001 * layer, 0.02 * layer]) + off[k]
        bodies[f"ell{k}"] = body(path, density=600, position=place.tolist(), rotation=turned)
    for side in range(2):
        shape = {"type": "torus", "radius": 0.1, "tube_radius": 0.03}
        place = np.array([0.34 * side - 0.17, 0.331, 0.06]) + off[6 + side]
        bodies[f"ring{side}"] = {"motion": "dynamic", "shape": shape, "density": 600, "position": place.tolist()}
    heap = part({**bodies, "floor": ground()}, max_step=0.008)
    step(heap, 0.12)
    began, capped = heap.position.copy(), []
    step(heap, 0.4, lambda _: capped.append(heap.stats["contacts_capped"]))
    assert sum(capped) <= MANY * len(capped)
    assert (np.linalg.norm(heap.position - began, axis=1) < 1e-3 * heap.size).all()
