"""An open surface with flat caps: closed forms, and the volume of the mesh that really has them."""

import numpy as np
import pytest
import trimesh
from meshes import box, grid, rabbit, rotation, soup, sphere, tube
from numpy.testing import assert_allclose

from apd_viewer.files.samples import open_sample
from apd_viewer.geometry.analysis.inspection import inspect
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.edges_and_components import opposite_half_edges
from apd_viewer.geometry.mesh.hole_caps import Caps, capped_volume
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.deformation_result import deform

AWAY = np.array([300.0, -70.0, 20.0])


def opened_box():
    """A box of 20 without its top, of the height 5."""
    V, F = box(2, 2, 5)
    return V, F[(V[F][:, :, 2] < 5).any(axis=1)]


def caps_of(F):
    return Caps.from_triangles(F, opposite_half_edges(F, F.max() + 1))


def sewn(V, F, caps):
    """The volume and the area of the same surface with the caps sewn in, by trimesh."""
    size = np.diff(caps.start, append=len(caps.ends))
    middles = np.array([V[part[:, 0]].mean(axis=0) for part in np.split(caps.ends, caps.start[1:])])
    fans = np.column_stack([caps.ends, len(V) + np.repeat(np.arange(len(size)), size)])
    other = trimesh.Trimesh(np.vstack([V, middles]), np.vstack([F, fans]), process=False)
    assert other.is_watertight
    assert other.is_winding_consistent
    return other.volume, trimesh.Trimesh(other.vertices, fans, process=False).area


def test_capped_volume_of_a_box_without_its_top_is_that_of_the_box():
    V, F = opened_box()
    caps = caps_of(F)
    assert caps.count == 1
    assert capped_volume(caps, V, F) == pytest.approx(20.0, rel=1e-14)
    assert capped_volume(caps, V, F[:, ::-1]) != pytest.approx(20.0)
    assert caps.area(V) == pytest.approx(4.0, rel=1e-14)


def test_caps_turn_a_tube_into_a_prism_with_two_caps():
    V, F = tube(9, 7, height=3.0)
    caps, floor = caps_of(F), 9 / 2 * np.sin(2 * np.pi / 9)
    assert caps.count == 2
    assert caps.area(V) == pytest.approx(2 * floor, rel=1e-13)
    assert capped_volume(caps, V, F) == pytest.approx(sewn(V, F, caps)[0], rel=1e-13)


@pytest.mark.parametrize("seed", range(4))
def test_capped_volume_of_a_wild_surface_is_that_of_the_one_with_the_caps_sewn_in(seed):
    """Two holes whose borders lie in no plane, anywhere in space."""
    V, F = rabbit()
    rng = np.random.default_rng(seed)
    U = (V + 0.1 * rng.normal(size=V.shape)) @ rotation(rng.normal(size=3), 2.0).T + seed * AWAY
    caps = caps_of(F)
    assert caps.count == 2
    assert_allclose(capped_volume(caps, U, F), sewn(U, F, caps)[0], rtol=1e-10)
    assert caps.area(U) <= sewn(U, F, caps)[1]


def test_caps_area_of_a_cap_that_is_no_convex_polygon_is_its_own():
    """The mouth is the letter L: the fan turns over, and its parts cancel out."""
    V, F = box(3, 3, 2)
    middle = V[F].mean(axis=1)
    mouth = (middle[:, 2] == 2) & ((middle[:, 0] < 1) | (middle[:, 1] < 1))
    caps = caps_of(F[~mouth])
    assert caps.area(V) == pytest.approx(5.0, rel=1e-13)
    assert capped_volume(caps, V, F[~mouth]) == pytest.approx(18.0, rel=1e-13)


def test_caps_cover_nothing_that_they_would_not_close():
    V, F = sphere(1)
    assert caps_of(F) is None, "it is closed"
    turned = F[1:].copy()
    turned[7] = turned[7, ::-1]
    assert caps_of(turned) is None, "the sides differ"
    assert caps_of(np.vstack([F[1:], [[F[5, 0], F[5, 1], len(V)]]])) is None, "not manifold"
    V, F = grid(4, 4)
    assert capped_volume(caps_of(F), V @ rotation([1, 2, 3], 1.0).T + AWAY, F) is None, "a flat sheet"


def cut(V, F, height):
    """The part of a surface above a height, without the vertices below."""
    used, F = np.unique(F[(V[F][:, :, 2] > height).all(axis=1)], return_inverse=True)
    return V[used], F.reshape(-1, 3)


def patch(sag):
    """A square sheet of side 1 that bulges by ``sag`` in its middle."""
    V, F = grid(20, 20, 0.05, 0.05)
    V[:, 2] = sag * np.sin(np.pi * V[:, 0]) * np.sin(np.pi * V[:, 1])
    return V, F


VESSELS = {
    "hemisphere": lambda: cut(*sphere(4), 0.0),
    "bowl": lambda: cut(*sphere(4), 0.7),
    "box": opened_box,
    "tray": lambda: (opened_box()[0] * [1, 1, 0.02], opened_box()[1]),
    "bottle": lambda: cut(*sphere(4), -0.95),
    "tube": lambda: tube(16, 20),
    "straw": lambda: (tube(16, 20)[0] * [0.01, 0.01, 10.0], tube(16, 20)[1]),
}


@pytest.mark.parametrize("kind", VESSELS)
@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_capped_volume_of_a_vessel_is_there_at_any_scale(kind, scale):
    V, F = VESSELS[kind]()
    found = capped_volume(caps := caps_of(F), scale * V, F)
    assert found == pytest.approx(scale**3 * sewn(V, F, caps)[0], rel=1e-9)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_capped_volume_of_a_sheet_is_none_though_it_is_slightly_curved(scale):
    V, F = patch(0.03)
    assert capped_volume(caps_of(F), scale * V, F) is None


def test_capped_volume_of_the_hemmed_cloth_is_none_flat_and_folded():
    cloth, _ = open_sample("cloth")
    rest = RestMesh(cloth.V, cloth.F, cloth.weld)
    assert (inspect(cloth).volume_capped, inspect(cloth).openings) == (None, 0)
    folded = rest.solve_mesh.V.copy()
    folded[:, 2] *= 5.0
    assert rest.measure(folded).volume_capped is None


def test_inspect_says_what_is_capped_and_leaves_the_volume_alone():
    found = inspect(Mesh(*soup(*opened_box())))
    assert found.volume is None
    assert found.missing_volume_reason == "the surface is open (8 boundary edges)"
    assert found.volume_capped == pytest.approx(20.0, rel=1e-14)
    assert found.openings == 1
    closed, sheet = inspect(Mesh(*box())), inspect(Mesh(*grid()))
    assert (closed.volume_capped, closed.openings) == (sheet.volume_capped, sheet.openings) == (None, 0)


def test_deformation_frames_all_have_the_volume_with_the_mouth_capped():
    V, F = opened_box()
    V, F = soup(V, F)
    fixed = np.flatnonzero((V[:, 2] == 0) | (V[:, 2] >= 4))
    targets = V[fixed] + np.where(V[fixed, 2:] > 0, [0.3, 0.0, -1.5], 0.0)
    solver = Deformation(V, F, fixed)
    solver.aim(targets)
    for _ in range(3):
        frame = solver.step()
        joined = Mesh(frame.U, F).joined_F
        assert frame.volume is None
        assert frame.volume_capped == pytest.approx(sewn(frame.U, joined, caps_of(joined))[0])
    result = deform(V, F, fixed, targets)
    assert result.volume_capped_rest == pytest.approx(20.0, rel=1e-13)
    assert result.openings == 1
    assert result.volume is None
    assert result.volume_capped == pytest.approx(sewn(result.U, joined, caps_of(joined))[0])
    assert result.volume_capped < 19.9
