"""Picture on a region, on the screen: upright, not mirrored, carried along, under overlays, and removed."""

import base64
import io
import re
import threading
import time
from dataclasses import replace

import numpy as np
import pytest
from driving import document, idle, settle
from meshes import rotation, tube
from PIL import Image

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE
from apd_viewer.presentation.scales import Measure
from apd_viewer.session.storage.session_file import open_session, save_session
from apd_viewer.ui.filing import file_dialogs
from apd_viewer.ui.overlays import region_picture
from apd_viewer.ui.scene.scene_picture import scene_picture
from apd_viewer.ui.scene.surface_shading import Finish

# Upper left, upper right, lower left, lower right.
RED, GREEN, BLUE, YELLOW = COLORS = np.array([[210, 30, 30], [30, 190, 60], [40, 60, 220], [230, 210, 40]])
V, F = tube(48, 24, height=4.0)
V = V[:, [1, 2, 0]] - (0.0, 2.0, 0.0)  # about the y axis, x to the right, z to the viewer
BAND = np.abs(V[:, 1]) < 1.05
HIGH = 2.0  # of the band


def at(angle, height):
    """Point (3,) of the cylinder, by its angle from the front to the right."""
    return np.array([np.sin(angle), height, np.cos(angle)])


# In the middle of each quarter of a picture that is 1.6 wide and 2 high.
PLACES = np.array([at(x, y) for y in (0.5, -0.5) for x in (-0.4, 0.4)])


@pytest.fixture
def window(qtbot, kept_window):
    """The window on a cylinder with a band as region, seen from the front."""
    session = kept_window.session
    session.files.open_mesh(Mesh(V, F))
    idle(qtbot, kept_window)
    kept_window.parts.add_region()
    session.gestures.begin()
    session.painting.paint_region(np.flatnonzero(BAND), 1)
    session.painting.end_stroke("Paint")
    kept_window.canvas.viewport.camera_controller.show_standard_view("front")
    kept_window.canvas.frame_mesh()
    return kept_window


def image(folder, ratio=0.8, opacity=255):
    """PNG with a colour in each quarter."""
    path, high = folder / f"label-{ratio:.3f}-{opacity}.png", 400
    rows = np.full((high, round(ratio * high), 4), opacity, dtype=np.uint8)
    for k, color in enumerate(COLORS):
        rows[k // 2 * high // 2 :, k % 2 * rows.shape[1] // 2 :, :3] = color
    Image.fromarray(rows).save(path)
    return path


def lay(qtbot, window, monkeypatch, path):
    monkeypatch.setattr(file_dialogs, "ask_for_image", lambda *_: path)
    window.actions_.display.pictures[0].trigger()
    idle(qtbot, window)


def picture(qtbot, window):
    settle(qtbot, window.canvas.viewport)
    return window.canvas.viewport.screenshot(return_img=True)[:, :, :3].astype(float)


def seen(qtbot, window, places):
    """Colours on the screen at places (k, 3)."""
    view, drawn = window.canvas.viewport, picture(qtbot, window)
    x, y = (view.camera_controller.camera.project(places) * drawn.shape[1] / view.width()).astype(int).T
    return drawn[y, x]


def check_colors(found, expected, atol=0.15):
    """Colours but for their brightness."""
    found, expected = (c / c.max(axis=-1, keepdims=True) for c in (found, np.asarray(expected, float)))
    np.testing.assert_allclose(found, expected, atol=atol)


def test_region_picture_is_upright_and_not_mirrored(qtbot, window, monkeypatch, tmp_path):
    lay(qtbot, window, monkeypatch, image(tmp_path))
    check_colors(seen(qtbot, window, PLACES), COLORS)
    # Beside the picture and above it the region has no colour any more.
    beside = seen(qtbot, window, np.array([at(1.0, 0.5), at(-1.0, -0.5), at(0.0, 1.4)]))
    assert np.ptp(beside, axis=1).max() < 15
    view = window.canvas.viewport
    saved = scene_picture(view, 2 * view.size(), transparent=True)
    places = (2 * view.camera_controller.camera.project(PLACES)).astype(int)
    check_colors(np.array([saved.pixelColor(x, y).getRgb()[:3] for x, y in places.tolist()]), COLORS)


def test_region_picture_goes_around_with_its_seam_at_the_back(qtbot, window, monkeypatch, tmp_path):
    lay(qtbot, window, monkeypatch, image(tmp_path, 2.0 * np.pi / HIGH))
    check_colors(seen(qtbot, window, PLACES), COLORS)
    window.canvas.viewport.camera_controller.show_standard_view("-front")
    window.canvas.frame_mesh()
    back = [at(np.pi + x, y) for y in (0.5, -0.5) for x in (-0.4, 0.4)]
    check_colors(seen(qtbot, window, np.array(back)), [GREEN, RED, YELLOW, BLUE])


def test_region_picture_follows_a_twist(qtbot, window, monkeypatch, tmp_path):
    lay(qtbot, window, monkeypatch, image(tmp_path))
    surface = window.canvas.surface
    uv = np.array(surface.arrays.data.point_data["uv"])

    def twisted(X):
        return np.array([rotation((0, 1, 0), 0.5 * x[1]) @ x for x in X]) * (1.1, 0.9, 1.0)

    surface.set_points(twisted(V))
    window.canvas.viewport.camera_controller.frame(surface.U)
    check_colors(seen(qtbot, window, twisted(PLACES)), COLORS)
    np.testing.assert_array_equal(surface.arrays.data.point_data["uv"], uv)


def test_region_picture_is_gone_when_it_is_removed(qtbot, window, monkeypatch, tmp_path):
    before, (_, remove) = picture(qtbot, window), window.actions_.display.pictures
    assert not remove.isEnabled()
    for opacity in (255, 100):
        lay(qtbot, window, monkeypatch, image(tmp_path, opacity=opacity))
        assert np.abs(picture(qtbot, window) - before).max() > 50
        assert remove.isEnabled()
        remove.trigger()
        np.testing.assert_array_equal(picture(qtbot, window), before)
        assert not remove.isEnabled()


def test_region_picture_shows_the_mesh_where_it_is_transparent(qtbot, window, monkeypatch, tmp_path):
    lay(qtbot, window, monkeypatch, image(tmp_path, opacity=0))
    bare = seen(qtbot, window, PLACES)
    assert np.ptp(bare, axis=1).max() < 15
    lay(qtbot, window, monkeypatch, image(tmp_path))
    full = seen(qtbot, window, PLACES)
    lay(qtbot, window, monkeypatch, image(tmp_path, opacity=128))
    np.testing.assert_allclose(seen(qtbot, window, PLACES), (bare + full) / 2, atol=6)


@pytest.mark.parametrize(
    "finish",
    [
        Finish.CLAY,
        *(pytest.param(each, marks=pytest.mark.night) for each in Finish if each is not Finish.CLAY),
    ],
)
def test_region_picture_is_seen_in_every_finish_and_on_dark(qtbot, window, monkeypatch, tmp_path, finish):
    lay(qtbot, window, monkeypatch, image(tmp_path))
    window.actions_.display.finishes[finish].trigger()
    for scheme in window.actions_.view.schemes.values():
        scheme.trigger()
        found = seen(qtbot, window, PLACES)
        assert np.corrcoef(found.ravel(), COLORS.ravel())[0, 1] > 0.8
    window.actions_.display.finishes[Finish.CLAY].trigger()


def test_region_picture_lies_under_overlays_and_paint(qtbot, window, monkeypatch, tmp_path):
    display = window.actions_.display
    display.measures[Measure.AREA].trigger()
    qtbot.waitUntil(lambda: window.canvas.surface.color_map is not None)
    lay(qtbot, window, monkeypatch, image(tmp_path))
    assert "No overlay" in window.notice.text
    assert np.ptp(seen(qtbot, window, PLACES), axis=1).max() < 15
    display.no_overlay.trigger()
    check_colors(seen(qtbot, window, PLACES), COLORS)
    window.session.gestures.begin()
    window.session.painting.paint(np.flatnonzero((V[:, 0] < -0.1) & (V[:, 2] > 0)), BASE)
    window.session.painting.end_stroke("Paint")
    found = seen(qtbot, window, PLACES)
    check_colors(found[[1, 3]], [GREEN, YELLOW])
    assert np.abs(found[0] - found[2]).max() < 25
    window.edits.undo()
    check_colors(seen(qtbot, window, PLACES), COLORS)


def test_region_picture_stays_on_a_baked_shape_and_goes_with_the_mesh(qtbot, window, monkeypatch, tmp_path):
    lay(qtbot, window, monkeypatch, image(tmp_path))
    window.session.shapes.bake()
    idle(qtbot, window)
    check_colors(seen(qtbot, window, PLACES), COLORS)
    _, remove = window.actions_.display.pictures
    assert remove.isEnabled()
    window.session.files.open_mesh(Mesh(0.5 * V[: len(V)], F[:-1]))
    idle(qtbot, window)
    assert not remove.isEnabled()
    assert window.canvas.surface.texture is None
    assert np.ptp(seen(qtbot, window, 0.5 * PLACES), axis=1).max() < 15


def test_region_picture_comes_back_with_its_mesh(qtbot, window, monkeypatch, tmp_path):
    lay(qtbot, window, monkeypatch, image(tmp_path))
    laid = window.view().image
    window.session.files.open_mesh(Mesh(*tube(12, 6)))
    idle(qtbot, window)
    assert window.view().image is None
    window.edits.undo()
    idle(qtbot, window)
    assert window.view().image is laid
    check_colors(seen(qtbot, window, PLACES), COLORS)
    window.edits.redo()
    idle(qtbot, window)
    assert window.canvas.surface.texture is None


def test_region_picture_is_work_to_be_saved(qtbot, window, monkeypatch, tmp_path):
    saved = tmp_path / "bare.apd"

    def is_modified():
        return window.shell.isWindowModified()

    def save():
        window.session.files.save(saved, window.view(), embed=True)
        idle(qtbot, window)

    save()
    assert not is_modified()
    lay(qtbot, window, monkeypatch, image(tmp_path))
    assert is_modified()
    save()
    assert not is_modified()
    window.actions_.display.pictures[1].trigger()
    assert is_modified()
    window.session.files.open(saved)
    qtbot.waitUntil(lambda: window.canvas.surface.texture is not None)
    assert not is_modified()


@pytest.mark.parametrize("does", ["cancel", "remove"])
def test_region_picture_is_kept_if_reading_is_cancelled_and_not_if_it_is_removed(
    qtbot, window, monkeypatch, tmp_path, does
):
    lay(qtbot, window, monkeypatch, image(tmp_path))
    saved, read = tmp_path / "labelled.apd", threading.Event()
    window.session.files.save(saved, window.view(), embed=True)
    idle(qtbot, window)
    content = window.view().image.content
    read_picture = region_picture.read_picture
    monkeypatch.setattr(region_picture, "read_picture", lambda *a: read.wait() and read_picture(*a))
    window.session.files.open(saved)
    jobs = window.session.jobs
    qtbot.waitUntil(lambda: jobs.current is not None and jobs.current.title.startswith("Reading"))
    if does == "cancel":
        jobs.cancel()
    else:
        window.actions_.display.pictures[1].trigger()
    read.set()
    idle(qtbot, window)
    assert window.canvas.surface.texture is None
    if does == "cancel":
        assert window.view().image.content == content
    else:
        assert window.view().image is None


def test_region_picture_asks_for_a_region_and_for_an_image(qtbot, window, monkeypatch, tmp_path):
    before, bad = picture(qtbot, window), tmp_path / "bad.png"
    bad.write_bytes(b"no image")
    lay(qtbot, window, monkeypatch, bad)
    assert "bad.png is no image" in window.notice.text
    monkeypatch.setattr(file_dialogs, "ask_for_image", lambda *_: None)
    window.actions_.display.pictures[0].trigger()
    window.notice.hide()
    np.testing.assert_array_equal(picture(qtbot, window), before)
    window.edits.undo()
    assert not document(window).member.any()
    lay(qtbot, window, monkeypatch, image(tmp_path))
    assert window.notice.text.startswith("Paint a region first")
    assert window.canvas.surface.texture is None


def test_region_picture_costs_no_more_than_a_few_draws_without_it(qtbot, window, monkeypatch, tmp_path):
    """Some filters of a texture take fifty times as long as all else where the processor draws."""

    def seconds():
        settle(qtbot, window.canvas.viewport)
        taken = []
        for _ in range(5):
            window.canvas.viewport.update()
            begun = time.perf_counter()
            window.canvas.viewport.ren_win.Render()
            taken.append(time.perf_counter() - begun)
        return min(taken)

    without = seconds()
    lay(qtbot, window, monkeypatch, image(tmp_path))
    assert seconds() < 8.0 * without


def test_region_picture_is_kept_by_a_session_with_its_file_and_place(qtbot, window, monkeypatch, tmp_path):
    path = image(tmp_path)
    lay(qtbot, window, monkeypatch, path)
    content, saved = path.read_bytes(), tmp_path / "labelled.apd"
    window.session.files.save(saved, window.view(), embed=True)
    idle(qtbot, window)
    path.unlink()
    window.session.files.open_mesh(Mesh(*tube(12, 6)))
    idle(qtbot, window)
    assert window.region_picture.image is None
    window.session.files.open(saved)
    qtbot.waitUntil(lambda: window.region_picture.image is not None)
    idle(qtbot, window)
    kept = window.region_picture.image
    assert (kept.name, kept.content) == (path.name, content)
    np.testing.assert_array_equal(kept.inside, BAND)
    check_colors(seen(qtbot, window, PLACES), COLORS)
    state, view = open_session(saved)
    without = replace(view, image=None)
    save_session(saved, state, without, embed=True)
    assert open_session(saved)[1] == without, "as in sessions of before"


def test_region_picture_too_large_for_sessions_says_so(qtbot, window, monkeypatch, tmp_path):
    path = image(tmp_path)
    monkeypatch.setattr(region_picture, "LARGEST_IMAGE", path.stat().st_size - 1)
    lay(qtbot, window, monkeypatch, path)
    check_colors(seen(qtbot, window, PLACES), COLORS)
    assert "sessions do not keep it" in window.notice.text
    assert window.view().image is None


def test_region_picture_is_in_the_pictures_of_a_report(qtbot, window, monkeypatch, tmp_path):
    lay(qtbot, window, monkeypatch, image(tmp_path))
    window.reports.write_report(tmp_path / "report.html")
    idle(qtbot, window)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    pictures = re.findall(r"data:image/png;base64,([A-Za-z0-9+/=]+)", page)
    rest, current, colored = (
        np.array(Image.open(io.BytesIO(base64.b64decode(one))).convert("RGB")).reshape(-1, 3).astype(float)
        for one in pictures[:3]
    )
    for drawn in (rest, current):
        shades = drawn / np.maximum(drawn.max(axis=1, keepdims=True), 1.0)
        for color in COLORS:
            assert (np.abs(shades - color / color.max()).max(axis=1) < 0.15).mean() > 0.01
    assert np.ptp(colored, axis=1).max() < 60, "nothing has changed its area"
