"""What is a hole in a solid, which mending closes, and what is the mouth of a vessel, which it must not."""

import numpy as np
import pytest
import trimesh

from scene.settings import Refused
from sim.geometry.meshes.openings import openings
from sim.geometry.meshes.repair import repair
from sim.geometry.meshes.topology import joined
from tests.support.surfaces import bottle, bowl, revolved, tray


def without(mesh, faces):
    keep = np.ones(len(mesh.faces), dtype=bool)
    keep[faces] = False
    return trimesh.Trimesh(mesh.vertices, mesh.faces[keep], process=False)


def around(mesh, point, radius):
    """The faces that come within `radius` of a point."""
    return np.flatnonzero((np.linalg.norm(mesh.triangles - point, axis=2) < radius).any(axis=1))


def ball():
    return trimesh.creation.icosphere(subdivisions=4)


def basket():
    """A bowl of which every sixth face is missing: as many small holes as leave no solid."""
    mesh = trimesh.creation.icosphere(subdivisions=3)
    return without(mesh, np.arange(0, len(mesh.faces), 6))


VESSELS = {
    "bowl": bowl,
    "tray": tray,
    "glass": lambda: revolved(np.array([[0, 0], [1, 0], [1, 2], [1, 4]])),
    "test tube": lambda: revolved(np.array([[0, 0], [1, 0], [1, 10], [1, 20], [1, 30]])),
    "bottle": bottle,
    "dish": lambda: revolved(np.array([[0, 0], [1, 0.1], [2, 0.4]])),
    "pipe": lambda: revolved(np.array([[1, 0], [1, 2], [1, 4]])),
    "basket": basket,
    "turned bowl": lambda: bowl().apply_transform(trimesh.transformations.rotation_matrix(0.7, [1, 2, 3])),
    "bowl with faces turned": lambda: trimesh.Trimesh(bowl().vertices, bowl().faces[:, ::-1], process=False),
}


@pytest.mark.parametrize("name", VESSELS)
def test_a_vessel_is_refused_with_both_remedies(name):
    mesh = VESSELS[name]()
    with pytest.raises(Refused, match=r"is open: it has (an opening|\d+ openings, the widest)") as refused:
        repair(mesh, name="vessel.obj")
    assert "'vessel.obj'" in refused.value.message
    assert "`thickness`" in refused.value.remedy
    assert "`close: all`" in refused.value.remedy


@pytest.mark.parametrize("name", [name for name in VESSELS if name not in ("pipe", "basket")])
def test_a_vessel_is_filled_where_that_is_wanted(name):
    """As much as the cone from the middle of its rim to its faces encloses."""
    mesh = VESSELS[name]()
    [rim] = openings(mesh, mesh)
    corners = mesh.triangles - rim.points.mean(axis=0)
    cone = abs(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))) / 6
    mended, report = repair(mesh, name="vessel", close="all")
    assert mended.volume == pytest.approx(cone, rel=1e-6)
    assert report.holes == 1


def test_how_large_a_mouth_is():
    """A bowl of radius 1: 2 wide, a lid of pi r^2, and a wall that is upright at its rim."""
    [rim] = openings(bowl(), bowl())
    assert rim.width == pytest.approx(2)
    assert rim.lid == pytest.approx(np.pi, rel=1e-3)
    # The last faces of the quarter circle lean by half of 1/24 of 90 degrees.
    assert rim.steep == pytest.approx(1, abs=1e-3)
    with pytest.raises(Refused, match=r"an opening 2 wide, where the mesh is 2 long\. Closing that would add 50 %"):
        repair(bowl(), name="bowl")


HOLES = {
    "one face": lambda: without(ball(), [7]),
    "three patches": lambda: without(ball(), np.concatenate([around(ball(), axis, 0.15) for axis in np.eye(3)])),
    "ragged": lambda: without(ball(), np.random.default_rng(2).permutation(around(ball(), [0, 1, 0], 0.3))[::2]),
    "one face of a box": lambda: without(trimesh.creation.box().subdivide().subdivide(), [5]),
}


@pytest.mark.parametrize("name", HOLES)
def test_a_hole_is_closed(name):
    """A ball of which at most 4 % of the surface is missing: the lids are flatter than the ball, by a height of less
    than 0.3^2 / 2 over that share."""
    mesh = HOLES[name]()
    whole = 4 / 3 * np.pi if "box" not in name else 1.0
    mended, report = repair(mesh, name="solid")
    assert mended.volume == pytest.approx(whole, rel=1e-2)
    assert report.holes >= 1


def test_an_open_limb_in_a_body_is_no_vessel():
    """A tube without its lower lid, which is inside a ball: what sticks out is pi r^2 times the length from the sphere,
    on which it ends, at sqrt(1 - r^2 s^2) for s in [0, 1]."""
    radius = 0.2
    limb = revolved(np.array([[radius, 0.5], [radius, 1.5], [0, 1.5]]), 192)
    mended, report = repair(joined([trimesh.creation.icosphere(subdivisions=5), limb]), name="figure")
    cap = 2 / 3 * np.pi * (1 - (1 - radius**2) ** 1.5)
    # The ball of 20,480 faces is 5e-4 short of 4/3 pi.
    assert mended.volume == pytest.approx(4 / 3 * np.pi + np.pi * radius**2 * 1.5 - cap, rel=1e-3)
    assert report.pieces_united == 2
    assert report.holes == 1


def test_a_wall_between_two_rooms_is_no_mouth():
    """A box with a wall across its middle, whose four edges there have three faces: neither half is open."""
    half = trimesh.creation.box()
    other = half.copy()
    other.apply_translation([1, 0, 0])
    keep = other.face_normals[:, 0] > -0.5
    mesh = joined([half, trimesh.Trimesh(other.vertices, other.faces[keep], process=False)])
    mended, _ = repair(mesh, name="rooms")
    assert mended.volume == pytest.approx(2)


def test_a_repair_that_adds_much_is_refused_with_a_picture(tmp_path, monkeypatch):
    """Many shallow holes: none is a mouth, but together their lids are no mending."""
    from PIL import Image

    monkeypatch.setenv("TIDEMILL_CACHE", str(tmp_path))
    with pytest.raises(Refused, match=r"as the picture (\S+\.png) shows") as refused:
        repair(basket(), name="basket.obj")
    [picture] = (tmp_path / "pictures").iterdir()
    assert str(picture) in refused.value.message
    assert picture.name.startswith("basket-")
    pixels = np.asarray(Image.open(picture).convert("RGB")).astype(int)
    red = (pixels[..., 0] > 2 * pixels[..., 1]) & (pixels[..., 0] > 2 * pixels[..., 2])
    grey = (np.ptp(pixels, axis=2) < 10) & (pixels[..., 0] < 240)
    assert red.sum() > 1000
    assert grey.sum() > red.sum()


def test_what_is_lost_is_blue_in_the_picture(tmp_path, monkeypatch):
    from PIL import Image

    monkeypatch.setenv("TIDEMILL_CACHE", str(tmp_path))
    flag = trimesh.Trimesh([[0, 2, 0], [2, 2, 0], [2, 3, 0], [0, 3, 0]], [[0, 1, 2], [0, 2, 3]], process=False)
    with pytest.raises(
        Refused, match=r"the area 8 would become 6, 0 % of it added .* 25 % taken away with 1 of 2 pieces"
    ):
        repair(joined([trimesh.creation.box(), flag]), name="house.obj")
    [picture] = (tmp_path / "pictures").iterdir()
    pixels = np.asarray(Image.open(picture).convert("RGB")).astype(int)
    assert ((pixels[..., 2] > 1.5 * pixels[..., 0]) & (pixels[..., 2] > pixels[..., 1])).sum() > 1000


def test_without_a_folder_for_pictures_the_reason_is_told(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("TIDEMILL_CACHE", str(tmp_path / "file"))
    with pytest.raises(Refused, match="is open") as refused:
        repair(bowl(), name="bowl")
    assert "picture" not in refused.value.message
