"""The scales of the overlays: their ends, their figures, and colours that everybody can tell apart."""

import numpy as np
import pytest

from apd_viewer.presentation.color_maps import DIVERGING, SEQUENTIAL
from apd_viewer.presentation.number_format import round_step
from apd_viewer.presentation.palette import BASE_COLOR, HANDLE_COLORS
from apd_viewer.presentation.scales import Measure, Scale, default_scale
from apd_viewer.session.quantities.units import Unit

# Machado, Oliveira and Fernandes 2009, severity 1.
SIGHTS = {
    "protan": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deutan": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "tritan": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
    "all": np.eye(3),
}
TO_LMS = [
    [0.4122214708, 0.5363325363, 0.0514459929],
    [0.2119034982, 0.6806995451, 0.1073969566],
    [0.0883024619, 0.2817188376, 0.6299787005],
]
TO_LAB = [
    [0.2104542553, 0.7936177850, -0.0040720468],
    [1.9779984951, -2.4285922050, 0.4505937099],
    [0.0259040371, 0.7827717662, -0.8086757660],
]


def seen(rgb, sight):
    """OKLab coordinates of what is seen of colours, (k, 3)."""
    c = np.asarray(rgb) / 255.0
    linear = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    return np.cbrt(np.clip(linear @ np.transpose(SIGHTS[sight]), 0, 1) @ np.transpose(TO_LMS)) @ np.transpose(
        TO_LAB
    )


@pytest.mark.parametrize("sight", SIGHTS)
def test_color_maps_let_everybody_tell_loss_and_gain_apart(sight):
    t = np.linspace(0, 1, 101)
    lab = seen(DIVERGING.colors(t), sight)
    far = np.abs(t - 0.5) > 0.12
    assert np.linalg.norm(lab - lab[::-1], axis=1)[far].min() > 0.06
    light = lab[:, 0]
    assert (np.diff(light[:50]) > 0).all(), "from the ends to the middle it only gets lighter"
    assert (np.diff(light[51:]) < 0).all()
    sequence = seen(SEQUENTIAL.colors(t), sight)[:, 0]
    assert (np.diff(sequence) < 0).all()


def test_color_maps_have_a_neutral_middle_and_ends_that_are_nobody_s_paint():
    first, middle, last = DIVERGING.colors(np.array([0.0, 0.5, 1.0])).astype(int)
    assert max(middle) - min(middle) <= 6
    for paint in (BASE_COLOR, *HANDLE_COLORS[:2]):
        for end in (first, last):
            assert np.linalg.norm(seen([paint], "all") - seen([end], "all")) > 0.15


# Scales


def test_scale_of_a_ratio_has_ends_that_are_one_over_each_other():
    scale = Scale(Measure.AREA, 0.25, 0.01)
    assert scale.format_value(scale.end, Unit.NONE) == "+25\u00a0%"
    assert scale.format_value(-scale.end, Unit.NONE) == "−20\u00a0%"
    assert scale.position(scale.end) == 1.0
    assert scale.position(0.0) == 0.5
    assert scale.position(-np.inf) == 0.0
    assert scale.format_value(-np.inf, Unit.NONE) == "−100\u00a0%"
    middle, near, far = scale.colors(0.5 + np.array([0.0, 0.4, 0.6]) * scale.neutral_fraction).tolist()
    assert middle == near == DIVERGING.colors(np.array([0.5]))[0].tolist()
    assert far != middle


@pytest.mark.parametrize(("value", "expected"), [(0.13, 0.2), (0.2, 0.2), (21.0, 50.0), (7e-5, 1e-4)])
def test_round_step_is_the_next_nice_number_above(value, expected):
    assert round_step(value) == pytest.approx(expected)


def test_default_scale_scale_fits_the_size_of_the_mesh():
    for size in (1e-3, 1.0, 4e4):
        for measure in (Measure.DISPLACEMENT, Measure.DISTANCE):
            assert 0.1 <= default_scale(measure, size).reach / size <= 0.6
        assert 8.0 <= default_scale(Measure.BENDING, size).reach * size <= 20.0


# Fitting


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("measure", Measure)
def test_fitted_to_scale_suits_what_there_is_on_a_mesh_of_any_size(measure, size):
    before = default_scale(measure, size)
    largest = 0.3 * before.end
    fitted = before.fitted_to((-largest, 0.5 * largest), size)
    assert largest <= fitted.end < 2.6 * largest
    assert 0.0 <= fitted.neutral <= 0.5 * fitted.reach
    farther = before.fitted_to((0.0, 7.0 * before.end), size)
    assert farther.position(7.0 * before.end) > 0.65, "no colour is wasted on what is not there"


@pytest.mark.parametrize("measure", Measure)
def test_fitted_to_takes_rounding_for_nothing_to_fit(measure):
    before = default_scale(measure, 20.0)
    for rounding in (0.0, 1e-15 * before.end):
        assert before.fitted_to((-rounding, rounding), 20.0) is before


def test_fitted_to_takes_a_ratio_that_has_no_end_too():
    assert default_scale(Measure.STRAIN, 1.0).fitted_to((-np.inf, 0.1)).reach == 10.0
