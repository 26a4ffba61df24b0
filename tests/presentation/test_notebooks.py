"""Notebooks: results with picture and readings, and progress where somebody reads."""

import base64
import io
import pickle
import re
import sys
from dataclasses import replace
from html.parser import HTMLParser
from types import ModuleType, SimpleNamespace

import meshes
import numpy as np
import pytest
from PIL import Image

import apd_viewer
from apd_viewer.files.picture_files import read_png
from apd_viewer.presentation import progress_line
from apd_viewer.presentation.notebook_deform import change_colors
from apd_viewer.presentation.number_format import format_short_signed
from apd_viewer.presentation.progress_line import ProgressLine

NAME = "<script>alert('x')</script> & \"co\""


class Page(HTMLParser):
    """Tags, rows and pictures of a piece of HTML; an unclosed tag fails."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.open, self.cells, self.images = set(), [], [], []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attributes):
        self.tags.add(tag)
        if tag == "img":
            self.images.append(dict(attributes))
            return
        self.open.append(tag)
        if tag in ("td", "th"):
            self.cells.append("")

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] in ("td", "th"):
            self.cells[-1] += data

    @property
    def rows(self):
        return dict(zip(self.cells[::2], self.cells[1::2], strict=True))


def bent(**more):
    """A bar, its end moved aside."""
    V, F = meshes.box(1, 1, 4)
    base, end = meshes.ends(V)
    targets = np.vstack([V[base], V[end] + [0.5, 0.0, 0.0]])
    return apd_viewer.deform(V, F, np.r_[base, end], targets, handle=end, **more)


@pytest.fixture(scope="module")
def result(compiled):
    V, _ = meshes.box(1, 1, 4)
    region = apd_viewer.Region(NAME, np.flatnonzero(V[:, 2] < 2.5))
    return replace(bent(regions=[region], iterations=2), warnings=(f"Look at {NAME}.",))


def test_notebook_result_is_a_result_and_can_be_sent(result):
    assert isinstance(result, apd_viewer.Result)
    assert pickle.loads(pickle.dumps(apd_viewer.deform)) is apd_viewer.deform
    again = pickle.loads(pickle.dumps(result))
    np.testing.assert_array_equal(again.U, result.U)
    assert again._repr_html_() == result._repr_html_()


def test_notebook_result_has_readings_in_a_table_in_which_names_stay_names(result):
    page = Page(result._repr_html_())
    assert page.tags == {"div", "img", "table", "tr", "th", "td"}
    rows = page.rows
    assert rows["Method"] == "Exact"
    assert rows["Effort"].startswith("2 iterations, not converged, ")
    assert rows["Area"] == "18.0000 of 18.0000 (0.000 %)"
    assert rows["Volume"].startswith(f"{result.volume:.5f} of 4.00000 (")
    assert float(rows[f"Region “{NAME}”"].split()[0]) == pytest.approx(result.regions[0].area, rel=1e-5)
    assert rows["Largest local area change"] == f"{100 * result.local_change:.3g}\u00a0%"
    assert rows["Largest edge strain"] == format_short_signed(100 * result.largest_edge_strain) + "\u00a0%"
    assert rows["Mean edge strain"] == f"{100 * result.mean_edge_strain:.3g}\u00a0%"
    assert rows["Handle drift"] == "0"
    assert rows["Warning"] == f"Look at {NAME}."


def test_notebook_result_of_an_open_surface_has_its_volume_with_caps(compiled):
    V, F = meshes.box(1, 1, 4)
    base, end = meshes.ends(V)
    open_end = F[~np.isin(F, end).all(axis=1)]
    targets = np.vstack([V[base], V[end] + [0.5, 0.0, 0.0]])
    result = apd_viewer.deform(V, open_end, np.r_[base, end], targets, handle=end, iterations=3)
    rows = Page(result._repr_html_()).rows
    assert "Volume" not in rows
    assert rows["Volume, capped"].startswith(f"{result.volume_capped:.5f} of 4.00000 (")


def test_notebook_result_has_its_picture_in_the_page_and_on_nothing(result):
    (image,) = Page(result._repr_html_()).images
    assert "Rest shape and deformed shape" in image["alt"]
    kind, content = image["src"].split(",", 1)
    assert kind == "data:image/png;base64"
    pixels = read_png(base64.b64decode(content), 1024)
    left, right = np.array_split(pixels, 2, axis=1)
    assert pixels[0, :, 3].max() == 0  # legible on light and on dark pages
    assert 0.1 < (left[..., 3] > 0).mean() < 0.9
    assert not np.array_equal(left, right)


def test_notebook_result_has_pictures_of_bounded_size(result):
    (image,) = Page(result._repr_html_()).images
    with Image.open(io.BytesIO(base64.b64decode(image["src"].split(",")[1]))) as picture:
        assert max(picture.size) <= 2 * 280


def test_notebook_result_gives_nothing_a_color_of_its_own_but_lines():
    """What a page of any colour shows: text in its own colour, and lines that are half transparent."""
    text = re.sub(r'src="[^"]*"', "", bent(iterations=1)._repr_html_())
    assert set(re.findall(r"(?<![-\w])(?:color|background):([^;\"]+)", text)) == {"inherit", "none"}
    assert "rgba(128,128,128,0.35)" in text


def test_change_colors_tell_grown_from_shrunk(result):
    rest, F = result.rest, result.triangles
    unmoved, grown, shrunk = (
        change_colors(SimpleNamespace(rest=rest, U=factor * rest, triangles=F))[0].astype(int)
        for factor in (1.0, 1.04, 0.96)
    )
    assert unmoved.min() > 230
    assert grown[1] > grown[0]  # green
    assert shrunk[0] > shrunk[1]  # purple


# Progress


class Screen(io.StringIO):
    """Standard error of a terminal, or of a file."""

    def __init__(self, reads):
        super().__init__()
        self.isatty = lambda: reads


def on(monkeypatch, screen, ipython=None):
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    return screen


class Notebook(ModuleType):
    """IPython, as far as it is asked for anything."""

    def __init__(self, runs=True):
        super().__init__("IPython")
        self.shown, self.cells = [], 0
        self.get_ipython = lambda: self if runs else None
        self.display = SimpleNamespace(display=self._display)

    def _update(self, content, raw):
        assert raw
        self.shown.append(content["text/plain"])

    def _display(self, content, raw, display_id):
        assert raw
        assert display_id
        self.cells += 1
        self.shown.append(content["text/plain"])
        return SimpleNamespace(update=self._update)


def test_progress_line_is_one_on_a_terminal_and_ends_with_the_last_frame(compiled, monkeypatch):
    screen = on(monkeypatch, Screen(True))
    result = bent(progress=True)
    text = screen.getvalue()
    assert text.count("\n") == 1
    assert text.endswith("\n")
    last = text.rstrip().split("\r")[-1]
    assert last == f"iteration {result.iterations:,}   area {100 * result.area_error:+.3f} %"


def test_progress_line_counts_plain_iterations_down(compiled, monkeypatch):
    screen = on(monkeypatch, Screen(True))
    bent(progress=True, iterations=7)
    assert "iteration 7 of 7   area" in screen.getvalue()


def test_progress_line_is_one_in_a_notebook_and_changes(compiled, monkeypatch):
    notebook = Notebook()
    screen = on(monkeypatch, Screen(False), notebook)
    result = bent(progress=True)
    assert notebook.cells == 1
    assert notebook.shown[-1].startswith(f"iteration {result.iterations:,} ")
    assert screen.getvalue() == ""


@pytest.mark.parametrize("ipython", [None, Notebook(runs=False)], ids=["without IPython", "IPython at rest"])
def test_progress_line_says_nothing_where_nobody_reads(ipython, compiled, monkeypatch, capsys):
    screen = on(monkeypatch, Screen(False), ipython)
    bent(progress=True, iterations=3)
    assert screen.getvalue() == capsys.readouterr().out == ""


def test_progress_line_is_only_shown_on_request_and_a_function_is_called_as_before(compiled, monkeypatch):
    screen, frames = on(monkeypatch, Screen(True)), []
    bent(iterations=3)
    bent(iterations=3, progress=False)
    bent(iterations=3, progress=frames.append)
    assert screen.getvalue() == ""
    assert [frame.iteration for frame in frames] == [1, 2, 3]


def test_progress_line_ends_where_an_error_begins(compiled, monkeypatch):
    screen = on(monkeypatch, Screen(True))
    with pytest.raises(apd_viewer.InputError):
        bent(progress=True, method="nonsense")
    assert screen.getvalue() == ""


def test_progress_line_is_said_no_more_often_than_can_be_read(monkeypatch):
    screen = on(monkeypatch, Screen(True))
    monkeypatch.setattr(progress_line.time, "monotonic", lambda: 1.0)
    line = ProgressLine()
    for iteration in range(1, 1000):
        line(SimpleNamespace(iteration=iteration, area_error=0.0))
    line.end()
    assert screen.getvalue().count("\r") == 2  # the first and the last
    assert "iteration 999 " in screen.getvalue()
