"""Overlays show what has changed: in honest colours, with a legend, and at no cost while they are off."""

import dataclasses

import numpy as np
import pytest
from driving import LEFT, Mouse, centre, document, idle, settle, show, work_off
from meshes import box, sphere
from PySide6.QtCore import Qt

from apd_viewer.geometry.analysis.deviation import Deviation
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import HANDLE
from apd_viewer.presentation.color_maps import DIVERGING, SEQUENTIAL
from apd_viewer.presentation.palette import FREE_COLOR
from apd_viewer.presentation.scales import Measure, Scale, default_scale
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.overlays.legend import Legend
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.tools.tool_modes import Tool
from apd_viewer.ui.workbench import Workbench

ALT = Qt.KeyboardModifier.AltModifier


@pytest.fixture
def window(kept_window):
    """The window of all tests of the file."""
    return kept_window


@pytest.fixture
def globe(qtbot, window):
    """A window on a sphere of radius one, with nothing painted."""
    window.files.show_mesh(Mesh(*sphere(3)))
    idle(qtbot, window)
    work_off()
    return window


@pytest.fixture
def area(qtbot, globe):
    """The same, with the overlay of areas."""
    choose(qtbot, globe, Measure.AREA)
    return globe


def choose(qtbot, window, measure):
    window.actions_.display.measures[measure].trigger()
    heat = window.display_options.overlay
    qtbot.waitUntil(lambda: heat.reading.values is not None, timeout=60_000)
    settle(qtbot, window.canvas.viewport)


def answer(qtbot, window, U):
    """Show a shape as a frame of the worker is shown."""
    stage = window.session.store
    stage.set_state(stage.state.updated(frame=dataclasses.replace(stage.state.frame, U=frozen(U))))
    settle(qtbot, window.canvas.viewport)


def shades(window):
    return np.array(window.canvas.surface.shades)


def middle(view):
    """What is seen around the middle of the view, (60, 60, 3) int array."""
    picture = view.screenshot(return_img=True)
    y, x = picture.shape[0] // 2, picture.shape[1] // 2
    return picture[y - 30 : y + 30, x - 30 : x + 30, :3].astype(int)


def middle_pixel(view):
    picture = view.screenshot(return_img=True)
    return picture[picture.shape[0] // 2, picture.shape[1] // 2, :3].astype(int)


# What is shown


def test_deviation_overlay_is_neutral_everywhere_at_rest(area):
    assert set(shades(area)) == {128}
    assert area.display_options.legend.isVisible()


def test_deviation_overlay_measures_a_frame_when_it_is_drawn_and_once(qtbot, area, monkeypatch):
    asked, measured = [], Deviation.area_change
    monkeypatch.setattr(Deviation, "area_change", lambda self, U: asked.append(len(U)) or measured(self, U))
    V = document(area).mesh.V
    answer(qtbot, area, 1.02 * V)
    assert len(asked) == 1
    np.testing.assert_array_equal(shades(area), 128 + round(127 * np.log(1.02**2) / np.log(1.1)))
    area.canvas.viewport.camera_controller.show_standard_view("top")
    settle(qtbot, area.canvas.viewport)
    assert len(asked) == 1, "the camera has moved, and not the shape"


def test_deviation_overlay_measures_nothing_and_leaves_the_paint_while_it_is_off(qtbot, area, monkeypatch):
    area.actions_.display.no_overlay.trigger()
    assert not area.display_options.legend.isVisible()
    monkeypatch.setattr(Deviation, "area_change", lambda *_: pytest.fail("nobody asked"))
    answer(qtbot, area, 1.3 * document(area).mesh.V)
    assert set(shades(area)) == {255}
    assert area.canvas.surface.color_map is None


@pytest.mark.parametrize(
    ("measure", "key", "expected"),
    [
        (Measure.AREA, Qt.Key.Key_1, "+21 %"),
        (Measure.STRAIN, Qt.Key.Key_2, "+10 %"),
        (Measure.BENDING, Qt.Key.Key_3, "−0.0909 mm⁻¹"),
        (Measure.DISPLACEMENT, Qt.Key.Key_4, "0.1 mm"),
        (Measure.DISTANCE, Qt.Key.Key_5, "0.1 mm"),
    ],
)
def test_deviation_reading_value_under_the_cursor_is_that_of_the_closed_form(
    qtbot, globe, measure, key, expected
):
    globe.shell.activateWindow()
    qtbot.waitUntil(globe.shell.isActiveWindow)
    globe.choose_unit(Unit.MILLIMETRE)
    answer(qtbot, globe, 1.1 * document(globe).mesh.V)
    qtbot.keyClick(globe.canvas.viewport, key, ALT)
    assert globe.display_options.overlay.measure is measure
    heat, legend = globe.display_options.overlay, globe.display_options.legend
    qtbot.waitUntil(lambda: heat.reading.values is not None, timeout=60_000)
    settle(qtbot, globe.canvas.viewport)
    heat.reading.timer.stop()
    Mouse(globe.canvas.viewport).move(centre(globe.canvas.viewport))
    said = legend.under_cursor.text().replace("\u00a0", " ")
    if measure is Measure.DISTANCE:  # from the facets, which are a little inside the sphere
        assert float(said.split()[0]) == pytest.approx(0.1, abs=3e-3)
    elif measure is Measure.BENDING:
        assert float(said.split()[0].replace("−", "-")) == pytest.approx(-1 / 11, rel=2e-3)
        assert said.endswith("mm⁻¹")
    else:
        assert said == expected
    assert legend.bar.value == heat.reading.value_at(centre(globe.canvas.viewport))
    globe.canvas.viewport.mouse.leave()
    assert legend.under_cursor.text() == "–"


@pytest.mark.night
def test_deviation_overlay_shows_the_contact_pressure_of_what_is_kept_apart(qtbot, bottle):
    bottle.session.settings.set_contact(False)
    bottle.session.handles.move_by(MOTIONS["TWIST"], "20deg", 0)
    idle(qtbot, bottle)
    bottle.shell.activateWindow()
    qtbot.waitUntil(bottle.shell.isActiveWindow)
    qtbot.keyClick(bottle.canvas.viewport, Qt.Key.Key_9, ALT)
    heat = bottle.display_options.overlay
    assert heat.measure is Measure.CONTACT
    qtbot.waitUntil(lambda: heat.reading.values is not None, timeout=60_000)
    assert np.isnan(heat.reading.values).all(), "contact is off"
    assert "turn on Contact" in bottle.display_options.legend.note.text()
    bottle.session.settings.set_contact(True, 0.03)
    idle(qtbot, bottle)
    # The values of the shape before stay in the colours until those of this one are there.
    qtbot.waitUntil(lambda: set(heat.reading.values) == {0.0}, timeout=60_000)  # nothing touches yet
    assert "percent" in bottle.display_options.legend.note.text()
    bottle.session.handles.move_by(MOTIONS["TWIST"], "130deg", 0)
    idle(qtbot, bottle)
    qtbot.waitUntil(lambda: heat.reading.values.max() == 1.0, timeout=60_000)
    settle(qtbot, bottle.canvas.viewport)
    touched = np.count_nonzero(heat.reading.values)
    assert 0 < touched <= 4 * bottle.session.store.state.frame.contact.pairs


def test_deviation_overlay_waits_with_what_takes_longer_until_the_shape_rests(qtbot, globe):
    choose(qtbot, globe, Measure.DISTANCE)
    heat = globe.display_options.overlay
    heat.rest_timer.setInterval(10**6)
    answer(qtbot, globe, 1.2 * document(globe).mesh.V)
    assert heat.reading.values is None
    assert globe.canvas.surface.color_map is None, "colours of another shape would be a lie"
    assert "converged" in globe.display_options.legend.note.text()
    assert heat.rest_timer.isActive()
    heat.rest_timer.start(0)
    qtbot.waitUntil(lambda: heat.reading.values is not None)
    assert globe.canvas.surface.color_map is SEQUENTIAL
    assert not globe.display_options.legend.note.isVisible()


def test_deviation_overlay_is_off_and_compares_another_mesh_with_its_own_rest_shape(qtbot, area):
    area.session.files.open_sample("bottle")
    idle(qtbot, area)
    assert area.display_options.overlay.measure is None
    assert not area.display_options.legend.isVisible()
    assert area.actions_.display.no_overlay.isChecked()
    area.actions_.display.measures[Measure.AREA].trigger()
    qtbot.waitUntil(
        lambda: (
            area.display_options.overlay.reading.values is not None
            and len(area.display_options.overlay.reading.values) > 10_000
        )
    )
    assert not area.display_options.overlay.reading.values.any()


# Colours


@pytest.mark.parametrize("edges", [False, True])
def test_legend_colors_are_those_on_the_shape(globe, edges):
    """A place painted in the colour of the legend looks as one that the overlay colours."""
    view, surface = globe.canvas.viewport, globe.canvas.surface
    n = len(surface.U)
    surface.shows_edges = edges
    for colors in (DIVERGING, SEQUENTIAL):
        for shade in (1, 90, 255):
            color = colors.colors(np.array([(shade - 1) / 254]))[0]
            surface.set_color_map(colors, -1.0)
            surface.shades[:] = shade
            surface.update_shades()
            shown = middle(view)
            surface.set_color_map(None)
            surface.set_colors(np.tile([*color, 255], (n, 1)).astype(np.uint8))
            off = np.abs(shown - middle(view))
            assert np.quantile(off, 0.99) <= 2, "but for what smooths the edges"
            assert off.max() < 20
            surface.set_colors(np.tile([*FREE_COLOR, 255], (n, 1)).astype(np.uint8))


def test_deviation_overlay_has_no_color_up_to_the_tolerance(qtbot, area):
    view, V = area.canvas.viewport, document(area).mesh.V
    neutral = middle_pixel(view)
    answer(qtbot, area, 1.01 * V)
    assert np.abs(middle_pixel(view) - neutral).max() > 5
    area.display_options.legend.scale_changed.emit(0.1, 0.03)
    np.testing.assert_allclose(middle_pixel(view), neutral, atol=2)


def test_deviation_overlay_lets_paint_still_be_seen(qtbot, bottle):
    """Stripes of the paint, between which the colours are those of the scale."""
    choose(qtbot, bottle, Measure.AREA)
    view, held = bottle.canvas.viewport, document(bottle).labels == HANDLE
    picture = view.screenshot(return_img=True).astype(int)
    (x0, x1), (y0, y1) = np.percentile(
        view.camera_controller.camera.project(document(bottle).mesh.V[held]), [35, 65], axis=0
    ).T.astype(int)
    patch = picture[y0:y1, x0:x1, :3].reshape(-1, 3)
    assert 0.1 < (patch[:, 0] - patch[:, 2] > 40).mean() < 0.6


# The legend


def test_legend_names_what_is_shown_as_the_wall_gets_thicknesses(area):
    legend, heat = area.display_options.legend, area.display_options.overlay
    other = next(each for each in heat.offered_measures if each is not heat.offered_measures[0])
    heat.choose_measure(other)
    for thickness in (np.ones(len(document(area).mesh.V)), None):
        heat.set_thickness(thickness)
        assert legend.choice.currentText() == other.traits.title


def test_legend_lets_the_range_be_typed_and_fitted_by_a_click(qtbot, area):
    legend, heat = area.display_options.legend, area.display_options.overlay
    answer(qtbot, area, 1.3 * document(area).mesh.V)
    assert set(shades(area)) == {255}
    legend.reach.setFocus()
    legend.reach.selectAll()
    qtbot.keyClicks(legend.reach, "100")
    qtbot.keyClick(legend.reach, Qt.Key.Key_Return)
    assert heat.scale == Scale(Measure.AREA, 1.0, 0.001)
    np.testing.assert_array_equal(shades(area), 128 + round(127 * np.log(1.69) / np.log(2)))
    qtbot.mouseClick(legend.fit, LEFT)
    assert heat.scale.reach == 1.0, "69 % fits into 100 %"
    answer(qtbot, area, 1.02 * document(area).mesh.V)
    qtbot.mouseClick(legend.fit, LEFT)
    assert heat.scale.reach == pytest.approx(0.05)
    assert [text for _, text in legend.bar.labels] == ["−4.76\u00a0%", "0\u00a0%", "+5\u00a0%"]


@pytest.mark.parametrize("measure", [Measure.AREA, Measure.STRAIN])
def test_legend_shows_the_largest_change_as_the_panel_does(qtbot, bottle, measure):
    choose(qtbot, bottle, measure)
    bottle.session.handles.move_by(MOTIONS["TWIST"], "60deg", 0)
    idle(qtbot, bottle)
    legend, panel = bottle.display_options.legend, bottle.panel.strain
    settle(qtbot, bottle.canvas.viewport)
    bottle.display_options.overlay.reading.update_legend()
    said, strain = legend.largest.text().replace("\u00a0", " "), panel.largest_strain.text()
    assert (said == strain) if measure is Measure.STRAIN else (said.lstrip("+−") == panel.local_change.text())
    assert said != "0 %"
    bottle.display_options.overlay.show_next_extreme()
    assert bottle.display_options.overlay.extremes.callout.text.endswith(legend.largest.text())


def test_deviation_overlay_never_has_what_counts_for_no_change_in_the_strongest_colors(qtbot, area):
    legend, heat = area.display_options.legend, area.display_options.overlay
    answer(qtbot, area, 1.3 * document(area).mesh.V)
    for field, text in ((legend.neutral, "500"), (legend.reach, "0.01")):
        field.setFocus()
        field.selectAll()
        qtbot.keyClicks(field, text)
        qtbot.keyClick(field, Qt.Key.Key_Return)
        scale = heat.scale
        assert scale.neutral == legend.neutral.value() / 100.0 == 0.5 * scale.reach
        shown, of_map = scale.colors(np.array([0.0, 0.4])), scale.measure.colors.colors(np.array([0.0, 0.5]))
        assert shown.tolist() == of_map.tolist(), "as the shape is, so is the scale"


def test_legend_has_nothing_to_fit_at_rest(qtbot, area):
    before, fit = area.display_options.overlay.scale, area.display_options.legend.fit
    qtbot.waitUntil(fit.isEnabled)
    qtbot.mouseClick(fit, LEFT)
    assert area.display_options.overlay.scale == before


@pytest.mark.parametrize("unit", [1e-9, 1e4])
def test_legend_fits_and_takes_the_range_on_a_mesh_of_any_size(qtbot, window, unit):
    V, F = sphere(2)
    window.files.show_mesh(Mesh(unit * V, F))
    idle(qtbot, window)
    choose(qtbot, window, Measure.DISPLACEMENT)
    answer(qtbot, window, unit * (V + [0.4, 0.0, 0.0]))
    legend, heat = window.display_options.legend, window.display_options.overlay
    qtbot.waitUntil(legend.fit.isEnabled)
    qtbot.mouseClick(legend.fit, LEFT)
    assert heat.scale.reach == pytest.approx(0.5 * unit)
    legend.reach.setFocus()
    qtbot.keyClick(legend.reach, Qt.Key.Key_Return)
    assert heat.scale.reach == pytest.approx(0.5 * unit), "Enter leaves the number that is shown"


def test_legend_changes_the_overlay_and_switches_it_off(qtbot, area):
    legend = area.display_options.legend
    legend.choice.setFocus()
    qtbot.keyClick(legend.choice, Qt.Key.Key_Down)
    assert area.display_options.overlay.measure is Measure.STRAIN
    assert area.actions_.display.measures[Measure.STRAIN].isChecked()
    qtbot.mouseClick(legend.close_button, LEFT)
    assert area.display_options.overlay.measure is None
    assert area.actions_.display.no_overlay.isChecked()


@pytest.mark.parametrize("measure", Measure)
def test_legend_shows_the_scale_of_every_measure(qtbot, measure):
    legend = Legend()
    qtbot.addWidget(legend)
    scale = default_scale(measure, 1.0)
    legend.show_scale(scale, Unit.MILLIMETRE)
    assert legend.reach.value() == pytest.approx(measure.traits.kind.factor * scale.reach)
    assert legend.reach.suffix() == measure.traits.kind.suffix(Unit.MILLIMETRE) != ""


def test_cards_are_beside_the_ways_to_choose_where_they_are_as_high(qtbot, window):
    window.session.files.open_result("box", lambda: initial_state(Mesh(*box())))
    idle(qtbot, window)
    window.tools.choose_tool(Tool.BASE)
    choose(qtbot, window, Measure.AREA)
    cards, ways, line = window.display_options.cards, window.mode_bar, window.invitation
    moved = set()
    for height in range(640, 960, 40):
        window.shell.resize(1280, height)
        work_off()
        assert ways.isVisible()
        assert line.isVisible()
        assert not cards.geometry().intersects(ways.geometry()), height
        assert not cards.geometry().intersects(line.geometry()), height
        moved.add(cards.x() > ways.x())
    assert moved == {False, True}


@pytest.mark.parametrize("size", [(1280, 720), (800, 640)])
def test_legend_covers_nothing(qtbot, bottle, size):
    bottle.shell.resize(*size)
    choose(qtbot, bottle, Measure.AREA)
    legend, canvas = bottle.display_options.cards, bottle.canvas.viewport
    assert bottle.invitation.isVisible()
    for other in (bottle.invitation, bottle.notice, bottle.findings.list):
        assert other.isHidden() or not legend.geometry().intersects(other.geometry())
    assert canvas.rect().contains(legend.geometry())
    low = legend.geometry().bottom()
    bottle.invitation.show_text("")
    assert legend.geometry().bottom() >= low
    assert legend.geometry().bottom() == canvas.height() - 13


def test_legend_keeps_the_mouse_on_it_from_the_canvas(qtbot, area):
    eye = area.canvas.viewport.camera_controller.camera.key
    mouse = Mouse(area.display_options.legend)
    mouse.drag((20, 60), (60, 80), (90, 120))
    mouse.wheel((20, 60), 3)
    assert area.canvas.viewport.camera_controller.camera.key == eye


def test_deviation_overlay_remembers_overlay_and_range(qtbot, area, settings):
    area.display_options.legend.scale_changed.emit(0.4, 0.02)
    other = Workbench(Shell(settings))
    show(qtbot, other.shell, other.canvas.viewport)
    try:
        assert other.display_options.overlay.measure is Measure.AREA
        assert other.display_options.overlay.scales[Measure.AREA] == Scale(Measure.AREA, 0.4, 0.02)
        assert other.actions_.display.measures[Measure.AREA].isChecked()
    finally:
        other.shell.close()
        other.shell.deleteLater()
        work_off()


def test_deviation_overlay_takes_settings_that_nobody_can_read_as_none(qtbot, settings):
    settings.setValue("looks", ["overlay nonsense", "area many 3", "strain -1 0", "ghost"])
    other = Workbench(Shell(settings))
    try:
        assert other.display_options.overlay.measure is None
        assert other.display_options.overlay.scales == {}
    finally:
        other.shell.close()
        other.shell.deleteLater()
        work_off()


# The worst places


def test_show_next_extreme_goes_to_the_worst_places_one_after_another_by_a_key(qtbot, area):
    area.shell.activateWindow()
    qtbot.waitUntil(area.shell.isActiveWindow)
    V = document(area).mesh.V
    away = np.linalg.norm(V - [0.0, 0.0, -1.0], axis=1), np.linalg.norm(V - [1.0, 0.0, 0.0], axis=1)
    U = V * (1.0 + 0.3 * np.exp(-20 * away[0] ** 2) - 0.1 * np.exp(-20 * away[1] ** 2))[:, None]
    answer(qtbot, area, U)
    heat, view = area.display_options.overlay, area.canvas.viewport
    qtbot.keyClick(view, Qt.Key.Key_C)
    first = heat.extremes.callout.vertex
    assert abs(heat.reading.values[first]) == np.abs(heat.reading.values).max()
    assert view.camera_controller.camera.axes[2] @ V[first] < 0, "it is seen, though it was at the back"
    assert view.rect().contains(*map(int, view.camera_controller.camera.project(U[[first]])[0]))
    assert heat.extremes.callout.text.startswith("1 of")
    qtbot.keyClick(view, Qt.Key.Key_C)
    second = heat.extremes.callout.vertex
    assert np.linalg.norm(U[second] - U[first]) > 0.05
    qtbot.keyClick(view, Qt.Key.Key_C, Qt.KeyboardModifier.ShiftModifier)
    assert heat.extremes.callout.vertex == first
    answer(qtbot, area, V)
    assert heat.extremes.callout.vertex is None, "there is no worst place any more"
    qtbot.keyClick(view, Qt.Key.Key_C)
    assert heat.extremes.callout.vertex is None
