"""Units of length: each size has its members, and its name in the window."""

from apd_viewer.notation import MICROMETRES
from apd_viewer.session.quantities.units import UNIT_NAMES, Unit


def test_unit_has_each_size_as_a_unit_a_guess_and_a_name():
    confirmed = {Unit(symbol) for symbol in ("", *MICROMETRES)}
    assert set(UNIT_NAMES) == confirmed
    assert set(Unit) == confirmed | {unit.as_guess for unit in confirmed}
