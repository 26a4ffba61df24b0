"""Methods side by side in a real window: the table, the linked views, the colours, and the files."""

import csv
import gettext
import re
import threading
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from driving import LEFT, NONE, Mouse, centre, document, idle
from kept_window import lasting_window, settings_in
from meshes import box, ends, rotation
from PySide6.QtCore import Qt
from PySide6.QtGui import QImage

import apd_viewer
from apd_viewer import language
from apd_viewer.cases.comparison import MethodOutcome
from apd_viewer.geometry.analysis.deviation import Deviation
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.geometry.solver.convergence import Convergence
from apd_viewer.geometry.solver.methods import METHODS
from apd_viewer.presentation import method_readings
from apd_viewer.presentation.method_readings import reading_columns
from apd_viewer.session.model.handles_and_regions import NamedRegion
from apd_viewer.session.processes.request_and_reply import Cost
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.compare.method_table import MethodTable
from apd_viewer.ui.filing import file_dialogs

CTRL_SHIFT = Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier
SETTLED = 30_000

# A turn about the middle of the bar's upper end, and a shift.
BENT = np.eye(4)
BENT[:3, :3] = rotation((0, 1, 0), 0.6)
BENT[:3, 3] = [1.5, 1.0, 6.2] - BENT[:3, :3] @ [1.0, 1.0, 6.0]


@pytest.fixture
def window(kept_window):
    """The window of all tests of the file."""
    return kept_window


def paint_ends(window):
    base, handle = ends(document(window).mesh.V)
    for ids, label in ((base, BASE), (handle, HANDLE)):
        window.session.gestures.begin()
        window.session.painting.paint(ids, label)
        window.session.painting.end_stroke("paint")


@pytest.fixture
def ready(compiled, monkeypatch):
    """The solver has its kernels."""
    monkeypatch.setattr("apd_viewer.session.processes.request_solver.warm_up", lambda: None)


@pytest.fixture
def bar(qtbot, window, ready):
    """A window on a bar that is bent, without contact."""
    return bent(qtbot, window)


def bent(qtbot, window):
    window.files.show_mesh(Mesh(*box(2, 2, 6)))
    idle(qtbot, window)
    window.session.settings.set_contact(False)
    paint_ends(window)
    window.session.handles.set_pose(BENT, 0, "bend")
    idle(qtbot, window)
    return window


def opened(qtbot, window):
    window.actions_.simulate.compare.trigger()
    side = window.comparison.window
    qtbot.waitExposed(side)
    return side


@pytest.fixture
def side(qtbot, bar):
    """The methods compared, all having settled and been measured."""
    return settled(qtbot, bar)


@pytest.fixture(scope="module")
def another(qapp, tmp_path_factory):
    """A second window, with settings of its own."""
    with lasting_window(settings_in(tmp_path_factory.mktemp("settings"))) as kept:
        yield kept


@pytest.fixture
def compared(qtbot, another, unasked, ready):
    """The same, for tests that leave the methods and their shapes alone; with the main window."""
    main = another.opened(qtbot)
    side = main.comparison.window or settled(qtbot, bent(qtbot, main))
    return main, side


def settled(qtbot, bar):
    side = opened(qtbot, bar)
    qtbot.waitUntil(
        lambda: all(view.status_texts[0] == "converged" for view in side.views.values()), timeout=SETTLED
    )
    qtbot.waitUntil(lambda: all(view.values is not None for view in side.views.values()), timeout=SETTLED)
    state = bar.session.store.state
    change = Deviation(state.document.mesh.V, state.surface_index.joined, state.surface_index.source)
    qtbot.waitUntil(lambda: measured(side, change), timeout=SETTLED)
    return side


def measured(side, change):
    """Whether what was measured last is what has settled."""
    return all(np.array_equal(v.values, change.area_change(v.surface.shape)) for v in side.views.values())


@pytest.mark.night
def test_comparison_window_draws_the_obstacles_of_the_main_view_beside_each_shape(qtbot, bar):
    session, main = bar.session, bar.obstacles.scene
    session.obstacles.add_floor(np.array([0.0, 0.0, 1.0]), None)
    session.obstacles.move(0, np.array([0.0, 0.0, -0.25]))
    idle(qtbot, bar)
    side = opened(qtbot, bar)
    for view in side.views.values():
        (each,) = view.obstacles.drawn_obstacles
        assert each.obstacle is main.drawn_obstacles[0].obstacle
    without = next(method for method in side.views if not METHODS[method].may_use_contact)

    def drawn(method):
        return side.views[method].obstacles.drawn_obstacles[0]

    qtbot.waitUntil(lambda: drawn("exact").shift.any() and drawn(without).is_idle, timeout=60_000)
    assert not drawn("exact").is_idle
    for method in ("exact", without):
        np.testing.assert_allclose(drawn(method).shift, document(bar).obstacles[0].shift, atol=1e-9)
    actors = side.views["exact"].viewport.renderer.GetActors()
    assert any(actor.GetVisibility() and actor.GetForceTranslucent() for actor in actors)


def cells(side):
    """The table by method and title of the column."""
    table = side.table
    titles = [table.horizontalHeaderItem(k).text().replace("\n", " ") for k in range(table.columnCount())]
    return {
        table.verticalHeaderItem(row).text(): {
            title: table.item(row, k).text() for k, title in enumerate(titles)
        }
        for row in range(table.rowCount())
    }


def number(text):
    mantissa, _, power = text.replace("\u00a0", " ").split(" ")[0].replace("−", "-").partition("·10")
    powers = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
    return float(mantissa.replace(",", "")) * 10.0 ** float(power.translate(powers) or 0)


def alone(window, method):
    asked = document(window)
    held, mesh, given = asked.constraints(), asked.mesh, {"contact": asked.settings.contact}
    return apd_viewer.deform(mesh.V, mesh.F, held.fixed, held.targets, method, handle=held.handles, **given)


def test_method_table_says_what_each_method_comes_to_alone(qtbot, compared):
    bar, side = compared
    found = cells(side)
    assert list(found) == ["ARAP", "Paper (Li & Hui)", "Exact", "Local"]
    for method, line in zip(side.views, found.values(), strict=True):
        result = alone(bar, method)
        assert number(line["Area"]) == pytest.approx(100 * result.area / result.area_rest, abs=6e-5)
        assert number(line["Area error"]) == pytest.approx(100 * result.area_error, abs=6e-5)
        assert number(line["Volume"]) == pytest.approx(
            100 * (result.volume / result.volume_rest - 1), abs=6e-3
        )
        assert number(line["Energy"]) == pytest.approx(result.energy, rel=6e-5)
        assert number(line["Handle drift"]) == pytest.approx(result.handle_drift, rel=6e-4, abs=1e-5)
        assert number(line["Local change"]) == pytest.approx(100 * result.local_change, abs=6e-3)
        for title, strain in (("Edge", result.largest_edge_strain), ("Mean", result.mean_edge_strain)):
            assert number(line[f"{title} strain"]) == pytest.approx(100 * strain, abs=6e-3)
        assert number(line["Iterations"]) == result.iterations
        assert re.fullmatch(r"[\d,]+\.\d\d\u00a0s", line["Time"])
    assert len({line["Energy"] for line in found.values()}) == 4, "the test is blind"
    side.resize(1320, 820)
    qtbot.waitUntil(lambda: side.table.horizontalScrollBar().maximum() == 0)
    assert "Eq. 1" in side.table.horizontalHeaderItem(3).toolTip()


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (1e-17, "0"), (0.012345678, "+1.2346"), (-5e-4, "−0.0500"), (-2.66e-15, "−3·10⁻¹³")],
)
def test_method_readings_write_errors_with_the_digits_that_count(painted_bottle, value, text):
    written = {column.title: column.cell_text for column in reading_columns(painted_bottle, Unit.NONE)}
    assert written["Area error"]({"area_miss": value}) == text + "\u00a0%"


def test_linked_views_turn_all_when_one_is_turned(qtbot, compared):
    _, side = compared
    views = [view.viewport for view in side.views.values()]
    sizes = {(view.width(), view.height()) for view in views}
    assert max(w for w, _ in sizes) - min(w for w, _ in sizes) <= 1
    before, draws = views[0].camera_controller.camera, [view.draw_count for view in views]
    Mouse(views[2]).drag((10, 10), (60, 30), (90, 40))
    assert (
        np.linalg.norm(views[0].camera_controller.camera.position - before.position) > 0.1 * before.distance
    )
    for view in views:
        assert view.camera_controller.camera.key[:9] == views[0].camera_controller.camera.key[:9]
    qtbot.waitUntil(lambda: all(v.draw_count > n for v, n in zip(views, draws, strict=True)))
    Mouse(views[1]).wheel(centre(views[1]), 2)
    assert views[3].camera_controller.camera.distance < 0.99 * before.distance
    side.activateWindow()
    qtbot.waitUntil(side.isActiveWindow)
    qtbot.keyClick(views[3], Qt.Key.Key_3)
    direction = views[0].camera_controller.camera.position - views[0].camera_controller.camera.focal
    np.testing.assert_allclose(direction / np.linalg.norm(direction), [1.0, 0.0, 0.0], atol=1e-9)
    qtbot.keyClick(views[0], Qt.Key.Key_F)
    for view, shown in zip(views, side.views.values(), strict=True):
        at = view.camera_controller.camera.project(shown.surface.U)
        assert (at > 0).all()
        assert (at < [view.width(), view.height()]).all()


def test_shared_scale_fits_all_shapes_when_the_comparison_ends_until_a_range_is_chosen(qtbot, side):
    def largest():
        return np.expm1(max(np.abs(view.values).max() for view in side.views.values()))

    qtbot.waitUntil(lambda: largest() <= side.legend.scale.reach < 2.51 * largest())
    assert side.legend.scale.reach != 0.1, "the test is blind"
    expected = {np.log1p(side.legend.scale.reach)}
    for view in side.views.values():
        view.viewport.screenshot(return_img=True)
        shades = np.clip(128 + 127 * view.values / max(expected), 1, 255)
        np.testing.assert_allclose(view.surface.shades, shades, atol=0.51)
    side.legend.reach.setValue(4.0)
    side.linked.span_measured.emit((-0.5, 0.5))
    assert side.legend.scale.reach == 0.04


def test_shared_scale_gives_equal_values_equal_colors_in_all_views(qtbot, compared):
    _, side = compared
    side.legend.reach.setValue(4.0)
    assert side.legend.scale.reach == 0.04
    colors = {}
    for view in side.views.values():
        view.viewport.screenshot(return_img=True)
        for value, shade in zip(view.values, view.surface.shades, strict=True):
            colors.setdefault(round(float(value), 12), set()).add(int(shade))
        end = np.log(1.04)
        expected = np.clip(128 + 127 * view.values / end, 1, 255)
        np.testing.assert_allclose(view.surface.shades, expected, atol=0.51)
        assert view.surface.color_map is side.views["arap"].surface.color_map
    assert all(len(shades) == 1 for shades in colors.values())
    assert {1, 255} <= {shade for shades in colors.values() for shade in shades}
    all_values = np.concatenate([view.values for view in side.views.values()])
    span = all_values.min(), all_values.max()
    qtbot.waitUntil(lambda: side.legend.span == pytest.approx(span))
    qtbot.mouseClick(side.legend.fit, LEFT)
    largest = np.expm1(np.abs(all_values).max())
    assert largest <= side.legend.scale.reach < 2.51 * largest


def test_linked_views_read_the_place_under_the_cursor_on_every_shape(compared):
    _, side = compared
    view = side.views["exact"]
    at = view.viewport.camera_controller.camera.project(view.surface.U.mean(axis=0)[None])[0]
    Mouse(view.viewport).move(at, NONE)
    place = view.probe.marked_point
    corners = view.surface.surface_index.F[place.face]
    point = place.weights @ view.surface.U[corners]
    np.testing.assert_allclose(view.viewport.camera_controller.camera.project(point[None])[0], at, atol=0.1)
    for other in side.views.values():
        value = 100.0 * np.expm1(place.weights @ other.values[corners])
        assert number(other.marked_value) == pytest.approx(value, rel=6e-3, abs=1e-2)
    view.viewport.leaveEvent(None)
    assert {other.marked_value for other in side.views.values()} == {""}


def asked(monkeypatch, path):
    monkeypatch.setattr(file_dialogs.QFileDialog, "getSaveFileName", lambda *_: (str(path or ""), ""))


def test_write_table_writes_to_the_last_digit(qtbot, compared, monkeypatch, tmp_path):
    bar, side = compared
    asked(monkeypatch, tmp_path / "methods")
    qtbot.mouseClick(side.save_table, LEFT)
    assert side.status.text() == "Saved methods.csv."
    with (tmp_path / "methods.csv").open(newline="", encoding="utf-8") as stream:
        lines = list(csv.DictReader(stream))
    assert [line["method"] for line in lines] == list(side.views)
    for line in lines:
        outcome = side.comparison.outcomes[line["method"]]
        assert float(line["area"]) == outcome.frame.area
        assert float(line["area_error"]) == outcome.frame.area_error
        assert float(line["volume"]) == outcome.frame.volume
        assert float(line["energy"]) == outcome.cost.energy
        assert float(line["handle_drift"]) == outcome.frame.handle_drift
        assert float(line["local_change"]) == outcome.frame.local_change
        assert int(line["iterations"]) == outcome.frame.iteration
        assert float(line["seconds"]) == outcome.cost.seconds
        assert float(line["area_rest"]) == bar.session.store.state.inspection.area


@pytest.mark.night
def test_write_picture_draws_all_shapes_and_leaves_the_views_as_they_were(
    qtbot, compared, monkeypatch, tmp_path
):
    _, side = compared
    view = side.views["exact"].viewport
    before = view.screenshot(return_img=True)
    asked(monkeypatch, tmp_path / "methods.png")
    qtbot.mouseClick(side.save_picture, LEFT)
    np.testing.assert_array_equal(view.screenshot(return_img=True), before)
    image = QImage(str(tmp_path / "methods.png")).convertToFormat(QImage.Format.Format_RGB888)
    pixels = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())
    pixels = pixels[:, : 3 * image.width()].reshape(image.height(), image.width(), 3).astype(int)
    drawn = (np.ptp(pixels, axis=2) > 60).reshape(image.height(), -1)
    across = side.linked.column_count
    for part in np.array_split(drawn[: image.height() * 3 // 4], across, axis=1):
        assert part.mean() > 0.002, "a view without a shape in colours"
    assert drawn[image.height() * 7 // 8 :].sum() > 100, "no legend"
    assert (pixels[2, 2] == 255).all()


def test_comparison_window_says_in_one_sentence_what_cannot_be_written(
    qtbot, compared, monkeypatch, tmp_path
):
    _, side = compared
    for button, suffix in ((side.save_table, ".csv"), (side.save_picture, ".png")):
        asked(monkeypatch, tmp_path / "nowhere" / f"x{suffix}")
        qtbot.mouseClick(button, LEFT)
        assert side.status.text().endswith("choose another location. Nothing was changed.")
        assert side.status.property("warn")
    assert list(tmp_path.rglob("x*")) == []


@pytest.mark.parametrize(("target", "said"), [(100.0, "100"), (97.25, "97.25"), (1000.0, "1000")])
def test_reading_columns_say_that_the_error_is_that_of_what_is_asked_for(bar, target, said):
    bar.session.settings.change(area=target)
    titles = {column.title: column.tip for column in reading_columns(bar.session.store.state, Unit.NONE)}
    assert titles["Area error"] == f"Deviation of the area from its target of {said} %"


def test_comparison_window_compares_two_at_least_and_remembers_the_choice(qtbot, bar, side):
    for method in ("local", "paper"):
        qtbot.mouseClick(side.checks[method], LEFT)
    assert side.chosen_methods == ["arap", "exact"]
    assert [method for method, check in side.checks.items() if not check.isEnabled()] == ["arap", "exact"]
    qtbot.mouseClick(side.checks["arap"], LEFT)
    assert side.chosen_methods == ["arap", "exact"]
    assert list(cells(side)) == ["ARAP", "Exact"]
    assert [view.isVisible() for view in side.views.values()] == [True, False, True, False]
    side.close()
    again = opened(qtbot, bar)
    assert again.chosen_methods == ["arap", "exact"]


def endless(monkeypatch):
    """Let no method settle in the comparison."""
    monkeypatch.setattr(
        "apd_viewer.geometry.solver.deformation.Deformation.settled", property(lambda _: False)
    )
    never = property(lambda _: Convergence(most_iterations=10**9), lambda *_: None)
    monkeypatch.setattr("apd_viewer.geometry.solver.deformation.Deformation.convergence", never)


def solvers():
    return [thread for thread in threading.enumerate() if thread.name in ("solver", "answers")]


def test_comparison_window_takes_the_shape_that_stands_in_the_main_window(qtbot, bar):
    state = bar.session.store.state
    side = opened(qtbot, bar)
    assert {method: view.status_texts[0] for method, view in side.views.items() if method != "arap"} == {
        "paper": "waits for ARAP",
        "exact": "converged",
        "local": "waits for Paper (Li & Hui)",
    }
    assert side.comparison.outcomes["exact"].frame is state.frame
    np.testing.assert_array_equal(side.views["exact"].surface.shape, state.frame.U)
    found = cells(side)
    assert found["Local"]["Area"] == "waits for Paper (Li & Hui)"
    assert found["Exact"]["Time"].endswith("s")
    qtbot.waitUntil(lambda: side.comparison.current_method is None, timeout=SETTLED)
    assert cells(side)["Exact"] == found["Exact"], "nothing solves it again"
    assert "main window" in tip(side, "Exact", "Time")
    assert "main window" not in tip(side, "Local", "Time")
    qtbot.mouseClick(side.again, LEFT)
    assert side.views["exact"].status_texts[0] == "waits for Paper (Li & Hui)", "asked again for the same"
    qtbot.waitUntil(lambda: side.comparison.current_method is None, timeout=SETTLED)
    again = cells(side)["Exact"]
    assert {**again, "Time": ""} == {**found["Exact"], "Time": ""}


def tip(side, method, title):
    table = side.table
    row = [table.verticalHeaderItem(k).text() for k in range(table.rowCount())].index(method)
    columns = [table.horizontalHeaderItem(k).text() for k in range(table.columnCount())]
    return table.item(row, columns.index(title)).toolTip()


@pytest.mark.night
def test_comparison_window_says_of_a_dragged_shape_that_it_is_as_it_stands(qtbot, bar):
    pose = BENT.copy()
    pose[0, 3] += 0.5
    bar.session.handles.set_pose(pose, 0, "bend")
    idle(qtbot, bar)
    side = opened(qtbot, bar)
    row = "Exact, as it stands in the window"
    assert side.views["exact"].status_texts[0] == "as it stands in the window"
    assert (cells(side)[row]["Iterations"], cells(side)[row]["Time"]) == ("–", "–")
    assert "other shapes" in tip(side, row, "Time")
    assert "other shapes" not in tip(side, row, "Area")
    qtbot.mouseClick(side.again, LEFT)
    qtbot.waitUntil(lambda: side.comparison.current_method is None, timeout=SETTLED)
    assert number(cells(side)["Exact"]["Iterations"]) == alone(bar, "exact").iterations
    assert re.fullmatch(r"[\d,]+\.\d\d\u00a0s", cells(side)["Exact"]["Time"])


def test_comparison_window_solves_anew_after_a_change_of_settings(qtbot, bar):
    before = bar.session.store.state.frame
    bar.session.settings.change(stiffness=0.05)
    side = opened(qtbot, bar)
    assert side.views["exact"].status_texts[0] == "waits for Paper (Li & Hui)"
    qtbot.waitUntil(lambda: side.comparison.current_method is None, timeout=SETTLED)
    frame = side.comparison.outcomes["exact"].frame
    assert frame.converged
    assert np.abs(frame.U - before.U).max() > 1e-3, "the test is blind"
    assert frame.iteration != before.iteration


@pytest.mark.night
def test_comparison_window_leaves_nothing_when_closed_in_the_middle(qtbot, bar, monkeypatch):
    own = len(solvers())
    endless(monkeypatch)
    side = opened(qtbot, bar)
    qtbot.waitUntil(lambda: side.views["arap"].status_texts[0].startswith("iteration"), timeout=SETTLED)
    assert len(solvers()) == own + 2
    assert side.views["local"].status_texts[0] == "waits for Paper (Li & Hui)"
    assert re.fullmatch(r"ARAP \(1 of 4\): iteration [\d,]+", side.status.text())
    qtbot.waitUntil(side.progress.isVisible, timeout=SETTLED)
    assert re.search("time left|left$|energy", side.progress.time_left.text())
    side.close()
    assert len(solvers()) == own
    assert bar.comparison.window is None


def test_comparison_window_stops_by_esc_and_goes_with_the_main_window(qtbot, bar, monkeypatch):
    own = len(solvers())
    endless(monkeypatch)
    side = opened(qtbot, bar)
    qtbot.waitUntil(lambda: side.views["arap"].status_texts[0].startswith("iteration"), timeout=SETTLED)
    qtbot.keyClick(side.views["arap"].viewport, Qt.Key.Key_Escape)
    assert side.views["arap"].status_texts[0].startswith("stopped at iteration")
    assert side.views["local"].status_texts[0] == "not started"
    assert len(solvers()) == own
    assert side.isVisible()
    bar.shell.close()
    assert not side.isVisible()


def test_shared_scale_fits_all_shapes_when_the_comparison_is_stopped(qtbot, bar, monkeypatch):
    endless(monkeypatch)
    side = opened(qtbot, bar)
    qtbot.waitUntil(lambda: side.legend.span is not None, timeout=SETTLED)
    side.linked.span_measured.disconnect()  # as if everything had been read before
    assert side.legend.scale.reach == 0.1, "which is not fitted meanwhile"
    side.legend.span = (-0.5, 0.7)
    qtbot.keyClick(side.views["arap"].viewport, Qt.Key.Key_Escape)
    assert side.legend.scale.reach >= 0.7
    side.close()


@pytest.mark.night
def test_comparison_window_takes_again_what_the_main_window_shows_now(qtbot, bar, side):
    before = cells(side)["Exact"]["Energy"]
    bar.session.handles.reset_handle(0)
    idle(qtbot, bar)
    bar.session.shapes.restore()
    idle(qtbot, bar)
    qtbot.mouseClick(side.again, LEFT)
    assert "at rest" in side.status.text()
    assert cells(side)["Exact"]["Energy"] == before
    pose = BENT.copy()
    pose[0, 3] += 1.0
    bar.session.handles.set_pose(pose, 0, "bend")
    qtbot.mouseClick(side.again, LEFT)
    done = side.comparison
    qtbot.waitUntil(lambda: done.current_method is None, timeout=SETTLED)
    assert number(cells(side)["Exact"]["Energy"]) == pytest.approx(alone(bar, "exact").energy, rel=6e-5)
    assert cells(side)["Exact"]["Energy"] != before


@pytest.mark.night
def test_comparison_window_measures_lengths_in_the_unit_that_is_chosen_for_the_mesh(qtbot, bar, side):
    before, status = cells(side), side.status.text()
    bar.choose_unit(Unit.CENTIMETRE)
    for method, said in cells(side).items():
        for title, text in said.items():
            unit = {"Energy": "\u00a0cm²", "Handle drift": "\u00a0cm"}.get(title, "")
            assert text == before[method][title] + unit
    assert side.status.text() == status
    bar.files.show_mesh(Mesh(*box(2, 2, 4)))
    idle(qtbot, bar)
    bar.choose_unit(Unit.METRE)
    assert cells(side)["Exact"]["Energy"].endswith("cm²"), "that is another mesh"


def test_comparing_says_what_is_missing(qtbot, window):
    action = window.actions_.simulate.compare
    assert not action.isEnabled()
    window.files.show_mesh(Mesh(*box(2, 2, 6)))
    idle(qtbot, window)
    assert action.isEnabled()
    window.shell.activateWindow()
    qtbot.waitUntil(window.shell.isActiveWindow)
    qtbot.keyClick(window.canvas.viewport, Qt.Key.Key_M, CTRL_SHIFT)
    qtbot.waitUntil(lambda: window.notice.text == document(window).paint_problem)
    paint_ends(window)
    idle(qtbot, window)
    action.trigger()
    assert "move a handle first" in window.notice.text
    assert window.comparison.window is None


def test_method_view_says_that_its_method_has_failed(qtbot, bar, monkeypatch, capfd):
    real = apd_viewer.Deformation.iterate

    def failing(solver):
        if solver.method == "paper":
            raise MemoryError
        real(solver)

    monkeypatch.setattr(apd_viewer.Deformation, "iterate", failing)
    side = opened(qtbot, bar)
    qtbot.waitUntil(lambda: side.views["local"].status_texts[0] == "converged", timeout=SETTLED)
    state, note = side.views["paper"].status_texts
    assert state == "failed"
    assert note.startswith("Not enough memory")
    assert set(cells(side)["Paper (Li & Hui)"].values()) == {""}
    assert side.views["exact"].status_texts == ("converged", "")


def test_method_table_does_not_cut_off_titles_of_columns_in_a_narrow_window(qtbot):
    table = MethodTable()
    qtbot.addWidget(table)
    titles = ["Area", "A title of another language", "Time"]
    table.set_columns([SimpleNamespace(title=title, tip="") for title in titles])
    table.resize(200, 100)
    table.show()
    head = table.horizontalHeader()
    for k in range(len(titles)):
        shown = table.horizontalHeaderItem(k).text()
        assert shown.replace("\n", " ") == titles[k]
        assert head.sectionSize(k) > head.fontMetrics().size(0, shown).width()


@pytest.mark.parametrize("name", ["", "de", "zh_CN"])
def test_method_table_fits_the_window_in_every_language(qtbot, monkeypatch, painted_bottle, name):
    folder = language.__file__.replace("language.py", "languages")
    catalogue = gettext.translation("apd_viewer", folder, [name], fallback=not name)
    monkeypatch.setattr(method_readings, "tr", catalogue.gettext)
    monkeypatch.setattr(method_readings, "trc", catalogue.pgettext)
    outcome = MethodOutcome(
        replace(painted_bottle.frame, iteration=1234, largest_edge_strain=-0.3342, local_change=0.727),
        is_finished=True,
        cost=Cost(energy=1234.5, seconds=123.45),
    )
    found = method_readings.method_readings(painted_bottle, "paper", outcome)
    table = MethodTable()
    qtbot.addWidget(table)
    table.set_columns(method_readings.reading_columns(painted_bottle, Unit.MILLIMETRE))
    table.show_methods(["ARAP", "Paper (Li & Hui)"])
    table.show_title(1, catalogue.gettext("{method}, no contact").format(method="Paper"))
    for row in range(2):
        table.show_readings(row, found)
    table.resize(992, 120)  # beside the legend, in a window of 1280 × 800
    table.show()
    head = table.horizontalHeader()
    assert head.length() <= table.viewport().width()
    for k in range(head.count()):
        assert head.sectionSize(k) >= max(head.sectionSizeHint(k), table.sizeHintForColumn(k))


def test_reading_columns_have_each_kept_region_and_its_area(painted_bottle):
    V, regions = painted_bottle.document.mesh.V, painted_bottle.document.regions
    assert regions == ()
    document = replace(
        painted_bottle.document,
        regions=(NamedRegion("label", 98.0), NamedRegion("free"), NamedRegion("neck of the bottle", 100.0)),
        member=frozen((1 + (V[:, 1] > 8.0) + (V[:, 1] > 15.0)).astype(np.uint8)),
    )
    rest = document.rest_areas
    areas = (0.98 * rest[0], rest[1], 1.5 * rest[2])
    state = replace(painted_bottle, document=document, frame=replace(painted_bottle.frame, regions=areas))
    found = method_readings.method_readings(state, "exact", MethodOutcome(state.frame))
    columns = method_readings.reading_columns(state, Unit.NONE)[2:4]
    assert [column.cell_text(found) for column in columns] == ["98.0000\u00a0%", "150.0000\u00a0%"]
    assert [column.title for column in columns] == ["label", "neck of the…"]
    assert "neck of the bottle" in columns[1].tip
    assert "98 %" in columns[0].tip
    assert (found["region_2"], found["region_2_rest"]) == (rest[1], rest[1])


def test_missing_contact_is_that_of_a_method_that_cannot_use_what_is_on(painted_bottle):
    for contact in (True, False):
        state = replace(painted_bottle, document=painted_bottle.document.with_settings(contact=contact))
        for method, traits in METHODS.items():
            said = method_readings.missing_contact(state, method)
            assert bool(said) == (contact and not traits.may_use_contact)
            assert traits.title in said or not said
            found = method_readings.method_readings(state, method, MethodOutcome(state.frame))
            assert found["contact"] == (contact and traits.may_use_contact)


def test_comparison_window_marks_a_method_that_runs_without_contact(qtbot, bar):
    bar.session.settings.set_contact(True)
    idle(qtbot, bar)
    side = opened(qtbot, bar)
    qtbot.waitUntil(lambda: side.comparison.current_method is None, timeout=SETTLED)
    assert [title.endswith("no contact") for title in cells(side)] == [False, True, False, False]
    heads = [side.table.verticalHeaderItem(row).toolTip() for row in range(4)]
    assert [("cannot use contact" in tip) for tip in heads] == [False, True, False, False]
