"""Pairs of plates that face each other, and the extent that percentages are of."""

from dataclasses import replace

import numpy as np
import pytest

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.obstacle_pair import obstacle_pair
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.posing.obstacle_placement import touching_plate
from apd_viewer.verification.case_meshes import disc, sewn_sheets

Z = np.array([0.0, 0.0, 1.0])


def plates_around_a_bag(**settings):
    """Document of a bag with plates 0.1 farther apart, and their pair."""
    state = initial_state(Mesh(*sewn_sheets(*disc(3), 0.01)))
    document = state.document.with_settings(**settings)
    plates = tuple(touching_plate(name, side * Z, state, 0.05) for name, side in (("A", 1.0), ("B", -1.0)))
    document = replace(document, obstacles=plates)
    return document, obstacle_pair(document)


def test_obstacle_pair_has_the_extent_of_the_mesh_at_rest():
    document, pair = plates_around_a_bag()
    assert pair.extent(document) == pytest.approx(0.01)
    assert pair.first_distance(document) == pytest.approx(0.11)


def test_obstacle_pair_has_its_first_distance_for_the_extent_of_a_bag_to_be_filled():
    document, pair = plates_around_a_bag(filled_volume=0.5)
    assert pair.extent(document) == pytest.approx(0.11)
