"""Shading with the normals of the file: chosen by itself, and seen."""

import numpy as np
from driving import idle, settle
from meshes import grid

from apd_viewer.ui.scene.surface_shading import Shading


def sheet(path, tilt):
    """Write a square with normals tilted to one side, or with none."""
    V, F = grid(4, 4)
    rows = [f"v {x} {y} {z}" for x, y, z in V]
    if tilt:
        rows += ["vn 0.9 -0.8 0.1"]
    rows += ["f " + " ".join(f"{v}//1" if tilt else f"{v}" for v in face) for face in F + 1]
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return path


def brightness(qtbot, window):
    """Of the middle of the view, from the front."""
    view = window.canvas.viewport
    view.camera_controller.show_standard_view("front")
    window.canvas.frame_mesh()
    settle(qtbot, view)
    picture = view.screenshot(return_img=True)
    height, width = picture.shape[:2]
    return float(picture[height // 2 - 5 : height // 2 + 5, width // 2 + 20 : width // 2 + 30, :3].mean())


def test_shading_is_by_the_normals_of_a_file_that_has_them(qtbot, window, tmp_path):
    shadings = window.actions_.view.shadings
    window.files.open_path(sheet(tmp_path / "plain.obj", tilt=False))
    idle(qtbot, window)
    assert not shadings[Shading.FILE].isEnabled()
    assert shadings[Shading.FILE].toolTip() == "The file has no normals"
    assert shadings[Shading.SHARP].isChecked()
    plain = brightness(qtbot, window)
    window.files.open_path(sheet(tmp_path / "tilted.obj", tilt=True))
    idle(qtbot, window)
    assert shadings[Shading.FILE].isEnabled()
    assert shadings[Shading.FILE].isChecked()
    tilted = brightness(qtbot, window)
    assert abs(tilted - plain) > 8.0
    turned = np.array(window.session.store.state.frame.U) @ np.diag([-1.0, -1.0, 1.0])
    window.canvas.surface.set_points(turned)
    assert abs(brightness(qtbot, window) - tilted) > 8.0
    shadings[Shading.SHARP].trigger()
    assert abs(brightness(qtbot, window) - plain) < 2.0
