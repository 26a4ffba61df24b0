"""Every picture of the pages is made by a script, every script makes one that is shown, and all of them run.

Here the scripts drive their windows on coarse meshes, with a few iterations: whatever a script clicks, types
and names is there, but what a full run draws is not looked at. By day a few of them do.
"""

import re
import struct
from pathlib import Path

import numpy as np
import pytest
from film import film
from film_files import Part, reel, write_gif, write_webm
from film_recorder import RATE
from gallery_page import gallery_page
from make_pictures import FILM, HERE, SCRIPTS, drawer, files, names
from picture_files import Film, film_of_gif, still, write_picture
from PIL import Image, ImageSequence
from PySide6.QtCore import QSize
from PySide6.QtGui import QColor, QImage
from PySide6.QtWidgets import QApplication
from stage import Stage

from apd_viewer.ui.application import HARMLESS_MESSAGE

ROOT = Path(__file__).parents[1]
IMAGE = re.compile(r"!\[([^\]]*)\]\(([^)\s]+)\)")
MOST = 12_000_000  # bytes of all pictures: the site is to be carried along
OF_THE_GALLERY = ["bottle_twisted", "falloff", "sweep"]  # the others are drawn in the same way
DAILY = {"gallery_falloff", "window"}


def pages():
    """Text of each page by its path; that of the gallery with its entries."""
    found = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]
    texts = {path: path.read_text(encoding="utf-8") for path in found}
    gallery = ROOT / "docs" / "gallery.md"
    return texts | {gallery: texts[gallery].replace("<!-- generated: gallery -->", gallery_page())}


def shown(texts):
    """Paths of the pictures in pages."""
    return {(page.parent / link).resolve() for page, text in texts.items() for _, link in IMAGE.findall(text)}


def made():
    """Paths of the pictures that scripts make, among them those of the film."""
    # Blender's module draws one, and JupyterLab another, by blender_pictures.py and notebook_picture.py.
    found = {path for name in [*names(), FILM, "blender", "notebook"] for path in files(name)}
    return {path for path in found if path.suffix != ".webm"}


def test_pictures_of_the_manual_are_made_by_scripts_each_of_which_makes_one_that_is_shown():
    assert len(made()) > 60
    assert shown(pages()) == made()
    assert {path for path in HERE.rglob("*") if path.suffix in (".webp", ".png", ".gif")} == made()


def test_pictures_of_the_manual_are_noticed_without_a_script(tmp_path):
    page = tmp_path / "page.md"
    assert shown({page: "![What it shows](other.png) and [a link](other.md)"}) == {tmp_path / "other.png"}


def test_pictures_of_the_manual_all_say_what_they_show():
    silent = [
        (page.name, link)
        for page, text in pages().items()
        for words, link in IMAGE.findall(text)
        if not words
    ]
    assert silent == []


def test_pictures_of_the_manual_are_sharp_and_small():
    stills = [path for path in made() if path.suffix == ".webp"]
    sizes = {path.name: path.stat().st_size for path in stills}
    assert sum(sizes.values()) < MOST
    assert max(sizes.values()) < 600_000
    for path in stills:
        with Image.open(path) as image:
            assert image.format == "WEBP"
            assert image.width >= 500


def seconds_of(webm):
    """Length of a film by the head of its file: seconds, in a time scale of milliseconds."""
    head = webm.read_bytes()[:2000]
    assert b"\x2a\xd7\xb1\x83\x0f\x42\x40" in head, "another time scale"
    return struct.unpack(">d", head.partition(b"\x44\x89\x88")[2][:8])[0] / 1000


def test_pictures_of_the_manual_have_a_film_of_a_minute_at_most():
    webm, gif = (HERE / f"{FILM}.{ending}" for ending in ("webm", "gif"))
    assert webm.stat().st_size <= 4_000_000
    assert 40 <= seconds_of(webm) <= 60
    assert gif.stat().st_size <= 2_000_000
    with Image.open(gif) as image:
        durations = [frame.info["duration"] for frame in ImageSequence.Iterator(image)]
        assert image.width >= 600
        assert image.info["loop"] == 0
    assert sum(durations) == pytest.approx(8000, abs=200)


@pytest.fixture
def staged(qapp, tmp_path, compiled):
    """Stages that are closed at the end."""
    stages, font = [], qapp.font()

    def begin(**options):
        folder = tmp_path / str(len(stages))
        folder.mkdir()
        stages.append(Stage(folder, quick=True, **options))
        return stages[-1]

    yield begin
    for stage in stages:
        stage.close()
    QApplication.setFont(font)


SCRIPTED = sorted(path.stem for path in SCRIPTS.glob("*.py"))


def by_day(names):
    """Those that are daily, and the others by night."""
    return [pytest.param(name, marks=() if name in DAILY else pytest.mark.night) for name in names]


@pytest.mark.qt_log_ignore(HARMLESS_MESSAGE)
@pytest.mark.parametrize("name", by_day([*SCRIPTED, *(f"gallery_{name}" for name in OF_THE_GALLERY)]))
def test_pictures_of_the_manual_have_scripts_that_run(name, staged):
    drawn = drawer(name)(staged())
    picture = np.asarray(still(drawn).convert("RGB"), dtype=int)
    assert min(picture.shape[:2]) > 100
    assert picture.std() > 5  # something is there


@pytest.mark.night
def test_pictures_of_the_manual_have_a_film_whose_scenes_run(staged):
    stage, taken = staged(), []
    recorder, poster = film(stage, lambda *picture: taken.append(picture))
    assert sum(count for _, count in taken) == recorder.count
    assert 40 * RATE <= recorder.count <= 60 * RATE
    assert {picture.size().toTuple() for picture, _ in taken} == {poster.size().toTuple()}
    assert all(side % 2 == 0 for side in poster.size().toTuple())
    assert min(count for _, count in taken) > 0
    spoken = [line.words for line in recorder.lines[1:]]
    assert len(set(spoken)) == len(spoken) > 6
    assert set(recorder.chapters) == {"twist", "press"}
    assert (stage.folder / "bottle-pressed.glb").stat().st_size > 1000
    assert len(stage.window.session.player.timeline.steps) == 3
    assert stage.window.shell.rect().contains(recorder.pointer.toPoint())


@pytest.mark.night
@pytest.mark.parametrize("name", ["move_gizmo", "targets_fields", "choose_lasso"])
def test_pictures_of_the_manual_made_twice_are_the_same(name, staged):
    """Pixel for pixel, with the same drawing of OpenGL."""
    first, second = (np.asarray(still(drawer(name)(staged(smooth=True)))) for _ in range(2))
    np.testing.assert_array_equal(first, second)


def test_pictures_of_the_manual_write_a_film_with_its_pace(tmp_path):
    frames = [Image.new("RGB", (40, 30), color) for color in ("red", "green", "blue")]
    frames[0].save(tmp_path / "a.gif", save_all=True, append_images=frames[1:], duration=[100, 200, 300])
    film = film_of_gif(tmp_path / "a.gif", 20)
    assert film.durations == [100, 200, 300]
    write_picture(film, tmp_path / "a.webp")
    with Image.open(tmp_path / "a.webp") as image:
        assert (image.n_frames, image.size) == (3, (20, 15))
    assert isinstance(film, Film)


@pytest.mark.extra
def test_pictures_of_the_manual_in_a_row_become_a_webm_and_a_gif_of_parts(tmp_path):
    """A second each of three shades; the GIF leaves out the second, and shows the third twice as long."""
    with reel(tmp_path / "film.mkv") as taken:
        for shade in (20, 120, 220):
            picture = QImage(QSize(640, 480), QImage.Format.Format_RGB32)
            picture.fill(QColor(shade, shade, shade))
            taken.take(picture, 15)
    write_webm(taken.path, tmp_path / "film.webm")
    assert seconds_of(tmp_path / "film.webm") == pytest.approx(3.0, abs=0.1)
    write_gif(taken.path, tmp_path / "film.gif", [Part(0, 15, 1.0), Part(30, 45, 2.0)])
    with Image.open(tmp_path / "film.gif") as image:
        frames = [
            (np.asarray(frame.convert("L")).mean(), frame.info["duration"])
            for frame in ImageSequence.Iterator(image)
        ]
    assert sum(duration for _, duration in frames) == pytest.approx(3000, abs=150)
    assert sum(duration for shade, duration in frames if shade > 200) == pytest.approx(2000, abs=150)
    assert not [shade for shade, _ in frames if 60 < shade < 180]
