"""The 3D view of a report: its arrays hold the shapes, and in a browser it turns."""

import base64
import io
import json
import re
from html import unescape

import numpy as np
import pytest
from meshes import sphere
from page_browser import PageBrowser
from page_parts import PageParts
from PIL import Image
from site_pages import browser

from apd_viewer.files.html_page import Page, PagePicture, PagePictureRow, PageSection, page_html, write_page
from apd_viewer.geometry.analysis.deviation import write_shades
from apd_viewer.presentation import report_view as module
from apd_viewer.presentation.report_view import MOST_BYTES, ShapeView, ViewedMesh, report_view
from apd_viewer.presentation.scales import Measure, default_scale

SCALE = default_scale(Measure.AREA, 1.0)
NAME = '</script><script>alert(1)</script> & "step"'


def ball(level=3, steps=5, **settings):
    """View of a ball that is drawn out in steps, its rest shape and its shapes."""
    V, F = sphere(level)
    centre = np.array([1000.0, 0.0, 0.0])  # far from the origin
    V = V + centre
    paint = np.full(V.shape, 200, dtype=np.uint8)
    paint[V[:, 1] > 0.5] = (200, 80, 0)
    shapes = []
    for k in range(1, steps + 1):
        shades = np.full(len(V), 255, dtype=np.uint8)
        write_shades(0.1 * k * (V[:, 1] - V[:, 1].mean()), True, SCALE.end, shades)
        shapes.append(
            ShapeView(f"{NAME} {k}", (V - centre) * [1.0 - 0.1 * k, 1.0 + 0.1 * k, 1.0] + centre, shades)
        )
    shown = ViewedMesh(V, F, paint)
    view = report_view(shown, shapes, steps - 1, SCALE, (0.55, 0.28, 1.0), (0.0, 1.0, 0.0), **settings)
    return view, shown, shapes


def told_by(view):
    """Data of a view, as a reader of the page gets them."""
    return json.loads(re.search(r'<script type="application/json">(.*?)</script>', view.html, re.DOTALL)[1])


def array(text, kind):
    return np.frombuffer(base64.b64decode(text), kind)


def positions(shape):
    levels = array(shape["positions"], "<u2").reshape(-1, 3)
    return np.array(shape["low"]) + levels / 65535 * np.array(shape["size"])


def page_of(view):
    """Page with a view and the pictures in its place."""
    content = io.BytesIO()
    Image.new("RGB", (40, 30), (10, 200, 30)).save(content, "PNG")
    pictures = PagePictureRow((PagePicture(content.getvalue(), "picture"),))
    return Page("ball", "a ball", ("100 %", "kept"), (PageSection("Shape", (view, pictures), is_wide=True),))


@pytest.fixture(scope="module")
def chromium():
    """A browser for all tests."""
    with PageBrowser() as page:
        yield page


@pytest.fixture
def page(chromium):
    """The browser, without what others have done there."""
    chromium.requests.clear()
    chromium.complaints.clear()
    return chromium


@pytest.fixture
def path(tmp_path):
    """File of a page with a view."""
    write_page(tmp_path / "page.html", page_of(ball()[0]))
    return tmp_path / "page.html"


def test_report_view_holds_all_shapes_within_a_hundred_thousandth():
    view, mesh, shapes = ball()
    told = told_by(view)
    np.testing.assert_array_equal(array(told["triangles"], "<u2").reshape(-1, 3), mesh.F)
    for found, X in (
        (told["rest"], mesh.V),
        *zip(told["shapes"], (shape.U for shape in shapes), strict=True),
    ):
        apart = np.linalg.norm(positions(found) - X, axis=1).max()
        assert apart < 1e-5 * np.linalg.norm(np.ptp(X, axis=0))
    np.testing.assert_array_equal(array(told["rest"]["paint"], "u1").reshape(-1, 3), mesh.paint)
    assert [shape["name"] for shape in told["shapes"]] == [shape.name for shape in shapes]
    assert told["current"] == len(shapes) - 1


def test_report_view_colors_area_change_as_the_legend_does():
    told = told_by(ball()[0])
    palette = array(told["palette"], "u1").reshape(256, 3)
    ends = SCALE.colors(np.array([0.0, 0.5, 1.0]))
    np.testing.assert_array_equal(palette[[1, 128, 255]], ends)


def test_report_view_leaves_steps_out_of_a_long_motion():
    view, _, shapes = ball(steps=40, most_bytes=60_000)
    told = told_by(view)
    assert 1 < len(told["shapes"]) < 40
    assert told["shapes"][told["current"]]["name"] == shapes[-1].name
    assert f"The view has {len(told['shapes'])} of 40 steps" in view.html
    raw = sum(len(base64.b64decode(text)) for text in re.findall(r'"([A-Za-z0-9+/=]{200,})"', view.html))
    assert raw < 60_000
    assert len(told_by(ball(steps=40, most_bytes=1)[0])["shapes"]) == 1


def test_report_view_is_coarser_on_a_fine_mesh(monkeypatch):
    monkeypatch.setattr(module, "MOST_TRIANGLES", 1000)
    view, mesh, shapes = ball(level=4)
    told = told_by(view)
    triangles = array(told["triangles"], "<u2").reshape(-1, 3)
    assert 500 < len(triangles) <= 1000
    assert f"The view has {len(triangles):,} of {len(mesh.F):,} triangles" in view.html
    # Its vertices are vertices of the mesh, and move as they do.
    rest, last = positions(told["rest"]), positions(told["shapes"][-1])
    near = [int(np.linalg.norm(mesh.V - x, axis=1).argmin()) for x in rest]
    np.testing.assert_allclose(rest, mesh.V[near], atol=1e-4)
    np.testing.assert_allclose(last, shapes[-1].U[near], atol=1e-4)


def test_report_view_is_small_and_well_formed():
    view = ball()[0]
    text = page_html(page_of(view))
    found = PageParts(text)
    assert found.wrong == []
    assert found.tags.count("script") == 2
    assert NAME not in text
    assert "alert" not in re.sub(r'<script type="application/json">.*?</script>', "", text)
    assert len(text) < 300_000
    assert MOST_BYTES * 4 / 3 < 10_000_000
    assert "unsafe-inline" not in unescape(text).partition("script-src")[2].partition('"')[0]
    plain = page_html(Page("a", "b", ("c", "d"), ()))
    assert "script" not in plain


needs_browser = pytest.mark.skipif(
    browser() is None, reason="Ubuntu has Chromium as a snap only, other systems by hand"
)
BOX = """(() => { const box = document.querySelector("canvas").getBoundingClientRect();
  return [box.x, box.y, box.width, box.height]; })()"""
# A view that draws slowly pauses for less than 0.8 s, and then draws once more, finely.
STILL = """new Promise(done => { const end = performance.now() + 800;
  (function next() { performance.now() > end ? done() : requestAnimationFrame(next); })(); })"""


def stage(page):
    """RGB of the pixels of the view (h, w, 3) once it is still, and its box x, y, width, height."""
    x, y, width, height = (round(value) for value in page.value(BOX))
    before, whole = None, b""
    while whole != before:
        page.value(STILL)
        before, whole = whole, page.picture()
    pixels = np.asarray(Image.open(io.BytesIO(whole)).convert("RGB")).astype(int)
    return pixels[y : y + height, x : x + width], (x, y, width, height)


def share_apart(one, other):
    """Share of the pixels that differ."""
    return float((np.abs(one - other).max(axis=2) > 8).mean())


def choose(page, value):
    page.value(f"document.querySelector('input[value={value}]').click()")
    return stage(page)[0]


@needs_browser
def test_report_view_opens_from_a_file_and_turns(page, path):
    page.open(path)
    first, (x, y, width, height) = stage(page)
    background = first[2, 20]
    assert 0.05 < float((np.abs(first - background).max(axis=2) > 8).mean()) < 0.9
    assert share_apart(first, stage(page)[0]) == 0.0
    middle = (x + width // 2, y + height // 2)
    page.drag(middle, (middle[0] + 120, middle[1] + 60))
    turned = stage(page)[0]
    assert share_apart(first, turned) > 0.01
    page.press("ArrowUp")
    assert share_apart(turned, stage(page)[0]) > 0.005
    page.press("Home")
    shapes = {value: choose(page, value) for value in ("deformed", "rest", "overlay")}
    assert share_apart(shapes["deformed"], shapes["rest"]) > 0.01
    assert share_apart(shapes["deformed"], shapes["overlay"]) > 0.01
    assert share_apart(shapes["rest"], shapes["overlay"]) > 0.01
    assert page.value("getComputedStyle(document.querySelector('.pictures')).display") == "none"
    assert [url for url in page.requests if not url.startswith("data:")] == [path.as_uri()]
    assert page.complaints == []


@pytest.mark.night
@needs_browser
def test_report_view_goes_along_the_motion_by_keys_and_by_itself(page, path):
    page.open(path)
    last = stage(page)[0]
    assert page.value("document.querySelector('output').textContent") == f"{NAME} 5"
    page.value("document.querySelector('input[type=range]').focus()")
    page.press("Home")
    assert page.value("document.querySelector('output').textContent") == f"{NAME} 1"
    first = stage(page)[0]
    assert share_apart(first, last) > 0.01
    page.value("document.querySelector('button').click()")
    assert page.value("document.querySelector('button').textContent") == "Pause"
    at_end = "document.querySelector('button').textContent === 'Play'"
    looking = f"setInterval(() => {at_end} && (clearInterval(timer), done()), 20)"
    page.value(f"new Promise(done => {{ const timer = {looking}; }})")
    assert share_apart(stage(page)[0], last) == 0.0
    choose(page, "rest")
    assert page.value("document.querySelector('input[type=range]').disabled") is True


@needs_browser
@pytest.mark.parametrize(("scheme", "width"), [("light", 1280), ("dark", 390)])
def test_report_view_fits_on_pages_of_all_kinds(page, path, scheme, width):
    page.open(path, scheme, (width, 800))
    pixels = stage(page)[0]
    assert page.value("document.documentElement.scrollWidth") == width
    assert (pixels[2, 20].mean() < 80) == (scheme == "dark")
    assert float((np.abs(pixels - pixels[2, 20]).max(axis=2) > 8).mean()) > 0.05


@needs_browser
@pytest.mark.parametrize("way", ["print", "no scripts", "no WebGL"])
def test_report_view_gives_way_to_the_pictures(page, path, way):
    source = "HTMLCanvasElement.prototype.getContext = () => null" if way == "no WebGL" else ""
    added = page.ask("Page.addScriptToEvaluateOnNewDocument", source=source)["identifier"]
    page.open(path, media="print" if way == "print" else "", has_scripts=way != "no scripts")
    page.ask("Page.removeScriptToEvaluateOnNewDocument", identifier=added)
    green = np.asarray(Image.open(io.BytesIO(page.picture())).convert("RGB")).astype(int)
    assert float((np.abs(green - (10, 200, 30)).max(axis=2) < 8).mean()) > 0.1
    assert page.complaints == []
