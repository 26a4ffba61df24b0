"""Thumbnails: of sessions their own picture, of meshes a drawing, without OpenGL and without what deforms."""

import subprocess
import sys
import textwrap
from dataclasses import replace

import meshes
import numpy as np
import pytest
from PIL import Image

from apd_viewer.__main__ import main
from apd_viewer.files.mesh_writing import WRITABLE_FORMATS, save_mesh
from apd_viewer.files.picture_files import png_content
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.session.model.view import View
from apd_viewer.session.storage.session_file import save_session


def thumbnail(path, *more):
    """Pixels (h, w, 4) of the thumbnail of a file."""
    out = path.with_suffix(".thumbnail")  # file managers choose the name
    assert main(["thumbnail", str(path), str(out), *more]) == 0
    with Image.open(out) as image:
        assert image.format == "PNG"
        return np.array(image.convert("RGBA")).astype(int)


@pytest.fixture
def ball():
    V, F = meshes.sphere(2)
    return Mesh(V * [1.0, 2.0, 1.0], F)


@pytest.mark.parametrize("suffix", WRITABLE_FORMATS)
def test_thumbnail_command_draws_a_mesh_of_each_format(suffix, ball, tmp_path):
    path = tmp_path / f"ball{suffix}"
    save_mesh(ball, ball.V, path)
    pixels = thumbnail(path, "--size", "64")
    assert pixels.shape[0] == 64
    assert 30 < pixels.shape[1] < 40
    covered = pixels[..., 3] > 128
    box = covered.any(axis=0).sum() * covered.any(axis=1).sum()
    assert covered.sum() / box == pytest.approx(np.pi / 4, abs=0.03)  # an ellipse


def test_thumbnail_command_shows_the_picture_that_a_session_has(ball, tmp_path):
    picture = np.random.default_rng(0).integers(0, 256, (40, 50, 4), dtype=np.uint8)
    save_session(tmp_path / "a.apd", initial_state(ball), View(), picture=png_content(picture))
    np.testing.assert_array_equal(thumbnail(tmp_path / "a.apd"), picture)
    assert thumbnail(tmp_path / "a.apd", "--size", "25").shape == (20, 25, 4)


def test_thumbnail_command_draws_a_session_without_a_picture_in_its_shape_and_its_colors(ball, tmp_path):
    labels = np.where(ball.V[:, 1] < 0, 0, 1).astype(np.uint8)
    state = initial_state(ball, labels)
    wide = frozen(ball.V[:, [1, 0, 2]])
    save_session(tmp_path / "a.apd", replace(state, frame=replace(state.frame, U=wide)), View())
    pixels = thumbnail(tmp_path / "a.apd", "--size", "64")
    assert pixels.shape[1] == 64 > pixels.shape[0]
    left, right = (pixels[pixels.shape[0] // 2, column] for column in (16, 48))
    assert left[2] > 2 * left[0]  # blue, the base
    assert abs(right[2] - right[0]) < 20
    save_session(tmp_path / "b.apd", state, View(up_axis=UpAxis.PLUS_X))
    assert thumbnail(tmp_path / "b.apd", "--size", "64").shape[1] == 64


def test_thumbnail_command_says_what_cannot_be_drawn(ball, tmp_path, capsys, monkeypatch):
    (tmp_path / "bad.obj").write_text("nonsense")
    (tmp_path / "bad.apd").write_text("nonsense")
    (tmp_path / "note.txt").write_text("nonsense")
    save_mesh(ball, ball.V, tmp_path / "ball.stl")
    save_session(tmp_path / "odd.apd", initial_state(ball), View(), picture=b"nonsense")
    monkeypatch.setattr("apd_viewer.commands.desktop.thumbnail_command.MOST_BYTES", 1000)
    for name, said in (
        ("bad.obj", "bad.obj"),
        ("bad.apd", "bad.apd is not a valid session"),
        ("note.txt", "note.txt is not a supported file type"),
        ("gone.stl", "There is no file"),
        ("ball.stl", "ball.stl is too large for a thumbnail."),
        ("odd.apd", "odd.apd: its picture is damaged."),
    ):
        assert main(["thumbnail", str(tmp_path / name), str(tmp_path / "out.png")]) == 2
        error = capsys.readouterr().err
        assert error.startswith("error: ")
        assert said in error
    for size in ("15", "1025"):
        assert main(["thumbnail", str(tmp_path / "ball.stl"), "o.png", "--size", size]) == 2
        assert "--size is a number of pixels from 16 to 1,024." in capsys.readouterr().err
    assert not (tmp_path / "out.png").exists()


QUICK = """
    import sys
    from apd_viewer.__main__ import main
    assert main(["thumbnail", sys.argv[1], sys.argv[2]]) == 0
    loaded = {name.partition(".")[0] for name in sys.modules}
    assert "PIL" in loaded, "the test is blind"
    assert not loaded & {"numba", "scipy", "cholespy", "trimesh", "ipctk", "PySide6", "vtkmodules"}, loaded
"""


@pytest.mark.parametrize("name", ["a.apd", "ball.obj"])
def test_thumbnail_command_waits_for_nothing_that_only_work_needs(name, ball, tmp_path):
    save_mesh(ball, ball.V, tmp_path / "ball.obj")
    save_session(
        tmp_path / "a.apd",
        initial_state(ball),
        View(),
        picture=png_content(np.zeros((4, 4, 4), dtype=np.uint8)),
    )
    command = [sys.executable, "-c", textwrap.dedent(QUICK), str(tmp_path / name), str(tmp_path / "out.png")]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")
