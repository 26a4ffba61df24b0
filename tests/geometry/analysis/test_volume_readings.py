"""Volumes by name: closed forms, and the laws of scale and of rigid motion."""

import meshes
import numpy as np
import pytest

import apd_viewer
from apd_viewer.geometry.analysis.hull_readings import DENSEST, LOOSEST, PACKING


def readings(V, F, thickness=None):
    return apd_viewer.volume_readings(V, F, thickness=thickness)


def open_box():
    V, F = meshes.box(2, 2, 5)
    return V, F[~(V[F][:, :, 2] == 5).all(axis=1)]


@pytest.mark.parametrize(("sides", "area"), [((1, 1, 1), 6.0), ((2, 3, 5), 62.0)])
def test_volume_readings_of_a_box_are_all_the_same_but_material_and_bulk(sides, area):
    found = readings(*meshes.box(*sides), thickness=0.01)
    volume = float(np.prod(sides))
    assert found.enclosed == pytest.approx(volume)
    assert found.hull.volume == pytest.approx(volume)
    assert found.hull.box == pytest.approx(volume)
    assert found.hull.sides == pytest.approx(sorted(sides))
    assert found.hull.width == pytest.approx(min(sides))
    assert found.hull.bulk() == pytest.approx(volume / PACKING)
    assert (found.openings, found.area) == (0, pytest.approx(area))
    assert found.material == pytest.approx(0.01 * area)


def test_volume_readings_of_an_open_box_enclose_what_its_cap_closes():
    found = readings(*open_box())
    assert (found.enclosed, found.openings) == (pytest.approx(20.0), 1)
    assert found.hull.volume == pytest.approx(20.0)
    assert found.material is None
    assert readings(*meshes.grid(3, 3)).enclosed is None


def test_volume_readings_of_a_ball_have_the_ball_as_its_hull():
    found = readings(*meshes.sphere(3))
    assert found.hull.volume == pytest.approx(found.enclosed, rel=1e-12)
    assert found.enclosed == pytest.approx(4 / 3 * np.pi, rel=0.02)
    assert found.hull.box == pytest.approx(8.0, rel=0.02)


def test_volume_readings_of_a_dented_shape_have_less_enclosed_volume_alone():
    V, F = meshes.sphere(3)
    dented = V.copy()
    near = dented[:, 2] > 0.6
    dented[near, 2] = 1.2 - dented[near, 2]
    found = readings(dented, F)
    # The hull has lost the cap, and the inside has lost it twice.
    assert found.hull.volume - found.enclosed == pytest.approx(
        readings(V, F).enclosed - found.hull.volume, rel=0.1
    )
    assert found.hull.volume < found.hull.box


@pytest.mark.parametrize("scale", [1e-3, 7.0])
def test_volume_readings_scale_as_lengths_and_volumes_as_their_cube(scale):
    V, F = open_box()
    found, scaled = readings(V, F, 0.1), readings(scale * V, F, scale * 0.1)
    assert scaled.enclosed == pytest.approx(scale**3 * found.enclosed)
    assert scaled.hull.volume == pytest.approx(scale**3 * found.hull.volume)
    assert scaled.hull.bulk() == pytest.approx(scale**3 * found.hull.bulk())
    assert scaled.material == pytest.approx(scale**3 * found.material)
    assert scaled.hull.width == pytest.approx(scale * found.hull.width)
    assert scaled.hull.sides == pytest.approx(scale * np.array(found.hull.sides))


def test_volume_readings_are_unchanged_by_a_rigid_motion():
    V, F, _ = meshes.sample_bottle(3.0)
    found = readings(V, F)
    moved = readings(V @ meshes.rotation([1, 2, 3], 0.7).T + [9, -4, 70], F)
    assert moved.enclosed == pytest.approx(found.enclosed, rel=1e-9)
    assert moved.hull.volume == pytest.approx(found.hull.volume, rel=1e-9)
    assert moved.hull.width == pytest.approx(found.hull.width, rel=1e-9)
    assert moved.hull.box == pytest.approx(found.hull.box, rel=1e-4)


def test_hull_readings_take_less_room_by_denser_packing_and_a_bag_holds_what_fits():
    hull = readings(*meshes.box(1, 1, 1)).hull
    assert hull.bulk(DENSEST) < hull.bulk() < hull.bulk(LOOSEST)
    assert hull.count_in(100.0) == 64
    assert hull.count_in(hull.bulk()) == 1
    assert hull.count_in(0.999 * hull.bulk()) == 0


@pytest.mark.parametrize("thickness", [0.0, -1.0, np.nan, np.inf])
def test_volume_readings_need_a_thickness_of_a_wall(thickness):
    with pytest.raises(apd_viewer.InputError, match="greater than 0"):
        readings(*meshes.box(1, 1, 1), thickness=thickness)


def test_volume_readings_refuse_what_is_no_mesh_in_a_sentence():
    with pytest.raises(apd_viewer.InputError, match="No faces"):
        readings(np.zeros((3, 3)), np.zeros((0, 3), dtype=int))
    with pytest.raises(apd_viewer.InputError, match="real numbers"):
        readings("x", [[0, 1, 2]])
