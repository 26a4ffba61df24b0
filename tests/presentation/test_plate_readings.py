"""Readings of a press: where a wall has given way."""

from types import SimpleNamespace

import pytest

from apd_viewer.presentation import plate_readings
from apd_viewer.presentation.plate_readings import has_given_way


def states(*readings):
    """States with deflections and loads between two plates; None for one that is not at rest."""
    return [
        SimpleNamespace(
            document=SimpleNamespace(
                reading=lambda _, found=found: SimpleNamespace(deflection=found[0], load=found[1])
            ),
            frame=SimpleNamespace(settled=len(found) == 2),
        )
        for found in readings
    ]


@pytest.mark.parametrize(
    ("readings", "expected"),
    [
        (((0, 0.0), (1, 2.0), (2, 3.0)), False),
        (((0, 0.0), (1, 2.0), (2, 1.9)), True),
        (((0, 0.0), (1, 2.0), (2, 1.99)), False),  # as equilibria differ
        (((0, 0.0), (1, 2.0), (2, 1.0), (3, 5.0)), True),
        (((0, 0.0), (1, 2.0), (0.5, 1.0)), False),  # the plates open
        (((0, 0.0), (1, 2.0), (2, 1.0, "on the way"), (3, 3.0)), False),
        (((0, 0.0),), False),
        ((), False),
    ],
)
def test_has_given_way_is_true_where_a_load_falls_while_plates_close(monkeypatch, readings, expected):
    monkeypatch.setattr(plate_readings, "obstacle_pair", lambda document: document)
    assert has_given_way(states(*readings)) is expected
