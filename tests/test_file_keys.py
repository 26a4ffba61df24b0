"""The keys of JSON, the columns of tables and the fields of reports that others rely on."""

import csv
import json
import re
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from immediate import Here
from meshes import tube
from painted_meshes import write_bar
from study_work import computed

from apd_viewer.__main__ import main
from apd_viewer.cases.comparison import MethodOutcome
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.selections.selection import Selection, selection_to_json
from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.geometry.measuring.measurement import Contents, Measurement, Plane
from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.geometry.measuring.surface_point import SurfacePoint
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.frame import FrameContact
from apd_viewer.geometry.pose.transforms import translation
from apd_viewer.presentation.method_readings import write_outcomes
from apd_viewer.session.model.handles_and_regions import (
    Handle,
    HandlePlacement,
    NamedPose,
    NamedRegion,
    PartFlags,
)
from apd_viewer.session.model.named_obstacle import NamedObstacle, ObstacleKind
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.timeline import Timeline
from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.session.model.view import CameraPose, View
from apd_viewer.session.quantities.wall import WallText
from apd_viewer.session.quantities.wall_material import WALL_MATERIALS
from apd_viewer.session.storage.session_file import save_session
from apd_viewer.session.storage.timeline_file import write_timeline


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A bar with its ends painted, the bar bent, and an open tube."""
    folder = tmp_path_factory.mktemp("keys")
    write_bar(folder)
    bar, other = open_mesh(folder / "bar.off"), Mesh(*tube(8, 4))
    save_mesh(bar, bar.V + 0.1 * bar.V[:, ::-1] ** 2, folder / "bent.off")
    save_mesh(other, other.V, folder / "open.off")
    np.savetxt(folder / "ring.txt", (bar.V[:, 2] > 3).astype(int), fmt="%d")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        yield folder


def keys(value):
    """A line of names for each object within a value, after the way to it."""
    lines = {}
    _collect(value, "", lines)
    return [f"{where}: {' '.join(names)}".removeprefix(": ") for where, names in lines.items()]


def _collect(value, where, lines):
    if isinstance(value, dict):
        lines.setdefault(where, {}).update(dict.fromkeys(value))
        for name, inner in value.items():
            _collect(inner, f"{where}.{name}".lstrip("."), lines)
    elif isinstance(value, list):
        for inner in value:
            _collect(inner, where, lines)


def run(words):
    assert main(words.split()) == 0


def json_keys(path):
    return keys(json.loads(path.read_text(encoding="utf-8")))


def columns(path):
    with path.open(encoding="utf-8") as stream:
        return [" ".join(next(csv.reader(stream)))]


def info(folder, capsys):
    run("info open.off --json --compare bent.off")
    return keys(json.loads(capsys.readouterr().out))


def deformation(folder, capsys):
    run(
        "deform bar.off --selection bar.sel --twist 20 --region ring ring.txt 101 --iterations 2"
        " --compare bent.off --report report.json -o moved.off"
    )
    return json_keys(folder / "report.json")


def vertices(folder, capsys):
    run("deform bar.off --selection bar.sel --push 1% --iterations 1 --scalars v.csv -o moved.off")
    return columns(folder / "v.csv")


def triangles(folder, capsys):
    run("deform bar.off --selection bar.sel --push 1% --iterations 1 --triangle-scalars t.csv -o moved.off")
    return columns(folder / "t.csv")


PRESS = (
    "press bar.off --axis z --to 90% --steps 1 --release --iterations 4 --stiffness 0.01 --unit mm"
    " --material pet-bottle -o pressed.off"
)


def timeline_table(folder, capsys):
    write_timeline(Timeline().with_state(initial_state(open_mesh("bar.off"))), Path("t.csv"), [(1.0, 1.0)])
    return columns(folder / "t.csv")


def press_curve(folder, capsys):
    run(f"{PRESS} --curve curve.csv")
    return columns(folder / "curve.csv")


def press_report(folder, capsys):
    run(f"{PRESS} --report pressed.json")
    return json_keys(folder / "pressed.json")


def sweep(folder, capsys):
    run("sweep bar.off --selection bar.sel --twist 20 --steps 1 --iterations 2 --methods arap -o swept")
    return columns(folder / "swept" / "sweep.csv")


def run_study(folder):
    (folder / "plan.csv").write_text("mesh,selection,motion,steps,iterations\nbar.off,bar.sel,twist 9,1,2\n")
    run("study plan.csv -o study --processes 1")


def study(folder, capsys):
    run_study(folder)
    return columns(folder / "study" / "results.csv")


def study_curves(folder, capsys):
    run_study(folder)
    return columns(folder / "study" / "curves.csv")


def volumes(folder, capsys):
    run("volumes bent.off --rest bar.off --unit cm --thickness 0.3mm --density 1.3 --json volumes.json")
    return json_keys(folder / "volumes.json")


def comparison(folder, capsys):
    write_outcomes(folder / "methods.csv", whole_state(), [("arap", MethodOutcome(whole_state().frame))])
    return columns(folder / "methods.csv")


def selection(folder, capsys):
    mesh = open_mesh("bar.off")
    labels = np.arange(len(mesh.V), dtype=np.uint8).clip(0, 2)
    chosen = Selection(labels, (labels == 1).astype(np.uint8), ("Top",), ("Ring",), (101.0,))
    return keys(json.loads(selection_to_json(mesh, chosen)))


def whole_state():
    """A state of which nothing is at its default."""
    mesh = open_mesh("bar.off")
    labels = np.loadtxt("bar.sel", dtype=np.uint8)
    state = initial_state(mesh, labels)
    flags, up = PartFlags(locked=True, hidden=True), frozen(np.array([0.0, 0.0, 1.0]))
    pose = frozen(translation(0.1 * up))
    handle = Handle("Top", pose, up, 0.5, (pose,), flags, (pose,), up)
    points = tuple(SurfacePoint(k, (1.0, 0.0, 0.0)) for k in range(2))
    document = replace(
        state.document,
        handles=(handle,),
        regions=(NamedRegion("Ring", 101.0, flags),),
        obstacles=(NamedObstacle("Plate", ObstacleKind.PLATE, -up, up),),
        base=flags,
        measurements=(
            Measurement("Span", MeasurementKind.DISTANCE, points),
            Measurement("Cut", MeasurementKind.SECTION, plane=Plane((0.0, 0.0, 1.0), 1.0)),
            Measurement("Level", MeasurementKind.FILL_LEVEL, contents=Contents((0.0, 0.0, 1.0), 1.0)),
        ),
        poses=(NamedPose("Start", (HandlePlacement("Top", pose, (pose,)),)),),
        closed_openings=(0,),
        mirror_axis=0,
        immobile_components=(0,),
        target_shape=TargetShape(mesh),
    )
    vectors = np.zeros((1, 3))
    frame = replace(
        state.frame,
        U=mesh.V + 0.1,
        share_reached=0.5,
        contact=FrameContact(1, 0.1, 0),
        loads=vectors,
        shifts=vectors,
        energy=1.0,
    )
    return replace(state, document=document, frame=frame)


def session(folder, capsys):
    eye = CameraPose((9.0, 3.0, 2.0), (0.0, 0.0, 2.0), (0.0, 0.0, 1.0), 0.5)
    wall = WallText("0.3mm", "1.3", "2GPa", "0.3", "5mm", WALL_MATERIALS[0])
    view = View(eye, "mm?", wall, "area", UpAxis.PLUS_Z)
    state = whole_state()
    save_session("whole.apd", state, view, timeline=Timeline().with_state(state))
    with zipfile.ZipFile(folder / "whole.apd") as archive:
        return keys(json.loads(archive.read("session.json")))


# By writer: names of the outermost objects or of the columns, then of those within, after the way there.
KEYS = {
    info: """
        mesh unit vertices faces pieces area volume why_no_volume volume_capped openings size double_wall
            findings self_intersections box_volume packed_volume packed_sides hull_volume minimum_width
            bulk_volume bulk_volume_range largest_distance rms_distance mean_distance largest_distance_back
            rms_distance_back mean_distance_back
        findings: kind sentence vertex_count vertices
    """,
    deformation: """
        mesh unit vertices faces method iterations converged area_rest area area_error area_target
            volume_rest volume volume_target volume_capped_rest volume_capped openings energy handle_drift
            regions local_change largest_edge_strain mean_edge_strain seconds factor_seconds
            seconds_per_iteration warnings convergence stable stability saddle_escapes share_reached
            least_gap pairs_in_contact loads shifts turned turned_held load_excess_percent
            self_intersections_rest box_volume_rest packed_volume_rest packed_sides_rest hull_volume_rest
            minimum_width_rest bulk_volume_rest bulk_volume_range_rest self_intersections box_volume
            packed_volume packed_sides hull_volume minimum_width bulk_volume bulk_volume_range target_shape
            largest_distance rms_distance mean_distance largest_distance_back rms_distance_back
            mean_distance_back largest_distance_by_vertex rms_distance_by_vertex mean_distance_by_vertex
        regions: name area_rest area area_target
        convergence: most_iterations energy_tolerance step_tolerance imperfection seed
    """,
    vertices: """
        vertex x y z apd_label apd_region area_change edge_strain bending displacement distance_to_rest
    """,
    triangles: """
        triangle a b c apd_label apd_region area_rest area area_change largest_stretch smallest_stretch
    """,
    timeline_table: """
        step distance deflection load_low load_high volume volume_capped area_error settled load_low_newton
            load_high_newton wall_distance wall_deflection wall_load_low wall_load_high wall_volume
            wall_volume_capped wall_area_error wall_settled wall_load_low_newton wall_load_high_newton unit
    """,
    press_curve: """
        distance load_low load_high load_excess_percent stretching_percent energy volume volume_capped
            area_error crossings iterations settled stable opening load_low_newton load_high_newton
            newton_factor
    """,
    press_report: """
        mesh vertices faces method stiffness yield_radius hardening gas pressure area_rest volume_rest
            volume_capped_rest distance load_low load_high load_excess_percent stretching_percent energy
            volume volume_capped area_error crossings iterations settled stable opening
            load_low_newton load_high_newton newton_factor
            stopped yield_load yield_deflection apparent_stiffness work unit material material_source
            wall_thickness density young poisson mass_grams newtons_per_load stiffness_of_wall
            yield_load_newton apparent_stiffness_newton_per_mm work_joule self_intersections_rest
            box_volume_rest packed_volume_rest packed_sides_rest hull_volume_rest minimum_width_rest
            bulk_volume_rest bulk_volume_range_rest self_intersections box_volume packed_volume packed_sides
            hull_volume minimum_width bulk_volume bulk_volume_range
    """,
    sweep: """
        method step part degrees way area area_error volume volume_capped volume_error energy local_change
            largest_edge_strain mean_edge_strain handle_drift iterations settled stable saddle_escapes
            share_reached turned turned_held
    """,
    study: """
        mesh selection motion steps iterations status sentence area_error volume volume_capped energy
            crossings seconds area area_rest volume_rest volume_error local_change
            largest_edge_strain mean_edge_strain handle_drift share_reached least_gap
            box_volume packed_volume hull_volume iterations unsettled_steps saddle_escapes turned turned_held
            line key
    """,
    study_curves: """
        line step part degrees way area area_error volume volume_capped volume_error energy local_change
            largest_edge_strain mean_edge_strain handle_drift share_reached turned turned_held
    """,
    volumes: """
        mesh rest unit packing packing_range bag_litres area enclosed_volume openings packed_volume
            packed_sides hull_volume minimum_width bulk_volume bulk_volume_range objects_in_bag
            objects_in_bag_range bulk_density bulk_density_range material_volume capacity brimful_volume
            fill_level freeboard spilled_volume area_rest
            enclosed_volume_rest openings_rest packed_volume_rest packed_sides_rest hull_volume_rest
            minimum_width_rest bulk_volume_rest bulk_volume_range_rest objects_in_bag_rest
            objects_in_bag_range_rest bulk_density_rest bulk_density_range_rest material_volume_rest
            capacity_rest brimful_volume_rest fill_level_rest freeboard_rest spilled_volume_rest published
        published: packed_sides bulk_volume objects_in_bag bulk_density material_volume
        published.packed_sides: words source unit low high
        published.bulk_volume: words source unit low high
        published.objects_in_bag: words source unit low high
        published.bulk_density: words source unit low high
        published.material_volume: words source unit low high
    """,
    comparison: """
        method area area_rest area_error area_miss volume volume_rest energy handle_drift local_change
            largest_edge_strain mean_edge_strain iterations converged seconds taken_from_window contact
    """,
    selection: """
        format version mesh base handles regions
        mesh: vertices faces digest
        handles: name vertices
        regions: name area vertices
    """,
    session: """
        format version program mesh target arrays document frame view timeline
        mesh: name vertices faces digest path sample relative embedded
        target: name vertices faces digest path sample relative embedded
        document: handles regions method stiffness area_stiffness shear_stiffness wall_thickness
            poisson tension_field area volume filled_volume tolerance hold_area calm contact thickness
            yield_radius hardening gas pressure convergence
            obstacles staying measurements closed base poses mirror
        document.handles: name pose pivot locked hidden waypoints earlier line falloff
        document.regions: name area locked hidden
        document.convergence: most_iterations energy_tolerance step_tolerance imperfection seed
        document.obstacles: name kind place axis radius length shift
        document.measurements: name kind points plane contents
        document.measurements.points: face weights
        document.measurements.plane: normal offset
        document.measurements.contents: up volume
        document.base: locked hidden
        document.poses: name handles
        document.poses.handles: name pose waypoints
        frame: iteration settled converged handle_drift unreached energy stable saddle_escapes share_reached
            contact loads shifts
        frame.contact: pairs least_gap exempt
        view: camera unit wall overlay unit_is_guess up_axis
        view.camera: position focal up angle
        view.wall: thickness density young poisson yield_radius material
        timeline: dropped shown documents wall_documents steps
        timeline.documents: handles regions method stiffness area_stiffness shear_stiffness wall_thickness
            poisson tension_field area volume filled_volume tolerance hold_area calm contact thickness
            yield_radius hardening gas pressure convergence
            obstacles staying base mirror labels grip
        timeline.documents.handles: name pose pivot locked hidden waypoints earlier line falloff
        timeline.documents.convergence: most_iterations energy_tolerance step_tolerance imperfection seed
        timeline.documents.obstacles: name kind place axis radius length shift
        timeline.documents.base: locked hidden
        timeline.steps: document shape frame begins_run
        timeline.steps.frame: iteration settled converged handle_drift unreached energy stable saddle_escapes
            share_reached contact loads shifts
        timeline.steps.frame.contact: pairs least_gap exempt
    """,
}


@pytest.mark.parametrize("writer", KEYS)
def test_file_keys_are_those_that_others_rely_on(writer, folder, monkeypatch, capsys):
    monkeypatch.setattr("apd_viewer.commands.study_command.LocalPool", lambda _: Here(computed))
    monkeypatch.setattr("apd_viewer.figures.curves.draw_sweep_curves", lambda *_, **__: None)
    promised = re.sub(r"\n {12}", " ", KEYS[writer])
    assert writer(folder, capsys) == [line.strip() for line in promised.strip().splitlines()]


PLAN = """
mesh,session,selection,motion,unit,steps,method,stiffness,area_stiffness,shear_stiffness,area,volume,tolerance,hold_area,calm,contact,thickness,to,iterations
bar.off,,bar.sel,twist 9,mm,1,exact,0.1,,,101,,,,,,,50%,2
"""


def test_file_keys_of_a_plan_are_understood(folder, capsys):
    (folder / "whole.csv").write_text(PLAN.strip())
    run("study whole.csv -o never --dry-run")
    assert capsys.readouterr().err == ""
