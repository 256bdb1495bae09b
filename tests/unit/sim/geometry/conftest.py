from pathlib import Path

import numpy as np
import pytest
import trimesh


@pytest.fixture(autouse=True, scope="session")
def _cache(tmp_path_factory):
    """One cache of its own for the whole session: the bunny is repaired once."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("TIDEMILL_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="session")
def bunny_file() -> Path:
    from scene.assets import resolve

    return resolve("pymeshfix:examples/StanfordBunny.ply", Path())


@pytest.fixture
def random() -> np.random.Generator:
    return np.random.default_rng(7)


@pytest.fixture
def cube() -> trimesh.Trimesh:
    """The unit cube around the origin, 12 faces."""
    return trimesh.creation.box()


@pytest.fixture
def two_cubes(cube):
    """Build two unit cubes in one mesh, the second moved by `offset` and scaled by `scale`."""

    def build(offset, scale=1.0, inverted=False):
        faces = cube.faces[:, ::-1] if inverted else cube.faces
        return trimesh.Trimesh(
            np.vstack([cube.vertices, scale * cube.vertices + offset]),
            np.vstack([cube.faces, faces + len(cube.vertices)]),
            process=False,
        )

    return build
