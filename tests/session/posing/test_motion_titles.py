"""Titles of dragged motions: those of the same motions typed."""

from dataclasses import replace

import driven_session
import numpy as np
import pytest

from apd_viewer.geometry.pose.transforms import rotation_about, translation
from apd_viewer.session.model.handles_and_regions import Handle
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.posing.motion_path import MotionStep, motion_title, motion_title_between
from apd_viewer.session.quantities.units import Unit


@pytest.fixture(scope="module")
def rest():
    return driven_session.document(at=np.eye(4))


@pytest.fixture(scope="module")
def posed(rest):
    """The document with its handle turned about an axis of no motion here."""
    return rest.with_handle_moved(0, rotation_about([1.0, 1.0, 6.0], [1.0, 2.0, 3.0], 1.0))


def moved(start, motion, amount):
    return MotionStep(0, motion, (amount,)).end_document(start)


def titles(start, motion, amount):
    """The title of a typed motion, and that of a drag by the same."""
    typed = motion_title(motion, amount, "Handle 1", Unit.MILLIMETRE)
    return typed, motion_title_between(start, moved(start, motion, amount), 0, Unit.MILLIMETRE)


@pytest.mark.parametrize("amount", [0.3, -2.5, 4.0, -7.0, 20.0])
@pytest.mark.parametrize("kind", ["TURN", "MOVE"])
def test_motion_title_between_names_a_drag_as_the_motion_typed(rest, posed, kind, amount):
    for start in (rest, posed):
        for letter in "XYZ":
            typed, dragged = titles(start, MOTIONS[f"{kind}_{letter}"], amount)
            assert dragged == typed
            assert "−" in typed if amount < 0 else "+" in typed


def test_motion_title_between_names_a_scaling_by_its_factor(posed):
    typed, dragged = titles(posed, MOTIONS["SCALE"], 0.8)
    assert dragged == typed == "Scale ×0.8 (Handle 1)"


def test_motion_title_between_gives_turning_back_the_opposite_sign(rest):
    turned = moved(rest, MOTIONS["TURN_Y"], 7.0)
    back = moved(turned, MOTIONS["TURN_Y"], -6.0)
    assert (
        motion_title_between(turned, back, 0, Unit.NONE)
        == f"Rotate about y −{np.rad2deg(6.0):.4g}° (Handle 1)"
    )


def test_motion_title_between_has_the_amount_alone_along_no_axis(rest):
    moved = rest.with_handle_moved(0, translation([3.0, 4.0, 0.0]))
    assert motion_title_between(rest, moved, 0, Unit.MILLIMETRE) == "Move 5\u00a0mm (Handle 1)"
    turned = rest.with_handle_moved(0, rotation_about([1, 1, 6], [1, 1, 0], 0.5))
    assert motion_title_between(rest, turned, 0, Unit.NONE) == "Rotate +28.65° (Handle 1)"


def test_motion_title_between_has_no_amount_for_a_motion_of_several_kinds(rest):
    screw = translation([0.0, 2.0, 0.0]) @ rotation_about([1, 1, 6], [0, 1, 0], 0.5)
    assert (
        motion_title_between(rest, rest.with_handle_moved(0, screw), 0, Unit.NONE) == "Move handle (Handle 1)"
    )


def test_motion_title_between_names_all_moved_handles(rest):
    two = replace(rest, handles=(*rest.handles, Handle("Tail"), Handle("Ear")))
    moved = two.with_handle_moved(0, translation([1.0, 0.0, 0.0])).with_handle_moved(
        1, translation([1.0, 0.0, 0.0])
    )
    assert motion_title_between(two, moved, 0, Unit.NONE) == "Move along x +1 (Handle 1, Tail)"
