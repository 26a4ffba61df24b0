"""The report of a window: it says what the panel says, which is what others measure."""

import base64
import hashlib
import json
import re
import zipfile
from pathlib import Path

import meshes
import numpy as np
import pytest
import trimesh
from driving import idle, settle, work_off
from page_parts import PageParts
from PySide6.QtGui import QImage

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.analysis.hull_readings import convex_hull
from apd_viewer.geometry.measuring.measurement import Plane
from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.geometry.measuring.surface_point import SurfacePoint
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import HANDLE
from apd_viewer.presentation.number_format import format_significant
from apd_viewer.presentation.scales import Measure, Scale
from apd_viewer.presentation.volume_text import PUBLISHED_VOLUMES, VolumeName
from apd_viewer.session.model.document_parts import PaintedPart
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.processes import shape_checker
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.storage.session_file import open_session
from apd_viewer.ui.filing import file_dialogs
from apd_viewer.ui.sharing.report_dialogs import ReportDialog


def shapes_of_view(path):
    """Positions (n, 3) at rest and deformed in the view of a report."""
    text = path.read_text(encoding="utf-8")
    told = json.loads(re.search(r'<script type="application/json">(.*?)</script>', text, re.DOTALL)[1])

    def positions(shape):
        levels = np.frombuffer(base64.b64decode(shape["positions"]), "<u2").reshape(-1, 3)
        return np.array(shape["low"]) + levels / 65535 * np.array(shape["size"])

    return positions(told["rest"]), [positions(shape) for shape in told["shapes"]]


def write(qtbot, window, path):
    window.reports.write_report(path)
    idle(qtbot, window)
    return PageParts(path.read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def kept(unused):
    """Another window may still wait for its first check."""
    return unused


@pytest.fixture(autouse=True)
def at_once(monkeypatch):
    monkeypatch.setattr(shape_checker, "FIRST_PAUSE", 0.0)
    monkeypatch.setattr(shape_checker, "NEXT_PAUSE", 0.0)


@pytest.fixture
def file(tmp_path, monkeypatch):
    """A coarse bottle in somebody's home folder, whose name means harm."""
    monkeypatch.setattr(Path, "home", lambda: tmp_path / "somebody")
    path = tmp_path / "somebody" / "&lt;b&gt; 'mesh'.obj"
    path.parent.mkdir()
    V, F, _ = meshes.sample_bottle(3.0)
    save_mesh(Mesh(V, F), V, path)
    return path


@pytest.fixture
def twisted(qtbot, window, file):
    """The bottle in centimetres, twisted, at rest and checked, with a name that means harm."""
    labels = frozen(meshes.sample_bottle(3.0)[2].astype(np.uint8))
    window.session.files.open_result("bottle", lambda: initial_state(open_mesh(file), labels))
    idle(qtbot, window)
    window.panel.area.unit.chosen.emit(Unit.CENTIMETRE)
    window.panel.measures.wall_fields.thickness.setText("0.3mm")
    window.panel.measures.wall_fields.density.setText("1.38")
    window.panel.measures.wall_fields.density.editingFinished.emit()
    window.session.parts.rename_handle(0, "<script>neck & 'cap'</script>")
    window.session.parts.add_region()
    wanted = window.session.store.state.document.mesh.V[:, 1] > 12.0
    window.session.painting.set_members(PaintedPart(1, is_region=True), wanted, "Paint region")
    window.session.handles.move_by(MOTIONS["TWIST"], "20", 0)
    window.session.handles.move_by(MOTIONS["MOVE_Y"], "0.25", 0)
    window.session.measurements.add(MeasurementKind.SECTION, plane=Plane((0.0, 1.0, 0.0), 10.0))
    idle(qtbot, window)
    qtbot.waitUntil(lambda: window.session.shape_checks.shape_check is not None, timeout=30_000)
    return window


def test_report_controller_warns_of_turns_before_the_shape_is_checked(qtbot, twisted, tmp_path, monkeypatch):
    window = twisted
    window.session.settings.change(contact=False)
    for _ in range(3):
        window.session.handles.move_by(MOTIONS["TWIST"], "160", 0)
        idle(qtbot, window)
    qtbot.waitUntil(lambda: window.session.shape_checks.shape_check is not None, timeout=30_000)
    known = window.session.shape_checks.shape_check
    assert known.turns
    pages = []
    for found in (known, None):
        monkeypatch.setattr(window.session.shape_checks, "shape_check", found)
        path = tmp_path / "report.html"
        write(qtbot, window, path)
        pages.append(re.sub(r"\s+", " ", path.read_text(encoding="utf-8")))
    warned = [len(re.findall("The surface holds", page)) for page in pages]
    assert warned[0] == warned[1] > 0


def number(text):
    return float(re.match(r"[−+]?[\d.]+", text).group().replace("−", "-"))


def test_report_controller_writes_what_the_panel_says_and_what_others_measure(qtbot, twisted, file, tmp_path):
    window, state = twisted, twisted.session.store.state
    path = tmp_path / "report.html"
    page = write(qtbot, window, path)
    panel, rows = window.panel, page.rows
    assert page.wrong == []
    assert window.notice.text == "Saved report.html."
    assert window.notice.open_file.isVisible()

    area = rows["Area"]
    assert area["Area"] == f"{panel.area.percent.text()}\n{panel.area.area.text()}"
    assert area["Change"] == panel.area.verdict.text()
    assert area["Largest local area change"] == panel.strain.local_change.text()
    assert area["Largest edge strain"] == panel.strain.largest_strain.text()
    assert area["Mean edge strain"] == panel.strain.mean_strain.text()
    volume = rows["Volume"]
    assert volume["Volume"] == f"{panel.volume.change}\n{panel.volume.volume.text()}"
    assert volume[""] == panel.volume.litres.text()
    assert (volume["Self-intersections"] == "none") == (
        panel.volume.crossings.text() == "no self-intersections"
    )
    size, shown = rows["Size and mass"], panel.measures
    assert size["Bounding box"] == shown.extent.text()
    assert size["Bounding box volume"] == f"{shown.box.text()}\n{shown.box_change.text()}"
    assert size["Smallest box volume"] == f"{shown.packed.text()}\n{shown.packed_change.text()}"
    assert size["Compactness"] == f"{shown.compact.text()}\n{shown.compact_change.text()}"
    assert size["Mass"] == shown.mass.text()
    assert size["Wall"] == "0.3mm, 1.38\u00a0g/cm³"
    section, here = rows["Measurements"], panel.measure.list.rows[0].reading.text()
    assert here.split("  ")[0] == section["Section 1, length"].split("\n")[0]
    assert "cm² " in section["Section 1, enclosed area"].replace("\n", " ") + " "
    handle, held = state.document.handles[0].name, state.document.label_counts[HANDLE]
    details = panel.handles.list.rows[0].details.text()
    assert rows["Handles"][handle].startswith(
        f"{details}\n{held:,} vertices; displacement (0, 0.25, 0)\u00a0cm"
    )
    assert "axis (0, 1, 0), angle 20°" in rows["Handles"][handle]
    assert rows["Handles"]["Drift"] == panel.strain.drift.text()
    assert rows["Regions"]["Region 1"].split("\n")[0] == panel.regions.list.rows[0].reading.text()

    export = tmp_path / "shape.obj"
    save_mesh(state.document.mesh, state.frame.U, export)
    measured, rest = (trimesh.load(path, process=False) for path in (export, file))
    now, then = (number(text) for text in area["Area"].split("\n")[1].split(" of "))
    assert now == pytest.approx(measured.area, rel=2e-6)
    assert then == pytest.approx(rest.area, rel=2e-6)
    now, then = (number(text) for text in volume["Volume"].split("\n")[1].split(" of "))
    assert now == pytest.approx(measured.volume, rel=2e-6)
    assert then == pytest.approx(rest.volume, rel=2e-6)
    change = np.abs(measured.area_faces / rest.area_faces - 1.0)
    assert number(rows["Local area change"]["Largest"]) == pytest.approx(100 * change.max(), rel=6e-3)
    mean = float(np.average(change, weights=rest.area_faces))
    assert number(rows["Local area change"]["Mean"]) == pytest.approx(100 * mean, rel=6e-3)
    lengths = [shape.edges_unique_length for shape in (measured, rest)]
    strain, weight = lengths[0] / lengths[1] - 1.0, np.zeros(len(lengths[1]))
    np.add.at(weight, rest.faces_unique_edges, rest.area_faces[:, None])
    assert number(area["Largest edge strain"]) == pytest.approx(100 * max(strain, key=abs), rel=6e-3)
    mean = float(np.average(np.abs(strain), weights=weight))
    assert number(area["Mean edge strain"]) == pytest.approx(100 * mean, rel=6e-3)
    grams = 0.03 * measured.area * 1.38
    assert number(size["Mass"]) == pytest.approx(grams, rel=1e-3)

    reduction = rows["Volume reduction"]
    named = {name.split("\n")[0]: (name, said) for name, said in reduction.items()}
    checks, hull = window.session.shape_checks, convex_hull(measured.vertices)
    assert named["Convex hull volume"][1].startswith(
        f"{format_significant(checks.rest_check.hull.volume, 4)}\u00a0cm³\n"
        f"{format_significant(hull.volume, 4)}\u00a0cm³\n"
    )
    assert named["Smallest box volume"][1].split("\n")[1] == shown.packed.text()
    assert named["Objects in a bag of 45 l"][1].split("\n")[0] == "50"
    assert number(named["Material volume"][1].split("\n")[1]) == pytest.approx(grams / 1.38, rel=1e-3)
    text = "\n".join(said for _, said in named.values())
    for figures in PUBLISHED_VOLUMES.values():
        for figure in figures:
            assert text.count(f"{figure.words}\n{figure.source}") == 1
    assert len(named) == len(VolumeName) - 3 + 1  # nothing is filled in; and the heading

    mesh, content = rows["Mesh and file"], file.read_bytes()
    assert page.title == file.name
    assert mesh["File"] == f"~/{file.name}"
    assert mesh["SHA-256 of the file"] == hashlib.sha256(content).hexdigest()
    assert mesh["Size"] == f"{len(content):,} bytes"
    assert mesh["Mesh digest"].split("\n")[0] == state.document.mesh.digest


def test_report_controller_writes_pictures_and_the_session_and_nobodys_folder(qtbot, twisted, file, tmp_path):
    state, path = twisted.session.store.state, tmp_path / "report.html"
    page = write(qtbot, twisted, path)
    assert page.tags.count("script") == 2  # the shapes of the view, and the one that shows them
    rest, shapes = shapes_of_view(path)
    for found, X in ((rest, state.document.mesh.V), *((found, state.frame.U) for found in shapes)):
        np.testing.assert_allclose(found, X, atol=1e-5 * np.ptp(X, axis=0).max())
    assert page.wrong == []
    assert all(value.startswith("data:") for _, value in page.held)
    held = [base64.b64decode(value.partition(",")[2]) for _, value in page.held]
    images = [QImage.fromData(content, "PNG") for content in held[:3]]
    for image in images:
        corners = [(x, y) for x in (0, image.width() - 1) for y in (0, image.height() - 1)]
        assert [image.pixelColor(*corner).alpha() for corner in corners] == [0, 0, 0, 0]
        assert image.pixelColor(image.width() // 2, image.height() // 2).alpha() == 255
    assert len({image.size().toTuple() for image in images}) == 1
    assert images[0] != images[1] != images[2]

    session = tmp_path / "elsewhere" / "report.apd"
    session.parent.mkdir()
    session.write_bytes(held[3])
    told = zipfile.ZipFile(session).read("session.json").decode()
    assert "somebody" not in told + path.read_text(encoding="utf-8")
    file.unlink()  # it needs no other file
    opened, view = open_session(session)
    assert np.array_equal(opened.frame.U, state.frame.U)
    assert np.array_equal(opened.document.mesh.V, state.document.mesh.V)
    assert np.array_equal(opened.document.labels, state.document.labels)
    assert opened.document.handles[0].name == state.document.handles[0].name
    assert view.unit == "cm"


def test_report_controller_fits_the_colors_of_the_area_change_to_the_shape(qtbot, twisted, tmp_path):
    state, overlay = twisted.session.store.state, twisted.display_options.overlay
    assert Measure.AREA not in overlay.scales
    write(qtbot, twisted, tmp_path / "report.html")
    end = ends_of_legend(tmp_path / "report.html")
    largest = 100 * state.frame.local_change
    assert largest <= end < 2.51 * largest
    assert end != 10.0, "the test is blind"
    overlay.scales[Measure.AREA] = Scale(Measure.AREA, 3.0)
    try:
        write(qtbot, twisted, tmp_path / "chosen.html")
    finally:
        del overlay.scales[Measure.AREA]
    assert ends_of_legend(tmp_path / "chosen.html") == 300.0


def ends_of_legend(path):
    """The last figure of the legend, in percent."""
    legend = path.read_text(encoding="utf-8").partition('<div class="legend">')[2].partition("</div>")[0]
    return max(number(text) for text in re.findall(r">([−+]?[\d.]+)\u00a0%<", legend))


def test_report_controller_names_each_drawing_by_its_caption(qtbot, twisted, tmp_path):
    write(qtbot, twisted, tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    drawings = re.findall(r"(?s)<svg.*?</svg>", text)
    named = [re.findall(r"<title>([^<]*)</title>", drawing) for drawing in drawings]
    caption = "Share of the surface by local area change"
    assert named == [["Local area change"], [caption], [caption]]
    assert f"<figcaption>{caption}</figcaption>" in text
    assert not re.search(r"Generated with|Qt SVG", text)


def test_report_controller_gives_the_reason_of_each_missing_value(qtbot, window, tmp_path):
    V, F = meshes.box(2, 2, 6)
    window.files.show_mesh(Mesh(V, F[2:]))
    idle(qtbot, window)
    assert window.panel.measures.compact.text() == "–"
    size = write(qtbot, window, tmp_path / "report.html").rows["Size and mass"]
    why = window.session.store.state.inspection.missing_volume_phrase
    assert why in size["Compactness"]
    assert size["Wall"] == "–\nnot entered"
    assert size["Mass"] == "–\nneeds thickness and density"
    window.panel.measures.wall_fields.thickness.setText("0.3mm")
    window.panel.measures.wall_fields.thickness.editingFinished.emit()
    size = write(qtbot, window, tmp_path / "report.html").rows["Size and mass"]
    assert size["Mass"] == f"–\n{window.panel.measures.problem.text()}"


def test_report_controller_measures_what_is_missing_soon_after_an_edit(qtbot, twisted, tmp_path, monkeypatch):
    monkeypatch.setattr(shape_checker, "NEXT_PAUSE", 1000.0)  # the window does not look meanwhile
    twisted.session.handles.move_by(MOTIONS["TWIST"], "5", 0)
    idle(qtbot, twisted)
    points = SurfacePoint(0, (1.0, 0.0, 0.0)), SurfacePoint(60, (1.0, 0.0, 0.0))
    twisted.session.measurements.add(MeasurementKind.GEODESIC, points)
    assert twisted.session.shape_checks.shape_check is None
    rows = write(qtbot, twisted, tmp_path / "report.html").rows
    state = twisted.session.store.state
    hull = convex_hull(state.frame.U)
    named = {name.split("\n")[0]: said for name, said in rows["Volume reduction"].items()}
    assert named["Convex hull volume"].split("\n")[1] == f"{format_significant(hull.volume, 4)}\u00a0cm³"
    assert rows["Volume"]["Self-intersections"] in ("none", "not checked")
    assert "cm" in rows["Size and mass"]["Bounding box"]
    assert "cm" in rows["Measurements"]["Geodesic 1"]
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "yet" not in re.sub(r'(?s)"data:[^"]*"', "", text)


@pytest.mark.night
def test_report_controller_says_that_a_report_is_asked_for_on_the_way_and_measures_what_is_shown(
    qtbot, twisted, tmp_path
):
    store = twisted.session.store
    twisted.session.handles.move_by(MOTIONS["TWIST"], "60", 0)
    assert not store.state.frame.settled
    shown = store.state.frame.U
    path = tmp_path / "report.html"
    page = write(qtbot, twisted, path)
    assert "had not converged when this report was created" in path.read_text(encoding="utf-8")
    named = {name.split("\n")[0]: said for name, said in page.rows["Volume reduction"].items()}
    hull = convex_hull(shown)
    assert named["Convex hull volume"].split("\n")[1] == f"{format_significant(hull.volume, 4)}\u00a0cm³"


def test_report_controller_leaves_what_is_on_screen_as_it_is(qtbot, bottle, tmp_path):
    settle(qtbot, bottle.canvas.viewport)
    view, before = bottle.canvas.viewport, bottle.canvas.viewport.screenshot(return_img=True)
    actors = view.renderer.GetActors().GetNumberOfItems()
    write(qtbot, bottle, tmp_path / "report.html")
    bottle.notice.hide()
    assert np.array_equal(view.screenshot(return_img=True), before)
    assert view.renderer.GetActors().GetNumberOfItems() == actors
    assert view.ren_win.GetRenderers().GetNumberOfItems() == 1


def test_report_controller_leaves_nothing_of_a_report_it_cannot_write(qtbot, bottle, tmp_path, monkeypatch):
    path = tmp_path / "file" / "report.html"
    path.parent.write_text("no folder")
    monkeypatch.setattr(file_dialogs, "ask_where_to_save_report", lambda *_: path)
    monkeypatch.setattr(ReportDialog, "exec", lambda _: True)
    bottle.actions_.file.report.trigger()
    qtbot.waitUntil(lambda: "cannot be written" in bottle.notice.text, timeout=30_000)
    assert [one.name for one in tmp_path.iterdir() if one.suffix != ".ini"] == ["file"]
    assert path.parent.read_text() == "no folder"


def test_report_has_the_title_and_customer_entered_which_are_proposed_again(
    qtbot, bottle, tmp_path, monkeypatch
):
    path, proposed = tmp_path / "report.html", []

    def enter(dialog):
        proposed.append((dialog.heading, dialog.report_title.placeholderText()))
        dialog.report_title.setText("Aqua 500 <draft>")
        dialog.customer.setText("ACME")
        return True

    monkeypatch.setattr(ReportDialog, "exec", enter)
    monkeypatch.setattr(file_dialogs, "ask_where_to_save_report", lambda *_: path)
    for _ in range(2):
        bottle.actions_.file.report.trigger()
        idle(qtbot, bottle)
    page = path.read_text(encoding="utf-8")
    assert "<h1>Aqua 500 &lt;draft&gt;</h1>" in page
    name = bottle.session.store.state.document.mesh.name
    assert f"Prepared for ACME · {name} · Report of a deformation" in page
    assert proposed == [(("", ""), name), (("Aqua 500 <draft>", "ACME"), name)]
    assert bottle.preferences.report_customer == "ACME"


def test_report_controller_can_be_given_up(qtbot, bottle, tmp_path):
    bottle.reports.write_report(tmp_path / "report.html")
    job = bottle.session.jobs.current
    bottle.session.jobs.cancel()
    job.join(30.0)
    work_off()
    assert not (tmp_path / "report.html").exists()


def test_preferences_propose_the_folder_of_what_was_written_last(qtbot, bottle, tmp_path):
    (tmp_path / "customer").mkdir()
    bottle.reports.write_report(tmp_path / "customer" / "report.html")
    idle(qtbot, bottle)
    qtbot.waitUntil(lambda: bottle.preferences.last_folder == tmp_path / "customer")
    bottle.session.files.export(tmp_path / "bent.obj", lambda: None)
    qtbot.waitUntil(lambda: bottle.preferences.last_folder == tmp_path)
    qtbot.waitUntil(bottle.notice.show_folder.isVisible)
