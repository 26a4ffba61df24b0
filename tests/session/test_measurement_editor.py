"""Measurements of a session: undo, files, and geodesics that are known only when the shape rests."""

import json
import zipfile

import numpy as np
import pytest
from driven_session import BENT, VIEW
from meshes import box_with_openings

from apd_viewer.__main__ import main
from apd_viewer.commands.replay_command import measurements_report
from apd_viewer.errors import InputError
from apd_viewer.files.tables import unescaped_cell
from apd_viewer.geometry.measuring.geodesics import geodesic_path, path_length
from apd_viewer.geometry.measuring.measurement import Contents, Measurement, Plane, measure
from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.geometry.measuring.sections import plane_section
from apd_viewer.geometry.measuring.surface_point import SurfacePoint, point_positions
from apd_viewer.geometry.measuring.vessel import Vessel
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.presentation import measurement_text as words
from apd_viewer.session.measurement_readings import MeasurementReading, complete_readings
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.storage.session_file import open_session, save_session

MIDDLE = (0.25, 0.5, 0.25)
POINTS = SurfacePoint(3, MIDDLE), SurfacePoint(40, MIDDLE), SurfacePoint(61, MIDDLE)
COLD = 120.0  # s; the process may have to compile its kernels
HALF = Plane((0.0, 0.0, 1.0), 2.5)


def measure_all(session):
    session.measurements.add(MeasurementKind.DISTANCE, POINTS[:2])
    session.measurements.add(MeasurementKind.ANGLE, POINTS)
    session.measurements.add(MeasurementKind.GEODESIC, POINTS[:2])
    session.measurements.add(MeasurementKind.SECTION, plane=HALF)
    session.measurements.add(MeasurementKind.FILL_LEVEL, plane=HALF)


def readings(session):
    return session.measurement_readings.readings(session.store.state)


def test_measurement_editor_are_named_renamed_removed_and_undone(session):
    before = session.store.state
    measure_all(session)
    session.measurements.add(MeasurementKind.DISTANCE, POINTS[1:])
    session.measurements.rename(0, "Section 1")

    def names():
        return [each.name for each in session.store.state.document.measurements]

    assert names() == ["Section 1 2", "Angle 1", "Geodesic 1", "Section 1", "Fill level 1", "Distance 2"]
    session.measurements.rename(0, "Neck")
    session.measurements.remove(3)
    session.measurements.remove(3)
    assert names() == ["Neck", "Angle 1", "Geodesic 1", "Distance 2"]
    session.measurements.clear()
    assert names() == []
    assert session.gestures.history.next_undo_name == "Remove all measurements"
    done = len(session.gestures.history.undo_names)
    session.measurements.clear()
    assert len(session.gestures.history.undo_names) == done
    session.gestures.undo()
    assert names() == ["Neck", "Angle 1", "Geodesic 1", "Distance 2"]
    while session.store.state is not before:
        session.gestures.undo()
    assert names() == []


def test_measurement_editor_have_a_limit(session):
    for _ in range(100):
        session.measurements.add(MeasurementKind.SECTION, plane=HALF)
    session.measurements.add(MeasurementKind.SECTION, plane=HALF)
    assert len(session.store.state.document.measurements) == 100
    assert "100" in session.failed[-1]


def test_measurement_readings_follow_the_shape_and_geodesics_wait_until_it_rests(session):
    measure_all(session)
    session.until(lambda: readings(session)[2].now.values[0] is not None, COLD)
    mesh = session.store.state.document.mesh
    rest = geodesic_path(mesh.V, mesh.joined_F, *POINTS[:2])
    assert readings(session)[2].rest.values == pytest.approx((path_length(rest),))
    assert readings(session)[3].rest.values == pytest.approx((8.0, 4.0, 10.0))
    session.gestures.begin()
    session.handles.drag(BENT)
    session.until(lambda: session.U is not mesh.V)
    distance, _, geodesic, *_ = readings(session)
    p, q = point_positions(POINTS[:2], session.U, mesh.F)
    assert distance.now.values == pytest.approx((np.linalg.norm(p - q),))
    assert geodesic.now.values == (None,)  # the old length would be wrong
    assert len(geodesic.now.segments)  # its path is carried along
    session.handles.end_drag(0)
    session.settle()
    session.until(lambda: readings(session)[2].now.values[0] is not None, COLD)
    now = path_length(geodesic_path(session.U, mesh.joined_F, *POINTS[:2]))
    assert readings(session)[2].now.values == pytest.approx((now,))
    assert readings(session)[2].rest.values == pytest.approx((path_length(rest),))


def test_measurement_editor_ask_nothing_of_the_solver(session):
    session.drag(BENT)
    session.settle()
    U, activity = session.U, session.store.activity
    session.measurements.add(MeasurementKind.DISTANCE, POINTS[:2])
    assert session.U is U
    assert session.store.activity is activity


def test_measurement_editor_are_kept_in_a_session_file(session, tmp_path):
    measure_all(session)
    save_session(tmp_path / "bar.apd", session.store.state, VIEW, embed=True)
    found = open_session(tmp_path / "bar.apd")[0].document.measurements
    assert found == session.store.state.document.measurements


def test_save_session_says_nothing_about_measurements_without_any(session, tmp_path):
    save_session(tmp_path / "bar.apd", session.store.state, VIEW, embed=True)
    with zipfile.ZipFile(tmp_path / "bar.apd") as archive:
        assert "measurements" not in json.loads(archive.read("session.json"))["document"]
    assert open_session(tmp_path / "bar.apd")[0].document.measurements == ()


@pytest.mark.parametrize(
    "damage",
    [
        {"kind": "volume"},
        {"points": []},
        {"points": [{"face": 10**6, "weights": MIDDLE}] * 2},
        {"points": [{"face": 0, "weights": [2.0, -1.0, 0.0]}] * 2},
        {"kind": "section", "plane": {"normal": [0, 0, 0], "offset": 1}},
    ],
)
def test_open_session_refuses_damaged_measurements_in_a_sentence(session, tmp_path, damage):
    session.measurements.add(MeasurementKind.DISTANCE, POINTS[:2])
    path = tmp_path / "bar.apd"
    save_session(path, session.store.state, VIEW, embed=True)
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    said = json.loads(members["session.json"])
    said["document"]["measurements"][0].update(damage)
    members["session.json"] = json.dumps(said).encode()
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    with pytest.raises(InputError, match=r"is not a valid session"):
        open_session(path)


def test_replay_reports_the_measurements(session, tmp_path):
    measure_all(session)
    session.drag(BENT)
    session.settle()
    path = tmp_path / "bar.apd"
    save_session(path, session.store.state, VIEW, embed=True)
    command = ["replay", str(path), "-o", str(tmp_path / "bar.obj"), "--report", str(tmp_path / "bar.json")]
    assert main(command) == 0
    said = json.loads((tmp_path / "bar.json").read_text())["measurements"]
    assert [each["kind"] for each in said] == ["distance", "angle", "geodesic", "section", "level"]
    distance, angle, geodesic, section, filled = said
    p, q, r = point_positions(POINTS, session.U, session.store.state.document.mesh.F)
    assert distance["length"] == pytest.approx(np.linalg.norm(p - q))
    a, b = p - q, r - q
    cosine = a @ b / np.linalg.norm(a) / np.linalg.norm(b)
    assert angle["angle"] == pytest.approx(np.degrees(np.arccos(cosine)))
    assert geodesic["length"] >= distance["length"]
    assert (section["length_rest"], section["area_rest"]) == pytest.approx((8.0, 4.0))
    assert section["volume_below_rest"] == pytest.approx(4.0 * HALF.offset)
    height = session.store.state.document.mesh.V[:, 2]
    assert filled["level_rest"] == pytest.approx(HALF.offset - height.min(), rel=1e-9)
    assert filled["freeboard_rest"] == pytest.approx(height.max() - HALF.offset, rel=1e-9)
    assert filled["spilled"] == 0.0
    below = Plane(HALF.normal, session.U[:, 2].min() + filled["level"])
    F = session.store.state.document.mesh.joined_F
    assert plane_section(session.U, F, below.offset * np.array(below.normal), below.normal).volume_below == (
        pytest.approx(4.0 * HALF.offset, rel=1e-9)
    )  # the same liquid in the bent bar


def test_measurement_editor_changes_the_contents_of_a_fill_level(session):
    session.measurements.add(MeasurementKind.FILL_LEVEL, plane=HALF)
    whole = session.store.state.inspection.volume
    session.measurements.fill(0, whole + 3.0)
    level, freeboard, spilled = readings(session)[0].now.values
    assert (freeboard, spilled) == (0.0, pytest.approx(3.0))
    assert level == pytest.approx(np.ptp(session.store.state.document.mesh.V[:, 2]))
    session.gestures.undo()
    assert readings(session)[0].now.values[2] == 0.0
    document = session.store.state.document
    path_up = Contents((0.0, 0.0, 1.0), document.measurements[0].contents.volume)
    assert document.measurements[0].contents == path_up


def test_measurement_editor_refuses_to_fill_what_holds_nothing(session, tmp_path):
    m = session.store.state.document.mesh
    F = m.F[~(m.V[m.F][:, :, 2] < m.V[:, 2].min() + 1e-9).all(axis=1)]  # without its bottom
    measured = Measurement("Open below", MeasurementKind.FILL_LEVEL, contents=Contents((0.0, 0.0, 1.0), 1.0))
    assert np.isnan(measure(measured, m.V, F).values).all()
    reading = MeasurementReading(measured, *2 * [measure(measured, m.V, F)])
    assert "holds nothing this way up" in words.detail_text(reading, Unit.NONE)


def test_measurement_editor_closes_openings_and_opens_them_again(session, tmp_path):
    mesh = Mesh(*box_with_openings())
    session.show_now(mesh)
    low, high = Vessel.openings(mesh.V, mesh.F, (0.0, 0.0, 1.0))
    session.measurements.add(MeasurementKind.FILL_LEVEL, plane=Plane((0.0, 0.0, 1.0), 9.0))
    assert readings(session)[0].now.values == pytest.approx((3.0, 0.0, 0.0))
    session.measurements.fill(0, 80.0)
    assert readings(session)[0].now.values == pytest.approx((3.0, 0.0, 20.0))
    session.measurements.toggle_opening(np.array([low]))
    assert readings(session)[0].now.values == pytest.approx((4.0, 2.0, 0.0))
    start, stop = readings(session)[0].now.segments.transpose(1, 0, 2)
    around = np.linalg.norm(stop - start, axis=1).sum()
    assert around == pytest.approx(18.0)  # around the whole box, over the cap, too
    path = tmp_path / "box.apd"
    save_session(path, session.store.state, VIEW, embed=True)
    assert open_session(path)[0].document.closed_openings == (low,)
    assert measurements_report(open_session(path)[0].document, mesh.V)["measurements"][0]["level"] == 4.0
    session.measurements.toggle_opening(np.array([high]))
    assert readings(session)[0].now.values == pytest.approx((4.0, 6.0, 0.0))
    session.gestures.undo()
    session.measurements.toggle_opening(np.array([low]))
    assert readings(session)[0].now.values == pytest.approx((3.0, 0.0, 20.0))
    assert session.gestures.history.next_undo_name == "Open opening"


def test_measurement_words_tell_values_changes_and_what_is_missing(session):
    measure_all(session)
    session.measurements.add(MeasurementKind.SECTION, plane=Plane((0.0, 0.0, 1.0), 100.0))
    session.until(lambda: readings(session)[2].now.values[0] is not None, COLD)
    session.drag(BENT)
    session.settle()
    said = readings(session)
    assert words.short_text(said[2], Unit.MILLIMETRE) == "…"
    assert "stops moving" in words.detail_text(said[2], Unit.MILLIMETRE)
    assert "misses" in words.detail_text(said[5], Unit.NONE)
    now, rest = said[3].now.values, said[3].rest.values
    by = 100 * (now[1] / rest[1] - 1)
    change = f"{by:+.2f} %".replace("-", "−")
    assert words.detail_text(said[3], Unit.MILLIMETRE).splitlines()[1] == (
        f"Enclosed area: {now[1]:.4f}\N{NO-BREAK SPACE}mm², {change} from 4.0000\N{NO-BREAK SPACE}mm²"
    )
    rows = words.measurement_report_rows(said, Unit.NONE)
    assert rows[2][:2] == ("Geodesic 1", "…")
    done = complete_readings(said, session.store.state)
    assert (
        words.measurement_report_rows(done, Unit.NONE)[2][1]
        == words.short_text(done[2], Unit.NONE).split("  ")[0]
    )
    session.until(lambda: readings(session)[2].now.values[0] is not None, COLD)
    assert done[2].now.values == pytest.approx(readings(session)[2].now.values, rel=1e-9)
    assert "°" in rows[1][1]


def test_measurement_words_keep_a_name_text_in_the_spreadsheet_it_is_copied_to(session):
    session.measurements.add(MeasurementKind.DISTANCE, POINTS[:2])
    session.measurements.rename(0, "=1+1\t@x")
    line = words.value_table(readings(session), Unit.MILLIMETRE).splitlines()[1]
    assert not [cell for cell in line.split("\t") if cell[:1] in ("=", "@")]
    assert unescaped_cell(line).startswith("=1+1\t@x\t")
