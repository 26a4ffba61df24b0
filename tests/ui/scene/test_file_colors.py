"""Colours of the file lie under the paint, and leave when an overlay shows others."""

import numpy as np
import pytest
from driving import document, idle
from meshes import sphere

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE
from apd_viewer.presentation.palette import label_colors
from apd_viewer.presentation.scales import Measure


@pytest.fixture
def colored(qtbot, kept_window, tmp_path):
    """A ball with colours, in a file, and a painted base."""
    V, F = sphere(2)
    rows = [f"v {x} {y} {z} {abs(x)} {abs(y)} 0.25" for x, y, z in V]
    rows += [f"f {i} {j} {k}" for i, j, k in F + 1]
    path = tmp_path / "ball.obj"
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    kept_window.files.open_path(path)
    idle(qtbot, kept_window)
    kept_window.session.gestures.begin()
    kept_window.session.painting.paint(np.arange(20), BASE)
    kept_window.session.painting.end_stroke("Paint")
    return kept_window


def shown(window):
    return window.canvas.surface.arrays.rgba[:, :3].copy()


def test_coloring_shows_colors_of_the_file_under_the_paint_when_asked(qtbot, colored, settings):
    switch = colored.actions_.display.switches["file_colors"]
    assert switch.isEnabled()
    paint = label_colors(document(colored).labels)[:, :3]
    np.testing.assert_array_equal(shown(colored), paint)
    switch.trigger()
    bare = document(colored).labels == FREE
    assert 0 < bare.sum() < len(bare)
    expected = np.where(bare[:, None], document(colored).mesh.colors, paint)
    np.testing.assert_array_equal(shown(colored), expected)
    colored.session.gestures.undo()
    np.testing.assert_array_equal(shown(colored), document(colored).mesh.colors)
    colored.session.gestures.redo()
    colored.actions_.display.measures[Measure.AREA].trigger()
    np.testing.assert_array_equal(shown(colored), paint)
    colored.actions_.display.no_overlay.trigger()
    np.testing.assert_array_equal(shown(colored), expected)
    switch.trigger()
    np.testing.assert_array_equal(shown(colored), paint)


def test_display_actions_offer_no_file_colors_without_colors(bottle):
    assert not bottle.actions_.display.switches["file_colors"].isEnabled()


def test_display_actions_check_only_what_can_be_shown_and_keep_the_choice(qtbot, colored):
    switches, looks = colored.actions_.display.switches, colored.display_options
    assert looks.target_ghost.visible
    assert not switches["target_ghost"].isChecked()
    switches["file_colors"].trigger()
    colored.session.files.open_mesh(Mesh(*sphere(2)))
    idle(qtbot, colored)
    assert not switches["file_colors"].isChecked()
    assert looks.shows_file_colors
    colored.session.gestures.undo()
    assert switches["file_colors"].isChecked()


def test_mesh_has_its_colors_parsed_off_the_thread_of_the_window(colored, tmp_path):
    mesh = document(colored).mesh
    assert "colors" in vars(mesh)
    assert mesh.baked(mesh.V * 2.0).colors is mesh.colors
