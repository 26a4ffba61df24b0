"""Volume targets as they are written: percentages and volumes."""

import pytest

from apd_viewer.errors import InputError
from apd_viewer.session.quantities.units import NoUnitError, Unit
from apd_viewer.session.quantities.volume_target import parse_volume_target


@pytest.mark.parametrize(("text", "percent"), [("120%", 120.0), ("120", 120.0), (" 5 % ", 5.0)])
def test_parse_volume_target_reads_percent_of_the_rest_volume(text, percent):
    for unit in (Unit.NONE, Unit.CENTIMETRE):
        assert parse_volume_target(text, unit) == (percent, None)


@pytest.mark.parametrize(
    ("text", "cubic"),
    [("250ml", 250.0), ("0.25 l", 250.0), ("25cl", 250.0), ("0.1 m^3", 1e5), ("2 cm³", 2.0)],
)
def test_parse_volume_target_reads_a_volume_in_cubic_units_of_the_mesh(text, cubic):
    percent, filled = parse_volume_target(text, Unit.CENTIMETRE)
    assert percent is None
    assert filled == pytest.approx(cubic)


@pytest.mark.parametrize("text", ["", "3cm", "-250ml", "0ml", "1.2", "2000%", "full"])
def test_parse_volume_target_refuses_what_is_neither(text):
    with pytest.raises(InputError):
        parse_volume_target(text, Unit.CENTIMETRE)


def test_parse_volume_target_needs_the_unit_of_the_mesh_for_litres():
    with pytest.raises(NoUnitError, match="not set; choose it before entering ml"):
        parse_volume_target("250ml", Unit.NONE)
