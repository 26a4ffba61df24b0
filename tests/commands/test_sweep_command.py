"""The command that sweeps: what it writes, and that it writes all of it or nothing."""

import csv
import gc
import re
from dataclasses import replace

import numpy as np
import pytest
import pyvista
import trimesh
from animated import read_pc2
from lacking import lack
from meshes import ends, grid, tube
from painted_meshes import write_bar
from PIL import Image

from apd_viewer.__main__ import main
from apd_viewer.commands import sweep_command
from apd_viewer.figures.films import write_film
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.analysis.inspection import inspect
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.geometry.pose.transforms import rotation_about
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.session.model.view import CameraPose, View
from apd_viewer.session.storage.session_file import open_session, save_session

BENT = rotation_about([1, 1, 0], [1, 0, 0], 0.6)


@pytest.fixture
def bar(tmp_path):
    """The words for a bar: a mesh with its selection."""
    write_bar(tmp_path)
    np.savetxt(tmp_path / "bent.def", BENT)
    return [tmp_path / "bar.off", "--selection", tmp_path / "bar.sel"]


@pytest.fixture
def session(bar, tmp_path):
    """A session in which the bar is bent."""
    state = initial_state(open_mesh(bar[0]), np.loadtxt(bar[2], dtype=np.uint8))
    path = tmp_path / "bar.apd"
    view = View(CameraPose((9.0, 3.0, 2.0), (0.0, 0.0, 2.0), (0.0, 0.0, 1.0), 0.5))
    save_session(path, state.updated(state.document.with_pose(0, BENT)), view)
    return path


@pytest.fixture
def drawn_sweep(tmp_path, capsys):
    """Run the command; return its status, what it said and the folder."""

    def run(*words, folder=tmp_path / "out"):
        status = main(["sweep", *map(str, words), "-o", str(folder)])
        said = capsys.readouterr()
        return status, said.out, said.err, folder

    return run


@pytest.fixture
def sweep(drawn_sweep, undrawn_sweeps):
    """Run the command without its figures."""
    return drawn_sweep


def read(folder):
    with (folder / "sweep.csv").open(encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def test_sweep_command_gives_the_same_curves_by_a_session_and_by_its_mesh(bar, session, sweep, tmp_path):
    words = "--steps", 4, "--methods", "arap,exact"
    assert sweep(session, *words, folder=tmp_path / "a")[0] == 0
    assert sweep(*bar, "--transform", tmp_path / "bent.def", *words, folder=tmp_path / "b")[0] == 0
    one, other = read(tmp_path / "a"), read(tmp_path / "b")
    assert one == other
    assert [(line["method"], float(line["part"])) for line in one] == [
        (method, k / 4) for method in ("arap", "exact") for k in range(5)
    ]


def test_sweep_command_writes_the_meshes_of_its_table(session, sweep):
    status, said, err, folder = sweep(session, "--steps", 2, "--methods", "exact", "--meshes")
    assert (status, err) == (0, "")
    assert re.search(r"Exact: area 0.00 % at the end", said)
    lines = read(folder)
    paths = sorted((folder / "meshes").iterdir())
    assert [path.name for path in paths] == ["exact-000.off", "exact-001.off", "exact-002.off"]
    for line, path in zip(lines, paths, strict=True):
        shape = trimesh.load(path, process=False)
        assert shape.area == pytest.approx(float(line["area"]), rel=1e-9)
        assert shape.volume == pytest.approx(float(line["volume"]), rel=1e-9)


def write_tube(bar, V, F):
    """Write a tube in place of the bar, and return its length."""
    trimesh.Trimesh(V, F, process=False).export(bar[0])
    labels = np.ones(len(V), dtype=int)
    base, handle = ends(V)
    labels[base], labels[handle] = 0, 2
    np.savetxt(bar[2], labels, fmt="%d")
    return np.ptp(V[:, 2])


def test_sweep_command_says_that_contact_stops_a_handle(bar, sweep):
    """The table has how far it was asked to go, and how much of that it went."""
    height = write_tube(bar, *tube(8, 5))
    words = "--push", "120%", "--methods", "exact", "--steps", 1, "--iterations", 6
    status, said, _, folder = sweep(*bar, *words)
    first, last = read(folder)
    way = pytest.approx(1.2 * height)
    assert (status, float(first["share_reached"]), float(last["way"])) == (0, 1.0, way)
    assert 0.3 < float(last["share_reached"]) < 0.9
    assert f"Contact stops the handle at {int(100 * float(last['share_reached']))} % of the path." in said


@pytest.mark.night
def test_sweep_command_draws_a_figure_and_a_film(bar, drawn_sweep, tmp_path):
    film = tmp_path / "film.gif"
    status, _, err, folder = drawn_sweep(
        *bar, "--twist", "200deg", "--steps", 2, "--methods", "arap,exact", "--animation", film
    )
    assert (status, err) == (0, "")
    assert {path.name for path in folder.iterdir()} == {"sweep.csv", "sweep.svg", "sweep.png"}
    assert float(read(folder)[-1]["degrees"]) == pytest.approx(200)
    with Image.open(film) as image:
        assert image.n_frames == 4, "there and back"
        first = np.asarray(image.convert("L"), dtype=int)
        image.seek(2)
        last = np.asarray(image.convert("L"), dtype=int)
    width = first.shape[1] // 2
    for half in (slice(0, width), slice(width, None)):
        assert (np.abs(first - last)[:, half] > 20).sum() > 300, "nothing moves"
    with Image.open(folder / "sweep.png") as image:
        colors = np.asarray(image.convert("RGB")).reshape(-1, 3)
    for color in ((0, 114, 178), (213, 94, 0)):  # of Exact and of ARAP
        assert (colors == color).all(axis=1).sum() > 100


@pytest.mark.extra
@pytest.mark.parametrize(("up_axis", "staged"), [(UpAxis.PLUS_Z, "Z"), (UpAxis.PLUS_Y, "Y")])
def test_sweep_command_writes_usd_in_the_unit_and_with_the_up_axis_of_the_session(
    up_axis, staged, session, sweep, tmp_path
):
    from pxr import Usd, UsdGeom

    state, view = open_session(session)
    save_session(session, state, replace(view, unit="cm", up_axis=up_axis))
    words = "--steps", 2, "--methods", "exact", "--meshes"
    status, _, err, folder = sweep(session, *words, "--animation", tmp_path / "a.usdc")
    assert (status, err) == (0, "")
    stage = Usd.Stage.Open(str(tmp_path / "a.usdc"))
    assert UsdGeom.GetStageMetersPerUnit(stage) == pytest.approx(0.01)
    assert UsdGeom.GetStageUpAxis(stage) == staged
    points = UsdGeom.Mesh(stage.GetDefaultPrim()).GetPointsAttr()
    for k, path in enumerate(sorted((folder / "meshes").iterdir())):
        assert np.array_equal(points.Get(k), open_mesh(path).V.astype(np.float32))


def test_sweep_command_writes_animations_of_the_meshes_of_its_steps(session, sweep, tmp_path):
    """Of one method under the name given, in the output folder and beside it."""
    out, names = tmp_path / "out", ("a.pc2", "a.mdd", "a.glb", "a.pvd")
    words = [word for name in names for word in ("--animation", out / name)]
    words += ["--animation", tmp_path / "b.pc2", "--animation", tmp_path / "b.pvd"]
    status, _, err, folder = sweep(session, "--steps", 3, "--methods", "exact", "--meshes", *words)
    assert (status, err) == (0, "")
    meshes = [open_mesh(path).V for path in sorted((folder / "meshes").iterdir())]
    assert np.array_equal(read_pc2(folder / "a.pc2"), np.array(meshes, dtype=np.float32))
    assert (folder / "a.pc2").read_bytes() == (tmp_path / "b.pc2").read_bytes()
    assert len((folder / "a.mdd").read_bytes()) == 8 + 4 * 4 + 12 * np.array(meshes)[..., 0].size
    np.testing.assert_allclose(open_mesh(folder / "a.glb").V, meshes[0], atol=1e-6)
    for series in (folder / "a.pvd", tmp_path / "b.pvd"):
        reader = pyvista.get_reader(series)
        assert reader.time_values == pytest.approx([0, 1 / 3, 2 / 3, 1])
        reader.set_active_time_point(3)
        grid = reader.read()[0]
        np.testing.assert_allclose(grid.points, meshes[3], atol=1e-12)
        assert grid.point_data["apd_label"].tolist() == np.loadtxt(tmp_path / "bar.sel").tolist()
    assert {path.name for path in tmp_path.iterdir()} == {
        *("bar.off", "bar.sel", "bent.def", "bar.apd", "out", "b.pc2", "b.pvd", "b"),
    }


@pytest.mark.parametrize("where", ["out", "."])
def test_sweep_command_replaces_a_longer_series_by_a_shorter_one(where, session, sweep, tmp_path):
    """With all its files, in the output folder and beside it, but with no others."""
    path = tmp_path / where / "a.pvd"
    for steps in (3, 1):
        words = "--steps", steps, "--methods", "exact", "--animation", path
        assert sweep(session, *words)[0] == 0
        (path.with_suffix("") / "a-7.vtu").write_text("mine")
    assert {each.name for each in path.with_suffix("").iterdir()} == {"a-0.vtu", "a-1.vtu", "a-7.vtu"}
    assert pyvista.get_reader(path).time_values == [0, 1]


def test_sweep_command_gives_each_method_an_animation_of_its_own(session, sweep, tmp_path):
    words = "--steps", 2, "--methods", "arap,exact", "--meshes", "--animation", tmp_path / "a.pc2"
    status, _, err, folder = sweep(session, *words)
    assert (status, err) == (0, "")
    for method in ("arap", "exact"):
        meshes = [open_mesh(path).V for path in sorted((folder / "meshes").glob(f"{method}-*"))]
        assert np.array_equal(read_pc2(tmp_path / f"a-{method}.pc2"), np.array(meshes, dtype=np.float32))
    assert not (tmp_path / "a.pc2").exists()


def test_sweep_command_writes_the_same_files_when_repeated(session, drawn_sweep, tmp_path):
    for name in ("a", "b"):
        assert drawn_sweep(session, "--steps", 2, "--methods", "exact", folder=tmp_path / name)[0] == 0
    for name in ("sweep.csv", "sweep.svg", "sweep.png"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def test_sweep_command_caps_the_volume_of_an_open_surface(bar, drawn_sweep, tmp_path):
    write_tube(bar, *tube())
    status, said, err, folder = drawn_sweep(*bar, "--push", "20%", "--steps", 2, "--methods", "arap,exact")
    assert (status, err) == (0, "")
    assert {line["volume"] for line in read(folder)} == {""}
    capped = [float(line["volume_capped"]) for line in read(folder) if line["method"] == "exact"]
    rest = inspect(open_mesh(bar[0])).volume_capped
    changes = [float(line["volume_error"]) for line in read(folder) if line["method"] == "exact"]
    np.testing.assert_allclose(changes, np.array(capped) / rest - 1, atol=1e-12)
    assert abs(changes[-1]) > 0.01
    assert f"volume {100 * changes[-1]:+.2f} %, openings capped flat" in said
    with Image.open(folder / "sweep.png") as image:
        assert image.width > image.height


def test_sweep_command_counts_shapes_that_do_not_settle(session, sweep):
    _, said, _, folder = sweep(session, "--steps", 3, "--methods", "exact", "--iterations", 1)
    unsettled = sum(line["settled"] == "0" for line in read(folder))
    assert unsettled > 0
    assert f"{unsettled} of 4 shapes did not converge within 1 iterations" in said


@pytest.mark.usefixtures("without_opengl")
def test_sweep_command_without_opengl_writes_no_film_and_all_else(session, drawn_sweep, tmp_path):
    film = tmp_path / "film.gif"
    status, said, _, folder = drawn_sweep(session, "--steps", 2, "--methods", "arap", "--animation", film)
    assert status == 0
    assert "The shapes were not drawn" in said
    assert not film.exists()
    assert (folder / "sweep.svg").exists()


WRONG = {
    "no selection": (lambda bar: bar[:1], "is not a session; give a .apd file, or --selection"),
    "no motion": (lambda bar: bar, "is not a session; give a .apd file, or --selection"),
    "both": (lambda bar: [*bar, "--twist", "9", "--transform", bar[0].parent / "bent.def"], "not both"),
    "a film of another kind": (
        lambda bar: [*bar, "--twist", "9", "--animation", "a.webm"],
        "use .gif, .mp4, .pc2, .mdd, .glb, .usda, .usdc, .usdz or .pvd",
    ),
    "an animation in no folder": (
        lambda bar: [*bar, "--twist", "9", "--animation", bar[0].parent / "gone" / "a.pc2"],
        "There is no folder",
    ),
    "an animation twice": (
        lambda bar: [*bar, "--twist", "9", *["--animation", bar[0].parent / "a.pc2"] * 2],
        "would be written twice; give each file a name of its own",
    ),
    "an animation by a method that is none": (
        lambda bar: [*bar, "--twist", "9", "--methods", "arap,x/y", "--animation", "a.pc2"],
        "Unknown method 'x/y'",
    ),
    "a series beside a file of its name": (
        lambda bar: [
            *bar,
            "--methods",
            "arap",
            "--twist",
            "9",
            "--animation",
            bar[0].with_suffix(".sel.pvd"),
        ],
        "which is a file",
    ),
    "an angle that is none": (lambda bar: [*bar, "--twist", "9mm"], "unit of length"),
    "a method that is none": (
        lambda bar: [*bar, "--twist", "9", "--methods", "arap,x"],
        "Unknown method 'x'",
    ),
    "too many motions": (
        lambda bar: [*bar, *["--transform", bar[0].parent / "bent.def"] * 2],
        "1 handles but 2 motions",
    ),
    "steps": (lambda bar: [*bar, "--twist", "9", "--steps", "0"], "1 to 1000 steps"),
    "no mesh": (lambda bar: ["gone.obj", "--selection", bar[2], "--twist", "9"], "There is no file gone.obj"),
    "a session with a selection": (lambda bar: ["a.apd", *bar[1:]], "its own paint and motion"),
    "no such session": (lambda _: ["a.apd"], "There is no file a.apd"),
}


@pytest.mark.parametrize("case", WRONG)
def test_sweep_command_says_what_is_wrong_in_a_line_and_writes_nothing(case, bar, sweep, tmp_path):
    words, said = WRONG[case]
    before = sorted(tmp_path.rglob("*"))
    status, out, err, _ = sweep(*words(bar))
    assert (status, out) == (2, "")
    assert re.fullmatch(r"error: .+\n", err)
    assert said in err
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize(("name", "said"), [("a.pvd", "which is a file"), ("b.gif", "(it is a folder)")])
def test_sweep_command_says_before_work_what_is_in_the_way_in_the_output(
    name, said, session, sweep, tmp_path, monkeypatch
):
    monkeypatch.setattr(sweep_command, "case_steps", lambda *_: pytest.fail("it has begun"))
    (tmp_path / "out" / "b.gif").mkdir(parents=True)
    (tmp_path / "out" / "a").write_text("mine")
    status, _, err, _ = sweep(session, "--methods", "exact", "--animation", tmp_path / "out" / name)
    assert status == 2
    assert said in err


def test_sweep_command_leaves_nothing_when_interrupted(session, sweep, tmp_path, monkeypatch):
    before = sorted(tmp_path.rglob("*"))

    def stop(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(sweep_command.Progress, "show", stop)
    assert sweep(session, "--steps", 2)[0] == 130
    assert sorted(tmp_path.rglob("*")) == before


def test_sweep_command_keeps_other_files_in_the_folder(session, sweep, tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    (folder / "notes.txt").write_text("mine")
    (folder / "sweep.csv").write_text("old")
    assert sweep(session, "--steps", 1, "--methods", "arap")[0] == 0
    assert (folder / "notes.txt").read_text() == "mine"
    assert len(read(folder)) == 2


@pytest.mark.extra
@pytest.mark.filterwarnings("ignore:unclosed file", "ignore::pytest.PytestUnraisableExceptionWarning")
def test_write_film_writes_mp4_there_and_back(tmp_path):
    import imageio_ffmpeg

    pictures = []
    for shade in (0, 120, 240):
        pictures.append(tmp_path / f"{shade}.png")
        Image.new("RGB", (64, 48), (shade, shade, shade)).save(pictures[-1])
    write_film(pictures, tmp_path / "film.mp4")
    frames = imageio_ffmpeg.read_frames(str(tmp_path / "film.mp4"))
    assert next(frames)["source_size"] == (64, 48)
    shades = [np.frombuffer(frame, np.uint8).mean() for frame in frames]
    assert shades[0] == pytest.approx(0, abs=8)
    assert max(shades) == pytest.approx(240, abs=8)
    assert shades[-1] == pytest.approx(120, abs=8), "there and back"
    gc.collect()  # the library leaves its pipes open until then


def test_sweep_command_refuses_mp4_without_an_encoder(bar, sweep, tmp_path, monkeypatch):
    lack(monkeypatch, "imageio_ffmpeg")
    status, _, err, folder = sweep(*bar, "--twist", 9, "--animation", tmp_path / "film.mp4")
    assert status == 2
    assert "install apd-viewer[video]" in err
    assert not folder.exists()


def test_sweep_leaves_saddles_unless_the_imperfection_is_zero(drawn_sweep, tmp_path):
    V, F = grid(8, 4)
    save_mesh(Mesh(V, F), V, tmp_path / "sheet.off")
    np.savetxt(
        tmp_path / "sheet.sel", np.where(V[:, 0] == 0.0, BASE, np.where(V[:, 0] == 8.0, HANDLE, FREE)), "%d"
    )
    words = (tmp_path / "sheet.off", "--selection", tmp_path / "sheet.sel", "--push", "20%", "--steps", 1)
    read = {}
    for imperfection in (0, 0.001):
        status, *_, folder = drawn_sweep(*words, "--methods", "arap", "--imperfection", imperfection)
        assert status == 0
        read[imperfection] = list(csv.DictReader((folder / "sweep.csv").read_text().splitlines()))[-1]
    assert (read[0]["stable"], read[0]["saddle_escapes"]) == ("0", "0")
    assert (read[0.001]["stable"], read[0.001]["saddle_escapes"]) == ("1", "1")
    assert float(read[0.001]["energy"]) < 0.5 * float(read[0]["energy"])
    status, _, err, _ = drawn_sweep(*words, "--imperfection", 2)
    assert status == 2
    assert "The imperfection must be a number from 0 to 0.1, such as 1e-4." in err
