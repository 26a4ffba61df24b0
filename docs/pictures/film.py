"""The film of the manual: open, paint, twist, read, press, go back and export, in the real window."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from unittest.mock import patch

import ink
import numpy as np
from driven_window import LEFT, NONE
from film_files import Part, check_encoder, reel, write_gif, write_webm
from film_recorder import Recorder
from picture_files import write_picture
from PySide6.QtCore import QMimeData, QPointF, Qt, QUrl
from PySide6.QtGui import QDropEvent, QImage
from stage import Stage

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.geometry.warmup import warm_up
from apd_viewer.presentation.scales import Measure
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.filing import file_dialogs
from apd_viewer.ui.scene.surface_shading import Finish
from apd_viewer.ui.tools.tool_modes import SelectionMode, Tool

_NAME = "bottle.obj"
_BASE, _NECK = (0.0, 1.2, 3.0), (0.0, 18.7, 1.5)  # cm, on the bottle: where its ends begin
_ROOM = 68.0  # px around the bottle, for its gizmo
_ALONG_PLATES = 0.2, 0.2, 1.0  # to where the camera stands while they close
_END = 50  # percent of its width, between the plates
_STEPS, _QUICK_STEPS, _SECONDS = 105, 2, 7.0  # of the press, in the film


def write_film(stage: Stage, folder: Path) -> None:
    """Write the film, the picture that stands for it, and two of its parts as GIF."""
    check_encoder()
    warm_up()  # or the window would say that it compiles
    exact = stage.folder / "film.mkv"
    with reel(exact) as taken:
        recorder, poster = film(stage, taken.take)
    write_picture(_with_sign(poster), folder / "film.webp")
    write_webm(exact, folder / "film.webm")
    write_gif(
        exact, folder / "film.gif", [Part(*recorder.chapters[name], 4.0) for name in ("twist", "press")]
    )


def _with_sign(poster: QImage) -> QImage:
    scale = poster.devicePixelRatio()
    with ink.begun(poster) as painter:
        ink.draw_play_sign(painter, QPointF(poster.width(), poster.height()) / (2 * scale))
    return poster


def film(stage: Stage, take: Callable[[QImage, int], object]) -> tuple[Recorder, QImage]:
    """Drive the window through all scenes; the recorder, and the picture that stands for the film."""
    recorder = Recorder(stage, take)
    _open(recorder)
    _paint(recorder)
    _twist(recorder)
    _look_at_area(recorder)
    poster = _press(recorder)
    _go_back(recorder)
    _export(recorder)
    return recorder, poster


def _open(recorder: Recorder) -> None:
    """A file is dropped on the empty window."""
    stage, window = recorder.stage, recorder.stage.window
    path = stage.folder / _NAME
    mesh, _ = stage.sample("bottle")
    save_mesh(mesh, mesh.V, path)
    shell, middle = window.shell, QPointF(stage.view.rect().center())
    recorder.pointer = QPointF(shell.width() * 0.06, shell.height() - 40.0)
    recorder.say("Open a mesh: drop it on the window")
    recorder.carry(_NAME)
    recorder.hold(0.7)
    recorder.glide(middle + QPointF(-30, 70), 1.6)
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(path))])
    shell.dropEvent(QDropEvent(recorder.pointer, Qt.DropAction.CopyAction, data, LEFT, NONE))
    stage.wait(lambda: window.session.store.state is not None)
    window.choose_unit(Unit.CENTIMETRE)
    window.canvas.viewport.camera_controller.frame(stage.state.document.mesh.V, _ROOM)
    recorder.carry("")
    recorder.rest()
    recorder.hold(1.3)


def _paint(recorder: Recorder) -> None:
    """Base and handle are what lies between planes."""
    window = recorder.stage.window
    recorder.say("Paint what stays in place", "B")
    recorder.click(recorder.button(window.actions_.select.modes[SelectionMode.SLAB]))
    _paint_beyond(recorder, _BASE, 60.0)
    recorder.say("Paint the part to move", "H")
    recorder.click(recorder.button(window.actions_.tools[Tool.HANDLE]))
    _paint_beyond(recorder, _NECK, -80.0)


def _paint_beyond(recorder: Recorder, place: tuple[float, float, float], down: float) -> None:
    stage = recorder.stage
    begin = stage.at(stage.near(place))
    recorder.glide(begin, 0.9, hovers=True)
    recorder.drag([begin, begin + QPointF(6.0, down)], 1.2)
    recorder.hold(0.5)


def _twist(recorder: Recorder) -> None:
    """The green ring is dragged; then the mouse shows the area."""
    stage, window = recorder.stage, recorder.stage.window
    recorder.say("Drag the handle: the area stays 100 %", "M")
    recorder.click(recorder.button(window.actions_.tools[Tool.MOVE]))
    way = stage.along_ring(1, 0.08, 0.92, 41)
    recorder.glide(way[0], 0.8, hovers=True)
    with recorder.chapter("twist"):
        recorder.drag(way, 7.0)
    recorder.hold(0.4)
    area = window.panel.area
    recorder.glide(area, 0.9)
    recorder.mark(area, margin=-3.0)
    recorder.hold(1.6)
    recorder.mark()


def _look_at_area(recorder: Recorder) -> None:
    """Colours of the local change, and what it is under the mouse; then undo."""
    stage = recorder.stage
    recorder.say("See where the surface grows and shrinks", "Alt+1")
    stage.overlay(Measure.AREA)
    recorder.refresh()
    recorder.hold(0.8)
    U = stage.state.frame.U
    for share in (0.8, 0.45):
        place = [0.0, share * U[:, 1].max(), U[:, 2].max()]
        recorder.glide(stage.at(int(np.argmin(np.linalg.norm(U - place, axis=1)))), 1.3, hovers=True)
        recorder.hold(0.4)
    recorder.hold(0.3)
    recorder.say("Undo: every drag is one step", "Ctrl+Z")
    stage.overlay(None)
    recorder.refresh()
    recorder.click(recorder.button(stage.window.actions_.undo))
    recorder.hold(0.8)


def _press(recorder: Recorder) -> QImage:
    """Two plates close, and the curves grow; the picture of their end."""
    stage, window = recorder.stage, recorder.stage.window
    panel, player = window.press.panel, window.session.player
    count = _QUICK_STEPS if stage.quick else _STEPS
    panel.steps.setValue(count)
    panel.end.setText(f"{_END} %")
    recorder.say("Press between plates: load and volume, live", "Shift+K")
    window.display_options.choose_finish(Finish.PET)
    recorder.click(recorder.button(window.actions_.simulate.press_live))
    window.notice.hide()
    stage.look(*_ALONG_PLATES, 8.0)
    recorder.refresh()
    recorder.hold(0.8)
    recorder.click(panel.press, rests=False)
    with recorder.chapter("press"):
        for step in range(1, count + 1):
            stage.wait(lambda step=step: player.done >= step or not player.is_playing)
            recorder.refresh()
            recorder.hold(_SECONDS / count)
    if player.done < count:
        raise RuntimeError("The plates did not come to their end.")
    recorder.rest()
    recorder.hold(0.4)
    rows = [row for row in panel.reading_rows if row[0].isVisible()]
    recorder.glide(rows[-1][1], 0.8)
    recorder.mark(*(label for row in rows for label in row))
    poster = recorder.picture()
    recorder.hold(1.5)
    recorder.mark()
    return poster


def _go_back(recorder: Recorder) -> None:
    """The knob of the timeline is dragged almost to the beginning and back."""
    slider = recorder.stage.window.press.panel.slider
    last = slider.maximum()
    recorder.say("Go back to any step")
    places = [QPointF(slider.knob_position(k), slider.height() / 2) for k in (last, round(0.1 * last), last)]
    recorder.glide(places[0], 0.8, widget=slider)
    recorder.slide(slider, places, 1.7)
    recorder.hold(0.3)


def _export(recorder: Recorder) -> None:
    """The steps are exported as an animation."""
    stage, window = recorder.stage, recorder.stage.window
    path = stage.folder / "bottle-pressed.glb"
    recorder.say("Export meshes, curves, animations, a report")
    with patch.object(file_dialogs, "ask_for_format", lambda *_: path):
        recorder.click(window.press.panel.export)
    stage.wait(lambda: window.notice.text != "")
    recorder.refresh()
    recorder.hold(2.4)
