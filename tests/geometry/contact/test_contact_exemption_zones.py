"""Zones around triangles that cross at rest: one for each place, and places are kept apart."""

import numpy as np
from meshes import grid

from apd_viewer.geometry.analysis.self_intersections import crossing_pairs, crossings
from apd_viewer.geometry.contact.contact import Contact, contact_exemption_zones, is_near_crossing

AWAY = np.array([5.0, 0.0, 0.0])


def cross(shift):
    """Two sheets that cross, one upright, with 81 vertices each."""
    V, F = grid(8, 8, 0.25, 0.25)
    V = V - V.mean(axis=0)
    upright = V[:, [0, 2, 1]] + 0.03
    return np.concatenate([V, upright]) + shift, np.concatenate([F, F + len(V)])


def two_crosses():
    (V, F), (W, _) = cross(0.0), cross(AWAY)
    return np.concatenate([V, W]), np.concatenate([F, F + len(V)])


def test_contact_exemption_zones_are_one_for_each_place_and_what_crosses_shares_one():
    V, F = two_crosses()
    pairs = crossing_pairs(V, F)
    assert np.array_equal(np.unique(pairs), crossings(V, F))
    zone = contact_exemption_zones(F, pairs, len(V))
    half = len(V) // 2
    first, second = np.unique(zone[:half]), np.unique(zone[half:])
    assert (first.tolist(), second.tolist()) == ([0, 1], [0, 2])
    corners = zone[F[pairs]].reshape(len(pairs), -1)
    assert (corners == corners[:, :1]).all()
    assert corners.min() > 0
    assert np.array_equal(zone > 0, is_near_crossing(F, np.unique(pairs), len(V)))


def test_contact_exemption_zones_are_none_where_nothing_crosses():
    V, F = grid(4, 4)
    assert not contact_exemption_zones(F, crossing_pairs(V, F), len(V)).any()
    assert not contact_exemption_zones(F, None, len(V)).any()


def test_contact_keeps_places_that_cross_at_rest_apart_from_each_other():
    V, F = two_crosses()
    second = np.arange(len(V)) >= len(V) // 2
    contact = Contact(V, F, np.zeros(len(V), np.int64), 1.0, 0.02)
    through, beside = V.copy(), V.copy()
    through[second] -= 0.9 * AWAY
    beside[second] -= 0.4 * AWAY
    assert not contact.can_start_at(through)
    assert contact.can_start_at(beside)
    assert not contact.move_to(through)
    assert contact.move_to(beside)


def test_contact_lets_what_crosses_at_rest_go_on_crossing():
    V, F = cross(0.0)
    upright = np.arange(len(V)) >= len(V) // 2
    contact = Contact(V, F, np.zeros(len(V), np.int64), 1.0, 0.02)
    along = V.copy()
    along[upright, 2] += 0.1
    assert len(crossings(along, F))
    assert contact.can_start_at(along)
    assert contact.move_to(along)
