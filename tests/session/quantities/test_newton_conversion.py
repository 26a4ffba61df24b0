"""Walls in newtons and metres: units, a closed form, and the table of materials."""

import numpy as np
import pytest
from meshes import tube

from apd_viewer import press
from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.solver.settings import Settings
from apd_viewer.session.quantities.newton_conversion import NewtonConversion, newton_conversion
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import Wall
from apd_viewer.session.quantities.wall_material import (
    WALL_MATERIALS,
    parse_poisson_ratio,
    parse_young_modulus,
    wall_material,
)

STIFFNESS = 0.001


def newtons_per_millimetre(around, radius, wall):
    """Of a ring as wide as its radius, pressed a hundredth of it from each side."""
    V, F = tube(around, round(around / (2.0 * np.pi) / 0.75**0.5), height=1.0)
    V = V * radius
    across = np.array([1.0, 0.0, 0.0])
    extent = np.ptp(V @ across)
    last = press(V, F, across, extent - 0.02 * radius, 1, method="arap", stiffness=STIFFNESS).steps[-1]
    slope = 0.5 * (last.load_low + last.load_high) / (extent - np.ptp(last.U @ across))
    newtons = newton_conversion(wall, Settings("arap", STIFFNESS).material, RestMesh(V, F))
    return slope * newtons.newtons_per_millimetre


def test_newton_conversion_of_a_ring_of_plastic_are_what_the_formula_says():
    """An inextensional ring: F = deflection E t³ w / (12 (1 - nu²) (pi/4 - 2/pi) R³) [Timoshenko].

    Cells resist bending in proportion to the square of the edges: two resolutions are extrapolated to none.
    The ring of the model stretches by a fiftieth of its deflection, which the formula does not know.
    """
    wall, R = Wall(Unit.CENTIMETRE, thickness=0.03, young=2.8e9, poisson=0.4), 0.03
    coarse, fine = (newtons_per_millimetre(n, 100.0 * R, wall) for n in (36, 72))
    rigidity = 2.8e9 * 0.3e-3**3 / (12.0 * (1.0 - 0.4**2))
    known = 1e-3 * rigidity * R / ((np.pi / 4 - 2 / np.pi) * R**3)
    assert fine + (fine - coarse) / 3.0 == pytest.approx(known, rel=0.08)


def test_newton_conversion_do_not_depend_on_the_unit_of_the_mesh():
    found = [
        newtons_per_millimetre(24, 0.03 / unit.metres, Wall(unit, 0.3e-3 / unit.metres, young=2.8e9))
        for unit in (Unit.MILLIMETRE, Unit.METRE, Unit.INCH)
    ]
    assert found == pytest.approx([found[0]] * 3, rel=1e-3)


@pytest.mark.parametrize(
    ("unit", "known"), [("mm", 1e-3), ("cm", 1e-2), ("m", 1.0), ("in", 0.0254), ("ft", 0.3048)]
)
def test_metres_says_how_long_a_unit_is(unit, known):
    assert Unit(unit).metres == pytest.approx(known, rel=1e-12)
    assert Unit.NONE.metres is None


@pytest.mark.parametrize("young", [4.0, 1.18])
def test_model_stiffness_of_a_wall_is_that_of_its_rigidities(young):
    """In the model bending has D = 2 s A and stretching a Young's modulus: D over E t alike."""
    wall, area = Wall(Unit.CENTIMETRE, 0.03, young=2.8e9, poisson=0.4), 430.0
    own = wall.model_stiffness(area, young)
    model = 2.0 * own * area * 0.01**2 / young
    assert model == pytest.approx(wall.rigidity / (wall.young * 0.3e-3))
    assert 1e-7 < own < 1e-6


def underestimate_factor(ratio, stretching, curvature):
    """Of a wall, pressed at its stiffness times a ratio."""
    return NewtonConversion(1.0, 1.0, 1.0, ratio, curvature).underestimate_factor(stretching)


def test_underestimate_factor_is_what_a_thinner_wall_resists_stretching_more():
    """The load of a sphere, in proportion to the root of D E t, over that of the conversion by D alone."""
    thick, thin = (8.0 * (t**3 / 12.0 * t) ** 0.5 for t in (0.1, 0.001))
    converted = thick * (0.001 / 0.1) ** 3
    assert underestimate_factor((0.1 / 0.001) ** 2, 0.5, 4.0 * np.pi) == pytest.approx(thin / converted)


def test_underestimate_factor_differs_from_one_only_where_the_shape_has_to_stretch():
    assert underestimate_factor(2500.0, 0.3, 0.1) == 1.0, "a thick tube, which need not"
    assert underestimate_factor(2500.0, 0.3, 4.0 * np.pi) == 50.0
    assert underestimate_factor(2500.0, 0.02, 4.0 * np.pi) == 1.0, "it does not"
    assert underestimate_factor(2500.0, 1.0, 0.1) == 2500.0, "a tube along its axis"
    assert underestimate_factor(0.01, 0.5, 4.0 * np.pi) == pytest.approx(0.1), (
        "a wall that is thicker than the model"
    )


@pytest.mark.parametrize(
    ("text", "pascals"),
    [("2.8GPa", 2.8e9), ("2.8", 2.8e9), (" 2800 MPa ", 2.8e9), ("406 ksi", 2.799e9), ("5/2 gpa", 2.5e9)],
)
def test_parse_young_modulus_has_a_unit_or_is_in_gigapascals(text, pascals):
    assert parse_young_modulus(text) == pytest.approx(pascals, rel=1e-3)


@pytest.mark.parametrize("text", ["", "GPa", "2 kg", "-1", "0", "1e9 GPa", "half", "nan"])
def test_parse_young_modulus_refuses_what_is_no_modulus(text):
    with pytest.raises(InputError, match="Young's modulus"):
        parse_young_modulus(text)


@pytest.mark.parametrize("text", ["-0.1", "0.51", "nan"])
def test_parse_poisson_ratio_refuses_what_is_no_ratio(text):
    with pytest.raises(InputError):
        parse_poisson_ratio(text)


def test_wall_materials_have_each_a_name_of_its_own_a_source_and_sound_numbers():
    assert len({material.name for material in WALL_MATERIALS}) == len(WALL_MATERIALS)
    for material in WALL_MATERIALS:
        assert wall_material(material.name) is material
        assert material.source
        assert 0.0 < material.thickness < 5.0
        if material.young is not None:
            assert 0.3 < material.density < 10.0
            assert 0.1 < material.young < 300.0
            assert 0.0 < material.poisson < 0.5
        assert material.yield_strain is None or 0.0 < material.yield_strain < 0.1
    with pytest.raises(InputError, match="choose one of pet-bottle, "):
        wall_material("wood")


def test_yield_radius_of_a_sheet_is_where_its_fibres_yield():
    """0.3 mm bent to 6 mm strain their outside by 0.15 / 6."""
    sheet = wall_material("pet-bottle")._replace(yield_strain=0.025)
    assert sheet.yield_radius(0.3) == pytest.approx(6.0)
