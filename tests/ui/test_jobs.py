"""Jobs of the window, each played from the opened file with its inputs counted.

An input is a click, a drag, a key or a text typed into a field; to look and to wait is none. *Before* is the
version without a timeline, counted in its manual and its code.

| job                                             | before | now |
|-------------------------------------------------|--------|-----|
| paint and twist                                 | 6      | 6   |
| press to 40 % and read the load                 | 6      | 3   |
| smallest volume of three motions                | 9      | 8   |
| bend a head with the body still                 | 6      | 6   |
| keep the area of a region                       | 5      | 5   |
| a report for a customer                         | 3      | 3   |
| fold a cloth, and once more across              | 16     | 13  |

Before, a press was a menu, its entry, a double click on *End at*, a number and a button in a dialog. The
number of cases needed a double click, each card of conditions a key to be closed, and a typed pivot the key
of the gizmo.
"""

from dataclasses import replace
from pathlib import Path

import meshes
import numpy as np
import pytest
from answering import once
from command_here import CommandHere
from counted_inputs import User, facing, line, ring_way
from driving import document, idle, work_off
from immediate import Here
from kept_window import opened_in, widened
from meshes import box, character, ends, grid, sphere
from page_parts import PageParts
from PySide6.QtCore import QCoreApplication, QPointF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QFileDialog
from study_work import computed

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.samples import SAMPLES
from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.geometry.solver.convergence import Convergence
from apd_viewer.session import file_jobs
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.ui.tools.tool_modes import Tool

CONTROL, SHIFT = Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.ShiftModifier
KEY = Qt.Key
MOST = 8  # inputs of a press, and of the question how small a bottle gets
WAIT = 600_000  # ms, for what other tests may slow down


@pytest.fixture
def opened(qtbot, kept_window, tmp_path):
    """Opens a mesh from a file, painted or not, in a window as large as at a first start; its user."""

    def begin(V, F, labels=None):
        path = tmp_path / "mesh.obj"
        save_mesh(Mesh(V, F), V, path)
        labels = np.full(len(V), FREE, dtype=np.uint8) if labels is None else labels.astype(np.uint8)
        opened_in(qtbot, kept_window, lambda: initial_state(open_mesh(path), labels))
        return user_of(qtbot, kept_window)

    yield begin
    kept_window.session.player.clear()
    for dock in ("timeline", "study"):
        kept_window.docks[dock].hide()
    idle(qtbot, kept_window)


def user_of(qtbot, window):
    """A user of the window as large as at a first start, with the keys in the view."""
    widened(qtbot, window)
    window.shell.activateWindow()
    qtbot.waitUntil(window.shell.isActiveWindow)
    window.canvas.viewport.setFocus()
    return User(qtbot, window)


def area_percent(window):
    return window.panel.area.percent.text()


def test_workbench_paints_and_twists_in_six_inputs(opened):
    V, F, _ = meshes.sample_bottle(edge=4.0)
    user = opened(V, F)
    window, height = user.window, V[:, 1]
    foot, neck = (facing(window, np.abs(height - y) < 0.5) for y in (1.5, 19.0))
    user.key(KEY.Key_Y)
    user.drag(*line(foot, foot + [0, 200]))
    user.key(KEY.Key_H)
    user.drag(*line(neck, neck + [0, -200]))
    user.key(KEY.Key_M)
    user.drag(*ring_way(window, 1, 60), modifiers=CONTROL)
    assert user.count <= 6
    assert {BASE, HANDLE} <= set(document(window).labels.tolist())
    assert window.panel.handles.list.rows[0].details.text() == "twisted +60.0°"
    assert area_percent(window) == "100.000 %"


def test_workbench_presses_to_forty_percent_and_reads_the_load_in_three_inputs(qtbot, opened):
    user = opened(*sphere(2))
    window, panel = user.window, user.window.press.panel
    user.key(KEY.Key_K, SHIFT)
    assert panel.end.hasFocus()
    panel.steps.setValue(2)  # for the pace of the test alone
    user.type("40")
    user.key(KEY.Key_Return)
    qtbot.waitUntil(lambda: not window.session.player.is_playing, timeout=WAIT)
    work_off()
    assert user.count <= 3 < MOST
    said = {row[0].text(): [label.text() for label in row[1:]] for row in panel.reading_rows}
    assert float(said["Load"][0].removesuffix(" at stiffness 1")) > 0.0
    assert said["Distance"][1] == "40.0 %"
    assert panel.calm.text() == "At rest."


@pytest.fixture(params=["here", pytest.param("process", marks=pytest.mark.night)])
def studying(request, monkeypatch, kept_window):
    """By day this process runs studies, with their cases one after the other."""
    if request.param == "here":
        monkeypatch.setattr("apd_viewer.commands.study_command.LocalPool", lambda _: Here(computed))
        command = kept_window.case_studies.run.command
        own = CommandHere(QCoreApplication.instance())
        own.reported.connect(command.reported)
        own.ended.connect(command.ended)
        monkeypatch.setattr(command, "start", own.start)


def test_workbench_finds_the_smallest_volume_of_three_motions_in_eight_inputs(qtbot, studying, opened):
    V, F = box(2, 2, 5)
    labels = np.full(len(V), FREE)
    labels[ends(V)[0]], labels[ends(V)[1]] = BASE, HANDLE
    user = opened(V, F, labels)
    window, panel = user.window, user.window.case_studies.panel
    user.choose("Simulate", "Study")
    dialog = window.case_studies.dialog
    user.tick(dialog.varied.rows["push"].check)
    user.tick(dialog.varied.rows["bend"].check)
    user.click(dialog.samples)
    qtbot.waitUntil(dialog.samples.hasFocus)
    user.type("6")
    assert dialog.samples.text() == "6"
    dialog.steps.setValue(2)  # for the pace of the test alone
    user.click(dialog.start)
    qtbot.waitUntil(lambda: panel.model.rows and not window.case_studies.run.is_running, timeout=WAIT)
    assert [row.status for row in panel.model.rows] == ["done"] * 6
    changes = [row.readings["volume_error"] for row in panel.model.rows]
    least = int(np.argmin(changes))
    lowest = max(panel.scatter.view.dot_positions(), key=lambda place: place[1])
    user.click(panel.scatter.view, QPointF(*lowest), "lowest dot")
    assert user.count <= MOST
    assert panel.table.chosen_rows == [least]
    state = window.session.store.state
    assert state.frame.volume / state.inspection.volume - 1.0 == pytest.approx(changes[least], abs=1e-9)
    assert changes[least] < -0.05


def test_workbench_bends_a_head_with_the_body_still_in_six_inputs(opened):
    V, F = character(0.3)
    user = opened(V, F)
    window = user.window
    chest, neck = (facing(window, np.abs(V[:, 1] - y) < 0.3) for y in (2.0, 3.2))
    user.key(KEY.Key_Y)
    user.drag(*line(chest, chest + [0, 500]))
    user.key(KEY.Key_H)
    user.drag(*line(neck, neck - [0, 200]))
    user.key(KEY.Key_M)
    user.drag(*ring_way(window, 2, 45), modifiers=CONTROL)
    assert user.count <= 6
    state, labels = window.session.store.state, document(window).labels
    np.testing.assert_array_equal(state.frame.U[labels == BASE], document(window).mesh.V[labels == BASE])
    assert window.panel.handles.list.rows[0].details.text() == "rotated +45.0°"
    assert area_percent(window) == "100.000 %"


def test_workbench_keeps_the_area_of_a_region_in_five_inputs(qtbot, bottle):
    user = user_of(qtbot, bottle)
    user.key(KEY.Key_R)  # whose bar the framed mesh keeps clear of
    label = facing(bottle, np.abs(document(bottle).mesh.V[:, 1] - 9.0) < 0.5)
    user.drag(*line(label - [40, 0], label + [40, 0]))
    (row,) = bottle.panel.regions.list.rows
    user.tick(row.details.box)
    user.key(KEY.Key_M)
    user.drag(*ring_way(bottle, 1, 60), modifiers=CONTROL)
    assert user.count <= 5
    assert document(bottle).member.any()
    assert row.reading.text() == "100.00 %, kept"
    assert area_percent(bottle) == "100.000 %"


@pytest.fixture
def own_dialogs(qapp):
    """Files are asked for by the dialogs of Qt, which a test can type into, on every system."""
    attribute = Qt.ApplicationAttribute.AA_DontUseNativeDialogs
    before = qapp.testAttribute(attribute)
    qapp.setAttribute(attribute)
    yield
    qapp.setAttribute(attribute, before)


def test_workbench_writes_a_report_in_four_inputs(qtbot, own_dialogs, opened, tmp_path):
    V, F = box(2, 2, 5)
    labels = np.full(len(V), FREE)
    labels[ends(V)[0]], labels[ends(V)[1]] = BASE, HANDLE
    user = opened(V, F, labels)
    window, path = user.window, tmp_path / "for the customer.html"
    window.session.handles.move_by(MOTIONS["TWIST"], "30deg", 0)  # the work that is reported
    user.wait()

    def name_file():
        user.type(str(path))
        user.key(KEY.Key_Return)

    def accept_title():
        once(
            lambda: isinstance(QApplication.activeModalWidget(), QFileDialog) and QApplication.focusWidget(),
            name_file,
        )
        user.inputs.append("key Key_Return")
        QTest.keyClick(QApplication.focusWidget(), KEY.Key_Return)

    user.key(KEY.Key_E, CONTROL | SHIFT, answer=accept_title)
    qtbot.waitUntil(lambda: window.notice.text == "Saved for the customer.html.", timeout=WAIT)
    assert user.count <= 4, "one is for the title as proposed"
    page = PageParts(path.read_text(encoding="utf-8"))
    assert page.wrong == []
    assert page.rows["Area"]["Area"].startswith("100.000 %")
    assert "twisted +30.0°" in page.rows["Handles"]["Handle 1"]
    assert page.rows["Volume reduction"]
    assert page.tags.count("img") == 3


@pytest.fixture
def cloth(qtbot, kept_window):
    """A user of the sample of the cloth."""
    kept_window.session.files.open_sample("cloth")
    idle(qtbot, kept_window)
    return user_of(qtbot, kept_window)


@pytest.fixture
def coarse_cloth(monkeypatch):
    """A flat cloth in the place of the sample, in cells of a few centimetres that come to rest quickly."""
    V, F = grid(12, 18, 20 / 12, 30 / 18)
    V = np.column_stack([V[:, 0] - 10.0, V[:, 2], 15.0 - V[:, 1]])
    labels = np.where(V[:, 2] > 5.0, BASE, np.where(V[:, 2] < -5.0, HANDLE, FREE)).astype(np.uint8)
    monkeypatch.setattr(file_jobs, "open_sample", lambda _: (Mesh(V, F, unit="cm"), labels))
    sample, quickly = SAMPLES["cloth"], {"convergence": Convergence(energy_tolerance=1e-4)}
    monkeypatch.setitem(SAMPLES, "cloth", replace(sample, settings={**sample.settings, **quickly}))


def paint(user, key, condition):
    """Paint a part by a condition, in the place of what it was."""
    user.key(key)
    user.key(KEY.Key_L, CONTROL)
    user.type(condition)
    user.key(KEY.Key_Return, CONTROL)


def fold_along(user):
    """Fold the cloth by the red ring, and paint it across for the next fold."""
    user.drag(*ring_way(user.window, 0, 180), modifiers=CONTROL)
    assert area_percent(user.window) == "100.000 %"
    once = user.window.session.store.state.frame.U
    assert once[:, 2].min() > -4.0, "one half lies over the other"
    paint(user, KEY.Key_B, "x < 25%")
    paint(user, KEY.Key_H, "x > 75%")
    user.key(KEY.Key_V, CONTROL | SHIFT)
    user.type("0, 2, 0")
    user.key(KEY.Key_Return)
    return once


@pytest.mark.night
def test_workbench_folds_a_cloth_and_paints_it_across_in_twelve_inputs(coarse_cloth, cloth):
    once, window = fold_along(cloth), cloth.window
    assert cloth.count <= 12
    labels = document(window).labels
    assert set(np.sign(once[labels == BASE, 0])) == {-1.0}
    assert set(np.sign(once[labels == HANDLE, 0])) == {1.0}
    assert window.canvas.tool is Tool.MOVE
    np.testing.assert_allclose(window.canvas.gizmo.frame.centre, [0.0, 2.0, 0.0])
    assert not len(crossings(once, document(window).mesh.F))
    typed = [text.removeprefix("type ") for text in cloth.inputs if text.startswith("type ")]
    page = (Path(__file__).parents[2] / "docs" / "tutorial.md").read_text(encoding="utf-8")
    assert [text for text in typed if f"`{text}`" not in page] == [], "the tutorial has the same"


@pytest.mark.night
def test_workbench_folds_a_cloth_twice_in_thirteen_inputs(cloth):
    fold_along(cloth)
    window, mesh = cloth.window, document(cloth.window).mesh
    cloth.drag(*ring_way(window, 2, 180), modifiers=CONTROL)
    assert cloth.count <= 13
    U = window.session.store.state.frame.U
    assert window.panel.area.activity.text() == "converged"
    assert U[:, 2].min() > -4.0
    assert U[:, 0].max() < 4.0, "a quarter is left of it"
    assert area_percent(window) == "100.000 %"
    assert not len(crossings(U, mesh.F))
    now, rest = face_areas(U, mesh.F), face_areas(mesh.V, mesh.F)
    assert np.abs(now / rest - 1.0).max() < 0.05
