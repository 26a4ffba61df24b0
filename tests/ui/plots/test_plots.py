"""The plots in a real window: what they show, when they are drawn, and what is written of them."""

import csv
import re
import threading
import weakref
from xml.etree import ElementTree

import numpy as np
import pytest
from driving import drag, idle, ring_grip, work_off
from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QLabel, QMenu

from apd_viewer.presentation.color_maps import DIVERGING
from apd_viewer.session.model.trace import TRACE_COLUMNS
from apd_viewer.ui.plots import plots as plots_module
from apd_viewer.ui.plots.plots import Plots
from apd_viewer.ui.widgets.theme import DARK, LIGHT


@pytest.fixture
def plotted(qtbot, bottle):
    """The bottle with all plots in sight."""
    bottle.docks["plots"].show()
    for button in bottle.plots.choices.values():
        button.setChecked(True)
    loaded(qtbot, bottle)
    return bottle


def loaded(qtbot, window):
    """Wait until the histogram can be found, which takes long only where nothing is compiled yet."""
    window.plots.views["local"].chart()
    qtbot.waitUntil(lambda: "plots" not in [thread.name for thread in threading.enumerate()], timeout=60_000)


def twist(qtbot, window, steps=3):
    frames = []
    show = window.canvas.show_state

    def seen(old, new, handle, region):
        frames.append(new.frame)
        show(old, new, handle, region)

    window.canvas.show_state = seen
    drag(qtbot, window, ring_grip(window, 1), (40, 0), steps)
    idle(qtbot, window)
    window.canvas.show_state = show
    return frames


def areas(U, F):
    return 0.5 * np.linalg.norm(np.cross(U[F[:, 1]] - U[F[:, 0]], U[F[:, 2]] - U[F[:, 0]]), axis=1)


def volume(U, F):
    a, b, c = (U[F[:, k]] for k in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0


def readings(chart):
    return [text for text, _ in chart.readings]


def number(text):
    found = re.search(r"[+−-]?[\d.,]+", text).group()
    return float(found.replace("−", "-").replace(",", ""))


def watched(plots):
    """How often each chart is asked for from now on."""
    counts = dict.fromkeys(plots.views, 0)
    for name, view in plots.views.items():

        def asked(name=name, make=view.chart):
            counts[name] += 1
            return make()

        view.chart = asked
    return counts


def test_plots_have_curves_of_what_was_shown_on_the_way(qtbot, plotted):
    plotted.session.settings.change(method="paper")
    idle(qtbot, plotted)
    frames = twist(qtbot, plotted, 12)
    mesh = plotted.session.store.state.document.mesh
    V, F = mesh.V, mesh.F
    rest_area, rest_volume = areas(V, F).sum(), volume(V, F)
    change = [100.0 * (areas(frame.U, F).sum() / rest_area - 1.0) for frame in frames]
    emptied = [100.0 * (volume(frame.U, F) / rest_volume - 1.0) for frame in frames]
    views = plotted.plots.views
    chart = views["area"].chart()
    below, above = chart.curves
    for curve, shown in ((below, emptied), (above, change)):
        distance = np.abs(np.subtract.outer(curve.y, shown)).min(axis=1)
        assert distance.max() < 1e-9, "a curve goes through nothing but what was shown"
        assert curve.y[-1] == pytest.approx(shown[-1], abs=1e-9)
        assert len(curve.y) > 4
    assert number(readings(chart)[0]) == pytest.approx(change[-1], abs=5e-4)
    assert number(readings(chart)[1]) == pytest.approx(emptied[-1], abs=5e-3)
    errors = views["error"].chart()
    (curve,) = errors.curves
    assert 10.0 ** curve.y[-1] == pytest.approx(abs(change[-1]) / 100.0, rel=1e-6)
    assert (np.diff(curve.x) > 0).all()
    assert curve.x[-1] >= frames[-1].iteration
    assert errors.horizontal_lines[0].place == pytest.approx(
        np.log10(plotted.session.store.state.document.settings.tolerance)
    )
    (curve,) = views["energy"].chart().curves
    assert curve.y[-1] == frames[-1].energy > curve.y[0] >= 0.0


def test_local_change_has_the_histogram_of_the_triangles(qtbot, plotted):
    twist(qtbot, plotted)
    state = plotted.session.store.state
    F, rest = state.document.mesh.F, areas(state.document.mesh.V, state.document.mesh.F)
    ratio = areas(state.frame.U, F) / rest
    chart = plotted.plots.views["local"].chart()
    edges = chart.bars.edges.copy()
    assert edges[0] == -edges[-1]
    edges[0], edges[-1] = -np.inf, np.inf
    expected = 100.0 * np.histogram(np.log2(ratio), edges, weights=rest)[0] / rest.sum()
    np.testing.assert_allclose(chart.bars.heights, expected, atol=1.0)
    assert chart.bars.heights.sum() == pytest.approx(100.0)
    changed = np.abs(ratio - 1.0)
    order = np.argsort(changed)
    p99 = changed[order][np.searchsorted(np.cumsum(rest[order]) / rest.sum(), 0.99)]
    found = [number(text.replace("99th", "")) for text in readings(chart)]
    wanted = 100.0 * np.array([np.average(changed, weights=rest), p99, changed.max()])
    assert found == pytest.approx(wanted, rel=0.02)


def test_plots_compute_nothing_while_nobody_looks_and_once_for_a_picture_otherwise(
    qtbot, new_bottle, monkeypatch
):
    bottle = new_bottle
    changes, compute = [], plots_module.local_change

    def noted(*given):
        change = compute(*given)
        changes.append(weakref.ref(change))
        return change

    monkeypatch.setattr(plots_module, "local_change", noted)
    plots, dock = bottle.plots, bottle.docks["plots"]
    counts = watched(plots)
    assert not dock.isVisible()
    twist(qtbot, bottle)
    assert set(counts.values()) == {0}
    dock.show()
    loaded(qtbot, bottle)
    qtbot.waitUntil(lambda: counts["error"] > 0)
    work_off()
    for name in counts:
        counts[name] = 0
    for _ in range(20):
        plots.refresh()
    qtbot.waitUntil(lambda: counts["error"] > 0)
    work_off()
    assert (counts["error"], counts["local"], counts["energy"]) == (1, 1, 0)
    assert changes[-1]() is not None
    dock.hide()
    assert {change() for change in changes} == {None}, "no shape is kept that nobody looks at"


def test_plots_are_shown_and_hidden_by_a_key(qtbot, kept_window):
    kept_window.shell.activateWindow()
    qtbot.waitUntil(kept_window.shell.isActiveWindow)
    (action,) = [a for a in kept_window.docks.toggles if a.text() == "Plots"]
    qtbot.keyClick(kept_window.canvas.viewport, Qt.Key.Key_P, Qt.KeyboardModifier.ControlModifier)
    qtbot.waitUntil(kept_window.docks["plots"].isVisible)
    assert action.isChecked()
    menus = kept_window.shell.menuBar().findChildren(QMenu)
    assert any(action in menu.actions() for menu in menus)
    qtbot.keyClick(kept_window.canvas.viewport, Qt.Key.Key_P, Qt.KeyboardModifier.ControlModifier)
    qtbot.waitUntil(lambda: not kept_window.docks["plots"].isVisible())


def test_plots_say_where_they_are_empty_what_will_be_there(qtbot, window):
    charts = {name: view.chart() for name, view in window.plots.views.items()}
    assert all(chart.x is None and chart.empty_text.endswith(".") for chart in charts.values())
    assert "Open a mesh" in charts["local"].empty_text
    assert "Move a handle" in charts["energy"].empty_text


def invitation(plots):
    """What is said where nothing is plotted."""
    return next(label for label in plots.findChildren(QLabel) if label.text().startswith("Choose above"))


def test_plots_remember_what_was_chosen(qtbot, kept_window):
    plots = kept_window.plots
    assert [name for name, view in plots.views.items() if not view.isHidden()] == ["error", "area", "local"]
    plots.choices["energy"].click()
    for name in ("error", "area"):
        plots.choices[name].click()
    again = Plots(kept_window.preferences, kept_window.notice, kept_window.session)
    qtbot.addWidget(again)
    assert [name for name, view in again.views.items() if not view.isHidden()] == ["energy", "local"]
    for button in again.choices.values():
        button.setChecked(False)
    assert not invitation(again).isHidden()
    none = Plots(kept_window.preferences, kept_window.notice, kept_window.session)
    qtbot.addWidget(none)
    assert not invitation(none).isHidden(), "nothing is a choice too"


@pytest.mark.parametrize("size", [(348, 500), (348, 180), (560, 560), (740, 200), (1230, 220)])
def test_plots_give_what_chooses_and_the_charts_room_of_their_own(qtbot, kept_window, size):
    plots = Plots(kept_window.preferences, kept_window.notice, kept_window.session)
    qtbot.addWidget(plots)
    for button in plots.choices.values():
        button.setChecked(True)
    plots.resize(*size)
    plots.show()
    qtbot.waitExposed(plots)
    work_off()
    head = [*plots.choices.values(), plots.save]
    for widgets in (head, list(plots.views.values())):
        places = [QRect(widget.mapTo(plots, QPoint(0, 0)), widget.size()) for widget in widgets]
        assert not any(a.intersects(b) for k, a in enumerate(places) for b in places[:k])
    for button in head:
        assert button.width() >= button.sizeHint().width(), f"{button.text()} is cut off"
        assert plots.rect().contains(QRect(button.mapTo(plots, QPoint(0, 0)), button.size()))
    beside = plots.views["error"].y() == plots.views["energy"].y()
    assert beside == (size[0] > max(560, size[1]))
    assert all(view.height() >= 96 for view in plots.views.values())


def test_plots_are_drawn_in_the_colors_of_the_window(qtbot, plotted):
    plotted.actions_.view.schemes[Qt.ColorScheme.Dark].trigger()
    twist(qtbot, plotted)
    picture = plotted.plots.grab().toImage().convertToFormat(QImage.Format.Format_RGB32)
    pixels = np.frombuffer(picture.constBits(), np.uint32).reshape(picture.height(), -1) & 0xFFFFFF
    drawn = (DARK.panel, 0.5), (DARK.accent, 1e-5), (DARK.warm, 1e-5), (DARK.more, 1e-4), (DARK.ink, 1e-5)
    for color, least in drawn:
        assert (pixels == int(color[1:], 16)).mean() > least, color


def savings(plots):
    """What the menu offers to save: two pictures, the gesture and the histogram."""
    plots.save.menu().aboutToShow.emit()  # in which it looks what there is
    return [action for action in plots.save.menu().actions() if not action.isSeparator()]


def asked(monkeypatch, path):
    monkeypatch.setattr(plots_module, "ask_where_to_save_plots", lambda *_: path)


def test_plots_write_pictures_of_what_is_shown(qtbot, plotted, monkeypatch, tmp_path):
    twist(qtbot, plotted)
    plots, shown = plotted.plots, ["Area error by iteration", "Local area change"]
    for name in ("energy", "area"):
        plots.choices[name].click()
    work_off()
    png, svg, *_ = savings(plots)
    asked(monkeypatch, tmp_path / "plots.svg")
    svg.trigger()
    tree = ElementTree.parse(tmp_path / "plots.svg")
    assert "Generated with" not in (tmp_path / "plots.svg").read_text(encoding="utf-8")
    texts = ["".join(node.itertext()).strip() for node in tree.iter("{http://www.w3.org/2000/svg}text")]
    assert [text for text in texts if text in shown] == shown
    assert not any("gesture" in text for text in texts)
    assert plotted.notice.text == "Saved plots.svg."
    asked(monkeypatch, tmp_path / "plots.png")
    png.trigger()
    image = QImage(str(tmp_path / "plots.png"))
    views = [plots.views["error"], plots.views["local"]]
    assert image.height() == 3 * views[0].height()
    assert image.width() >= 3 * sum(view.width() for view in views)
    assert image.pixelColor(1, 1).name() == "#ffffff"
    heights = image.height() * np.arange(1, 8) // 8
    assert len({image.pixel(x, int(y)) for y in heights for x in range(image.width())}) > 5


def test_plots_write_the_numbers_of_the_trace_and_of_the_triangles(qtbot, plotted, monkeypatch, tmp_path):
    twist(qtbot, plotted)
    plots = plotted.plots
    asked(monkeypatch, tmp_path / "gesture.csv")
    *_, numbers, histogram = savings(plots)
    numbers.trigger()
    with (tmp_path / "gesture.csv").open(newline="") as stream:
        head, *lines = csv.reader(stream)
    assert tuple(head) == TRACE_COLUMNS
    found = np.array([[float(cell or "nan") for cell in line] for line in lines])
    np.testing.assert_array_equal(found, plotted.session.store.trace.rows)
    asked(monkeypatch, tmp_path / "change.csv")
    histogram.trigger()
    with (tmp_path / "change.csv").open(newline="") as stream:
        _, *lines = csv.reader(stream)
    state = plotted.session.store.state
    F, rest = state.document.mesh.F, areas(state.document.mesh.V, state.document.mesh.F)
    ratio = areas(state.frame.U, F) / rest
    low, high, share = np.array([[float(cell or "inf") for cell in line] for line in lines]).T
    assert low[0] == 0.0
    np.testing.assert_array_equal(low[1:], high[:-1])
    assert share.sum() == pytest.approx(1.0)
    # Edges away from unchanged, where half of the surface lies on one side of rounding.
    for edge in (low[60], low[100]):
        expected = rest[ratio < edge].sum() / rest.sum()
        assert share[high <= edge].sum() == pytest.approx(expected, abs=0.005)


def test_plots_say_in_one_sentence_what_cannot_be_written(qtbot, plotted, monkeypatch, tmp_path):
    twist(qtbot, plotted)
    plots = plotted.plots
    for action in savings(plots):
        asked(monkeypatch, tmp_path / "nowhere" / "x.svg")
        action.trigger()
        assert plotted.notice.text.endswith("choose another location. Nothing was changed.")
        plotted.notice.hide()
        asked(monkeypatch, None)  # the user thought better of it
        action.trigger()
        assert plotted.notice.text == ""
    assert list(tmp_path.rglob("x*")) == []


@pytest.mark.parametrize("theme", [LIGHT, DARK])
def test_theme_has_the_colors_of_the_overlay_for_the_histogram(theme):
    def rgb(color):
        return tuple(int(color[k : k + 2], 16) for k in (1, 3, 5))

    half = len(DIVERGING.knots) // 2
    assert rgb(theme.less) in DIVERGING.knots[:half]
    assert rgb(theme.more) in DIVERGING.knots[half + 1 :]
