"""Many objects in a bag: their number and density, whatever the unit of the mesh."""

import meshes
import pytest

import apd_viewer
from apd_viewer.presentation.volume_text import bulk_density, object_count
from apd_viewer.session.quantities.units import Unit


def cube(side, thickness=None):
    V, F = meshes.box(1, 1, 1)
    return apd_viewer.volume_readings(side * V, F, thickness=thickness)


@pytest.mark.parametrize(
    ("side", "unit"), [(10.0, Unit.CENTIMETRE), (100.0, Unit.MILLIMETRE), (0.1, Unit.METRE)]
)
def test_object_count_finds_sixty_four_of_a_litre_in_a_bag_of_a_hundred(side, unit):
    assert object_count(100.0, cube(side), unit) == 64
    assert object_count(100.0, cube(side), unit, packing=1.0) == 100


def test_object_count_is_unknown_without_a_unit():
    assert object_count(100.0, cube(1.0), Unit.NONE) is None


def test_bulk_density_is_that_of_the_mass_in_the_bag():
    found = cube(10.0, 0.1)  # cm: six walls of 10 cm³, 60 cm³ of water in a litre over 0.64
    assert bulk_density(1.0, found) == pytest.approx(60.0 * 0.64)
    assert bulk_density(1.0, cube(100.0, 1.0)) == pytest.approx(60.0 * 0.64)
    count = object_count(1000.0, found, Unit.CENTIMETRE)
    assert count * 0.060 / 1.0 == pytest.approx(bulk_density(1.0, found), rel=1e-3)  # kg in a cubic metre
    assert bulk_density(None, found) is None
    assert bulk_density(1.0, cube(10.0)) is None
