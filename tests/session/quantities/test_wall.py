"""What a wall weighs: against units worked out by hand."""

import time

import pytest

from apd_viewer.errors import InputError
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import WallText, typed_mass
from apd_viewer.session.quantities.wall_material import (
    parse_density,
    parse_pressure_difference,
    parse_young_modulus,
)

MM, CM, M, NONE = Unit.MILLIMETRE, Unit.CENTIMETRE, Unit.METRE, Unit.NONE


@pytest.mark.parametrize(
    ("wall", "area", "unit", "grams"),
    [
        (("0.3mm", "1.38 g/cm3"), 500.0, CM, 500 * 0.03 * 1.38),
        (("0.3mm", "1380 kg/m³"), 50_000.0, MM, 500 * 0.03 * 1.38),
        (("0.03", "1.38"), 500.0, CM, 500 * 0.03 * 1.38),
        (("300um", "1,38 kg/l"), 0.05, M, 500 * 0.03 * 1.38),
        (("2 mm", "7.85 g/cm^3"), 1.0, M, 2 * 7850),
        (("1/100 in", "1000 g/l"), 1.0, CM, 2.54 / 100),
        (("1/100 in", "86.15 lb/ft³"), 100.0, Unit.INCH, 86.15 / 1728 * 453.59237),
        (("1/100 in", "0.8 oz/in^3"), 100.0, Unit.INCH, 0.8 * 28.349523125),
        (("1 ft", "3 lb / ft3"), 1.0, Unit.FOOT, 3 * 453.59237),
        (("0.1mm + 0.2mm", "2 * 0.69"), 500.0, CM, 500 * 0.03 * 1.38),
    ],
)
def test_mass_unit_is_area_times_thickness_times_density(wall, area, unit, grams):
    assert typed_mass(WallText(*wall), area, unit) == pytest.approx(grams, rel=1e-12)


def test_mass_unit_is_none_where_nothing_is_typed():
    assert typed_mass(WallText(), 1.0, NONE) is None
    assert typed_mass(WallText(" ", ""), 1.0, CM) is None


@pytest.mark.parametrize(
    ("wall", "unit", "words"),
    [
        (("0.3mm", "1.38"), NONE, "needs the unit of the mesh; choose it"),
        (("0.3mm", ""), CM, "needs a density"),
        (("", "1.38"), CM, "needs a wall thickness"),
        (("0", "1.38"), CM, "greater than 0"),
        (("-1mm", "1.38"), CM, "greater than 0"),
        (("30deg", "1.38"), CM, "an angle"),
        (("thin", "1.38"), CM, "unknown"),
        (("0.3mm", "light"), CM, "“light” is not a density"),
        (("0.3mm", "1.38 stone/ft3"), CM, "not a unit of density"),
        (("0.3mm", "0"), CM, "A density of"),
        (("0.3mm", "1380"), CM, "A density of 1380"),
        (("0.3mm", "1mm"), CM, "“1mm” is not a density"),
    ],
)
def test_mass_unit_says_in_a_sentence_what_makes_no_sense(wall, unit, words):
    with pytest.raises(InputError, match=words):
        typed_mass(WallText(*wall), 1.0, unit)


def test_parse_density_is_the_same_in_all_its_units():
    alike = (
        "1.2",
        "2^2 * 0.3 kg/l",
        "1.2g/cm3",
        "1.2 g / cm³",
        "1.2 kg/l",
        "1200kg/m3",
        "1.2 t/m3",
        "1.2 g/ml",
        "1,2 kg/dm³",
    )
    assert {round(parse_density(text), 12) for text in alike} == {1.2}


def test_to_litres_convert_a_volume_from_the_unit_of_length():
    assert [unit.to_litres(1.0) for unit in (MM, CM, M, NONE)] == pytest.approx([1e-6, 1e-3, 1e3, None])


@pytest.mark.parametrize(
    ("wall", "unit", "said"),
    [
        (("0.3mm", "1.38"), Unit.CENTIMETRE, "0.3mm, 1.38\u00a0g/cm³"),
        (("0.3", "1380 kg/m3"), Unit.MILLIMETRE, "0.3\u00a0mm, 1380 kg/m3"),
        ((" 1/2 ", ""), Unit.MILLIMETRE, "1/2\u00a0mm"),
        (("", "heavy"), Unit.NONE, "heavy"),
        (("", ""), Unit.NONE, ""),
    ],
)
def test_wall_written_gives_a_bare_number_the_unit_that_it_is_in(wall, unit, said):
    assert WallText(*wall).text(unit) == said


@pytest.mark.parametrize(
    ("unit", "value", "power", "legible", "factor"),
    [
        (Unit.MILLIMETRE, 999_999.0, 2, Unit.MILLIMETRE, 1.0),
        (Unit.MILLIMETRE, 1.2e6, 2, Unit.CENTIMETRE, 1e-2),
        (Unit.MILLIMETRE, -5e9, 3, Unit.METRE, 1e-9),
        (Unit.CENTIMETRE, 2e7, 3, Unit.METRE, 1e-6),
        (Unit.METRE, 1e9, 2, Unit.METRE, 1.0),
        (Unit.NONE, 1e9, 2, Unit.NONE, 1.0),
        (Unit.CENTIMETRE, float("nan"), 3, Unit.CENTIMETRE, 1.0),
    ],
)
def test_legible_unit_gives_large_areas_and_volumes_a_larger_unit(unit, value, power, legible, factor):
    assert unit.legible_unit(value, power) == (legible, pytest.approx(factor))


@pytest.mark.parametrize(
    ("unit", "litres", "said"),
    [
        (Unit.CENTIMETRE, 0.05, (50.0, "ml")),
        (Unit.MILLIMETRE, 0.5, (0.5, "l")),
        (Unit.METRE, -2.0, (-2.0, "l")),
        (Unit.INCH, 0.5, (16.907, "fl oz")),
        (Unit.FOOT, 37.85411784, (10.0, "gal")),
    ],
)
def test_capacity_unit_is_in_what_goes_with_the_unit_of_length(unit, litres, said):
    symbol, factor = unit.capacity_unit(litres)
    assert (litres * factor, symbol) == (pytest.approx(said[0], rel=1e-4), said[1])


@pytest.mark.parametrize(
    ("unit", "grams", "said"),
    [
        (Unit.CENTIMETRE, 0.25, (250.0, "mg")),
        (Unit.CENTIMETRE, 20.0, (20.0, "g")),
        (Unit.METRE, 2500.0, (2.5, "kg")),
        (Unit.INCH, 28.349523125, (1.0, "oz")),
        (Unit.FOOT, 907.18474, (2.0, "lb")),
    ],
)
def test_unit_mass_is_in_what_goes_with_the_unit_of_length(unit, grams, said):
    symbol, factor = unit.mass_unit(grams)
    assert (grams * factor, symbol) == (pytest.approx(said[0]), said[1])


@pytest.mark.parametrize("thickness", ["", "1mm"])
def test_mass_unit_of_a_double_wall_is_that_of_what_is_between_its_surfaces(thickness):
    assert typed_mass(WallText(thickness, "1.36"), 35_000.0, MM, 17_400.0) == pytest.approx(17.4 * 1.36)


def test_mass_unit_of_a_wall_in_inches_is_what_it_is_in_centimetres():
    inches = typed_mass(WallText("1/100 in", "1.38"), 100.0, Unit.INCH)
    assert inches == pytest.approx(typed_mass(WallText("0.254mm", "1.38"), 100.0 * 2.54**2, CM), rel=1e-12)


@pytest.mark.parametrize("read", [parse_density, parse_young_modulus, parse_pressure_difference])
@pytest.mark.parametrize("text", ["1{}!", "1{}mbar?", "a{}/"])
def test_wall_material_takes_no_time_for_many_spaces(read, text):
    """A pattern that looks for the unit from each of them takes as many steps squared."""
    began = time.process_time()
    with pytest.raises(InputError):
        read(text.replace("{}", " " * 30_000))
    assert time.process_time() - began < 2.0
