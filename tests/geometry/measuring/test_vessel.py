"""Vessels filled to a level, against closed forms."""

import meshes
import numpy as np
import pytest

import apd_viewer
from apd_viewer import InputError, Vessel
from apd_viewer.files.samples import resource_path

UP = np.array([0.0, 0.0, 1.0])


def open_cone(n, radius, height, tip=0.0):
    """Frustum of a regular pyramid with a floor of radius ``tip``, open above; the area of a unit polygon."""
    angle = 2 * np.pi * np.arange(n) / n
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    V = np.vstack([np.column_stack([r * ring, np.full(n, z)]) for r, z in ((tip, 0.0), (radius, height))])
    i, j = np.arange(n), (np.arange(n) + 1) % n
    F = np.vstack([np.column_stack([i, j, j + n]), np.column_stack([i, j + n, i + n])])
    floor = np.column_stack([j, i, np.full(n, 2 * n)])
    return np.vstack([V, [[0.0, 0.0, 0.0]]]), np.vstack([F, floor]), 0.5 * n * np.sin(2 * np.pi / n)


@pytest.mark.parametrize("level", [0.0, 0.3, 1.0, 2.5])
def test_vessel_of_a_cylinder_holds_base_times_level(level):
    V, F, base = open_cone(60, 1.5, 2.5, tip=1.5)
    vessel = Vessel(V, F, UP)
    assert (vessel.bottom, vessel.brim) == (0.0, 2.5)
    assert vessel.volume(level) == pytest.approx(base * 1.5**2 * level, rel=1e-12, abs=1e-15)
    assert vessel.level(vessel.volume(level)) == pytest.approx(level, abs=1e-9)


def test_vessel_of_a_cone_holds_the_cube_of_its_level():
    V, F, base = open_cone(48, 2.0, 3.0, tip=1e-9)
    vessel = Vessel(V, F, UP)
    for level in (0.5, 1.5, 3.0):
        exact = base * (2.0 * level / 3.0) ** 2 * level / 3.0
        assert vessel.volume(level) == pytest.approx(exact, rel=1e-6)
    assert vessel.level(vessel.brimful / 8.0) == pytest.approx(1.5, rel=1e-6)


@pytest.mark.parametrize("level", [-0.7, 0.0, 0.4, 1.0])
def test_vessel_of_a_sphere_holds_its_cap(level):
    coarse, fine = (Vessel(*meshes.sphere(count), UP).volume(level) for count in (5, 6))
    exact = np.pi * (1.0 + level) ** 2 * (2.0 - level) / 3.0
    assert fine == pytest.approx(exact, rel=1e-3)
    assert (4.0 * fine - coarse) / 3.0 == pytest.approx(exact, rel=1e-6)  # for edges of length 0


def test_vessel_that_is_tilted_spills_at_the_low_side_of_its_rim():
    V, F, base = open_cone(400, 1.0, 3.0, tip=1.0)
    for slope in (0.2, 0.7, 1.3):
        up = np.array([slope, 0.0, 1.0])
        vessel = Vessel(V, F, up)
        # The surface falls from 3 to 3 - 2 slope across the cylinder, on the average to 3 - slope.
        assert vessel.brimful == pytest.approx(base * (3.0 - slope), rel=1e-9)
    ungula = Vessel(V, F, [3.0, 0.0, 1.0])  # the surface meets the floor in the middle: half an ungula
    assert ungula.brimful == pytest.approx(2.0 / 3.0 * 3.0, rel=1e-3)


def test_vessel_is_measured_the_same_wherever_it_is_and_whatever_its_faces():
    V, F, _ = open_cone(30, 1.0, 2.0, tip=0.6)
    R = meshes.rotation((1, 2, 3), 0.8)
    first = Vessel(V, F, UP)
    for other in (Vessel(V @ R.T + 1e3, F, R @ UP), Vessel(V, F[:, ::-1], 5.0 * UP)):
        assert other.brimful == pytest.approx(first.brimful, rel=1e-9)
        half = 0.5 * first.brimful
        assert other.level(half) - other.bottom == pytest.approx(first.level(half) - first.bottom, abs=1e-9)


def test_vessel_with_seams_holds_what_its_welded_surface_holds():
    V, F, _ = open_cone(30, 1.0, 2.0, tip=0.6)
    soup = Vessel(V[F.ravel()], np.arange(F.size).reshape(-1, 3), UP)
    assert soup.brimful == pytest.approx(Vessel(V, F, UP).brimful, rel=1e-12)


def test_vessel_with_two_walls_holds_its_inner_volume():
    outer, F, base = open_cone(80, 1.0, 3.0, tip=1.0)
    inner = outer * [0.98, 0.98, 1.0] + [0.0, 0.0, 0.03]
    inner[80:160, 2] = 3.0
    i, j = np.arange(80) + 80, (np.arange(80) + 1) % 80 + 80
    n = len(outer)
    rim = np.vstack([np.column_stack([i, j, j + n]), np.column_stack([i, j + n, i + n])])
    V, T = np.vstack([outer, inner]), np.vstack([F, F[:, ::-1] + n, rim])
    assert apd_viewer.volume_readings(V, T).capacity == pytest.approx(base * 0.98**2 * 2.97, rel=1e-6)
    vessel = Vessel(V, T, UP)
    assert vessel.brimful == pytest.approx(base * 0.98**2 * 2.97, rel=1e-6)
    assert vessel.volume(1.03) == pytest.approx(base * 0.98**2, rel=1e-6)


def test_vessel_spills_what_a_twist_takes_from_it():
    V, F, _ = open_cone(60, 1.0, 3.0, tip=1.0)
    heights = V[:, 2:] / 3.0
    squeezed = V * (1.0 - 0.3 * np.sin(np.pi * heights) ** 2) ** [1, 0, 0]
    full = Vessel(V, F, UP).brimful
    filling = Vessel(squeezed, F, UP).filling(full)
    enclosed = [apd_viewer.volume_readings(U, F).enclosed for U in (V, squeezed)]
    assert filling.spilled == pytest.approx(enclosed[0] - enclosed[1], rel=1e-9)
    assert filling.freeboard == 0.0
    assert filling.level == pytest.approx(3.0)


def test_vessel_refuses_what_it_cannot_hold():
    V, F, _ = open_cone(12, 1.0, 2.0, tip=1.0)
    vessel = Vessel(V, F, UP)
    for volume in (-1.0, 1.001 * vessel.brimful, np.nan, "all"):
        with pytest.raises(InputError, match="It holds"):
            vessel.level(volume)
    with pytest.raises(InputError, match="opening is at the lowest point"):
        Vessel(V, F, -UP)
    with pytest.raises(InputError, match="direction"):
        Vessel(V, F, np.zeros(3))
    G = F.copy()
    G[0] = G[0][::-1]
    with pytest.raises(InputError, match="cannot be filled"):
        Vessel(V, G, UP)


@pytest.mark.parametrize("slope", [0.0, 0.5])
def test_vessel_holds_up_to_the_lowest_opening_that_is_not_closed(slope):
    V, F = meshes.box_with_openings()
    up = np.array([slope, 0.0, 1.0])
    low, high = Vessel.openings(V, F, up)
    assert (V[low, [0, 2]].tolist(), V[high, [0, 2]].tolist()) == ([0.0, 3.0], [4.0, 6.0])
    # The surface z = 3 - slope x ends at the lower opening, z = 6 + slope (4 - x) at the upper one.
    held = {
        (): 5 * (12 - 8 * slope),
        (low,): 5 * (24 + 8 * slope),
        (low, high): 200.0,
        (high,): 5 * (12 - 8 * slope),
    }
    soup = V[F.ravel()], np.arange(F.size).reshape(-1, 3)
    for closed, volume in held.items():
        assert Vessel(V, F, up, closed).brimful == pytest.approx(volume, rel=1e-12)
        corners = [int(np.argmax(F.ravel() == vertex)) for vertex in closed]
        assert Vessel(*soup, up, corners).brimful == pytest.approx(volume, rel=1e-12)


def test_vessel_with_an_opening_below_holds_only_with_that_closed():
    V, F, base = open_cone(12, 1.0, 2.0, tip=1.0)
    floorless = F[(V[F][:, :, 2] > 0).any(axis=1)]
    low, high = Vessel.openings(V, floorless, UP)
    with pytest.raises(InputError, match="opening is at the lowest point"):
        Vessel(V, floorless, UP, [high])
    assert Vessel(V, floorless, UP, [low]).brimful == pytest.approx(2.0 * base)
    assert not len(Vessel.openings(*meshes.box(), UP))
    for vertex in (-1, 24, len(V)):  # the middle of the floor that is not there
        with pytest.raises(InputError, match="at no opening"):
            Vessel(V, floorless, UP, [vertex])


def test_vessel_of_the_sample_agrees_with_its_sections():
    bottle = apd_viewer.open_mesh(resource_path("bottle.obj"))
    vessel = Vessel(bottle.V, bottle.F, (0, 1, 0))
    assert vessel.brimful == pytest.approx(500.0, rel=1e-6)
    levels = np.linspace(vessel.bottom, vessel.brim, 401)[1:-1]
    areas = [apd_viewer.plane_section(bottle.V, bottle.F, (0, y, 0), (0, 1, 0)).area for y in levels]
    by_areas = np.trapezoid(areas, levels) if hasattr(np, "trapezoid") else np.trapz(areas, levels)
    assert vessel.volume(levels[-1]) - vessel.volume(levels[0]) == pytest.approx(by_areas, rel=1e-4)
