"""A hidden part is coloured as if unpainted."""

from dataclasses import replace

import numpy as np
from driven_session import document

from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.session.model.document_parts import PaintedPart, with_next_region
from apd_viewer.session.model.handles_and_regions import PartFlags
from apd_viewer.ui.scene.coloring import colors_of, differing_vertices

HIDDEN = PartFlags(hidden=True)


def test_colors_of_hidden_parts_look_erased_and_only_the_difference_is_colored_anew():
    before = with_next_region(document())
    before = before.with_region_number(np.arange(6, 30), 1)
    for part in (PaintedPart(BASE), PaintedPart(HANDLE), PaintedPart(1, is_region=True)):
        hidden = part.document_with_flags(before, HIDDEN)
        assert hidden.labels is before.labels
        assert hidden.member is before.member
        bare = part.document_with_members(before, np.zeros(len(before.labels), dtype=bool))
        np.testing.assert_array_equal(colors_of(hidden), colors_of(bare))
        differ = (colors_of(hidden) != colors_of(before)).any(axis=1)
        np.testing.assert_array_equal(differing_vertices(before, hidden), np.flatnonzero(differ))


def test_colors_of_a_hidden_handle_show_no_falloff():
    before = document()
    before = before.with_handle(0, replace(before.handles[0], falloff=3.0))
    hidden = PaintedPart(HANDLE).document_with_flags(before, HIDDEN)
    assert len(hidden.soft_constraints.ids)
    bare = PaintedPart(HANDLE).document_with_flags(document(), HIDDEN)
    np.testing.assert_array_equal(colors_of(hidden), colors_of(bare))
