"""Volumes in words: each quantity once, never beside a figure of another."""

import math

import meshes
import numpy as np
import pytest

import apd_viewer
from apd_viewer.geometry.analysis.volume_readings import mesh_volumes
from apd_viewer.presentation.volume_text import PUBLISHED_VOLUMES, VolumeName, volume_rows
from apd_viewer.session.quantities.units import Unit

OF_VESSELS = VolumeName.BRIMFUL, VolumeName.LEVEL, VolumeName.FREEBOARD, VolumeName.SPILLED


@pytest.fixture(scope="module")
def shapes():
    V, F = meshes.box(4, 5, 10)
    up = np.array([0.0, 0.0, 1.0])
    return [mesh_volumes(apd_viewer.Mesh(U, F), 0.03, up, 90.0) for U in (V, V * [1, 1, 0.5])]


def rows_of(shapes, unit=Unit.CENTIMETRE, density=1.0):
    return {row.quantity: row for row in volume_rows(*shapes, unit, density)}


def test_volume_rows_are_one_for_every_quantity_with_figures_of_its_own(shapes):
    assert [row.quantity for row in volume_rows(*shapes, Unit.CENTIMETRE, 1.0)] == list(VolumeName)
    assert [
        row.quantity for row in volume_rows(*(each._replace(brimful=None) for each in shapes), Unit.NONE, 1.0)
    ] == [each for each in VolumeName if each not in OF_VESSELS]
    rows = rows_of(shapes)
    assert len({row.title for row in rows.values()}) == len(VolumeName)
    for quantity, row in rows.items():
        assert row.published == PUBLISHED_VOLUMES.get(quantity, ())


def test_published_volume_has_a_source_and_a_range():
    figures = [figure for figures in PUBLISHED_VOLUMES.values() for figure in figures]
    assert len(figures) > 5
    for figure in figures:
        assert figure.words
        assert any(year in figure.source for year in map(str, range(1990, 2030)))
        assert 0.0 < figure.low <= figure.high
    uncompacted, compacted, bales = PUBLISHED_VOLUMES[VolumeName.DENSITY]
    assert (uncompacted.low, uncompacted.high) == pytest.approx((17.8, 23.7), abs=0.05)
    assert compacted.low / uncompacted.high == pytest.approx(3.0)
    assert compacted.low / uncompacted.low == pytest.approx(4.0)
    assert bales.low == pytest.approx(10 * 0.45359237 / 0.3048**3)
    assert bales.high == math.inf
    for bulk, count in zip(
        PUBLISHED_VOLUMES[VolumeName.BULK], PUBLISHED_VOLUMES[VolumeName.COUNT], strict=True
    ):
        assert bulk.low * count.low == pytest.approx(1.0)


def test_volume_rows_halve_every_volume_but_the_material_with_the_height(shapes):
    rows = rows_of(shapes)
    for quantity in (VolumeName.ENCLOSED, VolumeName.HULL, VolumeName.BOX, VolumeName.BULK):
        assert rows[quantity].change == "−50.0 %"
    assert rows[VolumeName.ENCLOSED].rest == ("200.0\u00a0cm³", "")
    assert rows[VolumeName.SIDES].now == ("4 × 5 × 5\u00a0cm", "")
    assert rows[VolumeName.WIDTH].change == "0.0 %"
    assert rows[VolumeName.BULK].now == ("156.2\u00a0cm³", "140.8\u00a0cm³ to 181.8\u00a0cm³")
    assert rows[VolumeName.COUNT].rest == ("144", "123 to 159")
    assert rows[VolumeName.COUNT].now == ("288", "247 to 319")
    assert rows[VolumeName.MATERIAL].rest == ("6.600\u00a0cm³", "")
    assert rows[VolumeName.DENSITY].rest[0] == "21.1\u00a0kg/m³"


def test_volume_rows_show_what_is_not_known_by_a_dash_and_say_what_it_needs(shapes):
    bare = [found._replace(material=None, enclosed=None) for found in shapes]
    rows = rows_of(bare, Unit.NONE, None)
    for quantity in (VolumeName.ENCLOSED, VolumeName.COUNT, VolumeName.DENSITY, VolumeName.MATERIAL):
        assert (rows[quantity].rest, rows[quantity].now, rows[quantity].change) == (("–", ""), ("–", ""), "")
    assert "unit" in rows[VolumeName.COUNT].definition
    assert "thickness" in rows[VolumeName.DENSITY].definition
    assert "thickness" in rows[VolumeName.MATERIAL].definition


def test_volume_rows_name_caps():
    V, F = meshes.box(2, 2, 5)
    found = apd_viewer.volume_readings(V, F[~(V[F][:, :, 2] == 5).all(axis=1)])
    assert "capped flat" in rows_of([found, found])[VolumeName.ENCLOSED].definition
