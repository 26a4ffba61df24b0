"""Pictures of the view: what is in them, at any size, in files and on the clipboard."""

import meshes
import numpy as np
import pytest
from answering import once_asked
from driving import idle
from kept_window import widened
from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QColor, QGuiApplication, QImage, QPainter
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.presentation.scales import Measure
from apd_viewer.session.model.state import initial_state
from apd_viewer.ui.filing import file_dialogs
from apd_viewer.ui.scene.scene_picture import picture_scale, scene_picture
from apd_viewer.ui.sharing.picture_dialog import PictureDialog, PictureSettings

SIZE = QSize(400, 300)


@pytest.fixture
def window(kept_window):
    """The window of all tests of the file."""
    return kept_window


def pixels(image):
    """(h, w, 4) uint8, colours not weighted by what they cover."""
    image = image.convertToFormat(QImage.Format.Format_RGBA8888)
    rows = np.frombuffer(image.constBits(), dtype=np.uint8).reshape(image.height(), image.bytesPerLine())
    return rows[:, : 4 * image.width()].reshape(image.height(), image.width(), 4).astype(int)


def box(covered):
    """Where something is: its left and right, upper and lower ends."""
    rows, columns = np.flatnonzero(covered.any(axis=1)), np.flatnonzero(covered.any(axis=0))
    return np.array([columns[0], columns[-1] + 1, rows[0], rows[-1] + 1])


def inner(covered):
    """What is covered with all around it."""
    kept = covered.copy()
    for axis in (0, 1):
        for way in (-2, -1, 1, 2):
            kept &= np.roll(covered, way, axis)
    return kept


@pytest.fixture
def still(qtbot, window):
    """A window on a coarse bottle, painted, with the gizmo at its neck."""
    V, F, labels = meshes.sample_bottle(2.2)
    state = initial_state(Mesh(V, F), frozen(labels.astype(np.uint8)))
    window.session.files.open_result("bottle", lambda: state)
    return widened(qtbot, window)


def test_scene_picture_has_the_colors_of_the_screen_and_empty_corners(still):
    view = still.canvas.viewport
    still.actions_.display.switches["shadow"].trigger()  # which is a texture, smoothed in two ways
    screen = np.asarray(view.screenshot(return_img=True)).astype(int)
    size = QSize(screen.shape[1], screen.shape[0])
    empty = pixels(scene_picture(view, size, transparent=True))
    assert (empty[[0, 0, -1, -1], [0, -1, 0, -1]] == 0).all()
    mesh = inner(empty[:, :, 3] == 255)
    assert mesh.mean() > 0.05
    differs = np.abs(empty[:, :, :3] - screen).max(axis=2)[mesh]
    assert np.percentile(differs, 99) <= 12, "but for edges within the shape, which are smoothed in two ways"
    assert np.median(differs) <= 1
    seen = pixels(scene_picture(view, size))
    away = ~inner(empty[:, :, 3] == 0)
    assert (seen[:, :, 3] == 255).all()
    assert np.abs(seen[:, :, :3] - screen).max(axis=2)[~away].max() <= 1


def test_scene_picture_has_edges_as_bright_as_what_they_cover(still):
    """No dark fringe: over a plain ground it is the same picture as one drawn on that."""
    view = still.canvas.viewport
    still.actions_.display.switches["shadow"].trigger()
    view.set_theme("#40c080")
    drawn = pixels(scene_picture(view, SIZE))[:, :, :3]
    empty = scene_picture(view, SIZE, transparent=True)
    ground = QImage(SIZE, QImage.Format.Format_RGBA8888)
    ground.fill(QColor("#40c080"))
    with QPainter(ground) as painter:
        painter.drawImage(0, 0, empty)
    assert np.abs(pixels(ground)[:, :, :3] - drawn).max() <= 3


@pytest.mark.parametrize("size", [(2400, 1800), (300, 900), (900, 200), (17, 16)])
def test_scene_picture_holds_all_that_is_seen_at_any_size(still, size):
    view, size = still.canvas.viewport, QSize(*size)
    ratio = view.devicePixelRatioF()
    own = box(pixels(scene_picture(view, view.size() * ratio, True))[:, :, 3] > 127) / ratio
    image = scene_picture(view, size, transparent=True)
    assert image.size() == size
    scale = picture_scale(view.size(), size)
    middle = np.repeat([size.width() / 2, size.height() / 2], 2)
    expected = middle + scale * (own - np.repeat([view.width() / 2, view.height() / 2], 2))
    assert np.abs(box(pixels(image)[:, :, 3] > 127) - expected).max() <= 1.5 + scale


def test_scene_picture_has_the_stripes_of_what_is_painted_where_the_view_has_them(qtbot, still):
    """Also in a picture of another size."""
    view = still.canvas.viewport
    still.display_options.overlay.choose_measure(Measure.AREA)
    qtbot.waitUntil(lambda: still.display_options.overlay.reading.values is not None)
    seen = scene_picture(view, view.size(), transparent=True)
    for times in (2.0, 0.5):
        size = view.size() * times
        scaled = seen.scaled(size, mode=Qt.TransformationMode.SmoothTransformation)
        picture, same = pixels(scene_picture(view, size, transparent=True)), pixels(scaled)
        inside = inner(same[:, :, 3] == 255)
        orange = inside & (same[:, :, 0] - same[:, :, 2] > 60)
        assert orange.sum() > 0.005 * inside.sum()
        assert np.abs(picture - same)[orange].mean() < 12


def test_scene_picture_leaves_the_screen_as_it_is(still):
    view = still.canvas.viewport
    before, size, angle = (
        view.screenshot(return_img=True),
        view.ren_win.GetSize(),
        view.camera_controller.camera.angle,
    )
    still.canvas.surface.shows_edges = True
    edged = view.screenshot(return_img=True)
    for transparent in (True, False):
        scene_picture(view, QSize(321, 654), transparent)
    assert np.array_equal(view.screenshot(return_img=True), edged)
    still.canvas.surface.shows_edges = False
    assert np.array_equal(view.screenshot(return_img=True), before)
    assert (view.ren_win.GetSize(), view.camera_controller.camera.angle) == (size, angle)


def test_scene_picture_refuses_a_size_that_is_too_large_in_a_sentence(still, tmp_path):
    view = still.canvas.viewport
    with pytest.raises(InputError, match=r"up to [\d,]+ pixels per side on this computer"):
        scene_picture(view, QSize(1_000_000, 10))
    with pytest.raises(InputError, match="up to 200 million pixels"):
        scene_picture(view, QSize(15_000, 15_000))
    before = view.screenshot(return_img=True)
    still.reports.pictures.save(tmp_path / "huge.png", PictureSettings(QSize(1_000_000, 10)))
    assert "choose a smaller one" in still.notice.text
    assert not (tmp_path / "huge.png").exists()
    assert np.array_equal(view.screenshot(return_img=True), before)


def test_pictures_save_writes_the_picture_into_a_file(qtbot, still, tmp_path):
    wish = PictureSettings(SIZE, transparent=True, gizmo=True)
    still.reports.pictures.save(tmp_path / "p.png", wish)
    idle(qtbot, still)
    assert still.notice.text == "Saved p.png: 400 × 300 pixels."
    assert still.notice.open_file.isVisible()
    image = QImage(str(tmp_path / "p.png"))
    assert image.size() == SIZE
    taken = pixels(still.reports.pictures.picture(wish))
    close = np.abs(pixels(image) - taken)[taken[:, :, 3] == 255]
    assert close.max() <= 1
    assert (pixels(image)[:, :, 3] == taken[:, :, 3]).all()


def test_pictures_save_tells_of_a_file_that_cannot_be_written_in_a_sentence(qtbot, still, tmp_path):
    (tmp_path / "file").write_text("no folder")
    still.reports.pictures.save(tmp_path / "file" / "p.png", PictureSettings(SIZE))
    qtbot.waitUntil(lambda: "cannot be written" in still.notice.text)
    assert (tmp_path / "file").read_text() == "no folder"


def test_pictures_have_the_gizmo_where_it_stands_on_the_screen(still):
    pictures, canvas = still.reports.pictures, still.canvas
    assert pictures.has_gizmo
    for size in (SIZE, QSize(300, 700)):
        bare, drawn = (
            pixels(pictures.picture(PictureSettings(size, True, gizmo=on))) for on in (False, True)
        )
        changed = np.abs(bare - drawn).max(axis=2) > 40
        scale, view = picture_scale(canvas.viewport.size(), size), canvas.viewport
        frame = canvas.gizmo.frame
        ring = np.concatenate([frame.ring(axis)[0] for axis in range(3)])
        middle = np.array([size.width(), size.height()]) / 2
        ring = middle + scale * (ring - np.array([view.width(), view.height()]) / 2)
        low, high = box(changed)[[0, 2]], box(changed)[[1, 3]]
        assert (low <= ring.min(axis=0) + 2).all()
        assert (high >= ring.max(axis=0) - 2).all()
        x, y = ring.astype(int).T
        assert changed[y, x].mean() > 0.5


def test_pictures_can_have_the_gizmo_of_an_obstacle(qtbot, still):
    still.actions_.simulate.obstacles.floor.trigger()
    idle(qtbot, still)
    assert still.obstacles.gizmo.visible
    assert not still.canvas.gizmo.visible
    pictures = still.reports.pictures
    assert pictures.has_gizmo
    bare, drawn = (pixels(pictures.picture(PictureSettings(SIZE, True, gizmo=on))) for on in (False, True))
    arrow = still.obstacles.gizmo.frame.arrow(2)[1]
    view = still.canvas.viewport
    x, y = np.array([200, 150]) + picture_scale(view.size(), SIZE) * (
        arrow - np.array([view.width(), view.height()]) / 2
    )
    around = np.abs(bare - drawn)[int(y) - 5 : int(y) + 6, int(x) - 5 : int(x) + 6]
    assert around.max() > 40


def test_pictures_have_a_legend_in_the_colors_of_the_overlay(qtbot, still):
    pictures, heat = still.reports.pictures, still.display_options.overlay
    size = still.canvas.viewport.size()
    assert not pictures.has_legend
    plain = pixels(pictures.picture(PictureSettings(size, True)))
    assert plain[-20, 20, 3] == 0
    still.display_options.overlay.choose_measure(Measure.DISPLACEMENT)
    qtbot.waitUntil(lambda: heat.reading.span is not None, timeout=30_000)
    assert pictures.has_legend
    image = pixels(pictures.picture(PictureSettings(size, True)))
    corner = image[-90:, :290]
    assert (corner[:, :, 3] == 255).mean() > 0.7
    for color in heat.scale.colors(np.array([0.1, 0.5, 0.9])):
        away = np.abs(corner[:, :, :3] - color.astype(float)).max(axis=2)
        assert away.min() <= 6, color
    assert (pixels(pictures.picture(PictureSettings(size, True, legend=False)))[-20, 20] == 0).all()


def test_pictures_copy_puts_the_view_on_the_clipboard(qtbot, still):
    QGuiApplication.clipboard().clear()
    still.shell.activateWindow()
    qtbot.waitUntil(still.shell.isActiveWindow)
    still.canvas.viewport.setFocus()
    modifiers = Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier
    QTest.keyClick(still.canvas.viewport, Qt.Key.Key_C, modifiers)
    view = still.canvas.viewport
    qtbot.waitUntil(lambda: not QGuiApplication.clipboard().image().isNull())
    image = QGuiApplication.clipboard().image()
    assert image.size() == view.size() * view.devicePixelRatioF()
    assert np.abs(pixels(image) - pixels(scene_picture(view, image.size()))).max() <= 1
    assert still.notice.text.startswith("Copied a picture of")


@pytest.fixture
def dialog(qtbot, still):
    dialog = PictureDialog(
        still.shell, still.reports.pictures, PictureSettings(still.reports.pictures.view_size * 2)
    )
    dialog.show()
    qtbot.waitExposed(dialog)
    yield dialog
    dialog.reject()
    dialog.deleteLater()
    QApplication.processEvents()


def test_picture_dialog_knows_multiples_of_the_view_and_own_sizes(dialog, still):
    view = still.reports.pictures.view_size
    assert dialog.times.currentText() == "2 × the view"
    dialog.times.setCurrentIndex(2)
    dialog.times.activated.emit(2)
    assert dialog.settings.size == view * 3
    dialog.width_.setValue(640)
    assert dialog.times.currentText() == "Custom size"
    assert dialog.settings.size == QSize(640, 3 * view.height())
    dialog.width_.setValue(view.width())
    dialog.height_.setValue(view.height())
    assert dialog.times.currentText() == "Same as view"


def test_picture_dialog_shows_what_the_picture_will_be(qtbot, dialog):
    assert not dialog.legend.isEnabled()
    assert dialog.gizmo.isEnabled()
    assert dialog.preview.image.pixelColor(0, 0).alpha() == 255
    QTest.mouseClick(dialog.transparent, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: dialog.preview.image.pixelColor(0, 0).alpha() == 0)
    assert dialog.settings.transparent
    wide, high = dialog.preview.image.width(), dialog.preview.image.height()
    assert wide / high == pytest.approx(
        dialog.settings.size.width() / dialog.settings.size.height(), rel=0.02
    )
    QTest.mouseClick(dialog.copy, Qt.MouseButton.LeftButton)
    copied = QGuiApplication.clipboard().image()
    assert copied.size() == dialog.settings.size
    assert copied.pixelColor(0, 0).alpha() == 0


def test_picture_dialog_says_what_size_cannot_be_had(qtbot, dialog):
    for field in (dialog.width_, dialog.height_):
        field.setValue(16_000)
    qtbot.waitUntil(dialog.problem.isVisible)
    assert "choose a smaller one" in dialog.problem.text()
    assert not dialog.save.isEnabled()
    assert not dialog.copy.isEnabled()
    dialog.height_.setValue(300)
    qtbot.waitUntil(lambda: not dialog.problem.isVisible())
    assert dialog.save.isEnabled()


def test_ask_for_picture_leads_from_the_menu_to_the_file(qtbot, still, tmp_path, monkeypatch):
    path, seen = tmp_path / "picture.png", []
    monkeypatch.setattr(file_dialogs, "ask_where_to_save_picture", lambda *_: path)

    def answer():
        dialog = QApplication.activeModalWidget()
        seen.append(dialog)
        dialog.times.setCurrentIndex(0)
        dialog.times.activated.emit(0)
        dialog.save.click()

    once_asked(answer)
    still.actions_.file.picture.trigger()
    idle(qtbot, still)
    assert isinstance(seen[0], PictureDialog)
    assert QImage(str(path)).size() == still.reports.pictures.view_size


def test_report_controller_has_nothing_to_hand_out_before_there_is_a_mesh(window):
    for action in (
        window.actions_.file.report,
        window.actions_.file.picture,
        window.actions_.file.copy_picture,
    ):
        assert not action.isEnabled()
    window.reports.ask_for_report()
    window.reports.ask_for_picture()


def test_copy_python_script_copies_the_lines_and_tells_so(qtbot, bottle):
    bottle.actions_.file.copy_python.trigger()
    lines = QGuiApplication.clipboard().text()
    compile(lines, "copied", "exec")
    assert "bottle.obj" in lines
    assert bottle.notice.text == "Copied the Python lines that repeat this deformation."
