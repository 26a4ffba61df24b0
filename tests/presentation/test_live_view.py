"""Views in notebooks without a notebook: what the page asks, what it gets, and what scripts read."""

import base64
import gc
import sys
import threading
import time
from operator import attrgetter, methodcaller
from types import ModuleType

import meshes
import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

import apd_viewer
from apd_viewer.files.picture_files import read_png
from apd_viewer.presentation.live_solver import LiveSolver
from apd_viewer.presentation.live_view import LiveView

V, F = meshes.box(2, 2, 6)
MESH = apd_viewer.Mesh(V, F)
BASE, HANDLE = meshes.ends(V)
CENTRE = (V.min(axis=0) + V.max(axis=0)) / 2


@pytest.fixture
def view():
    return LiveView(MESH, BASE, HANDLE)


def settled(view):
    """Ask as the page does until the shape rests; the last answer and the last positions."""
    told, ended, positions = {"number": 0}, time.monotonic() + 60, None
    while told.get("isAtWork", True):
        assert time.monotonic() < ended
        told, arrays = view.answer({"op": "next", "number": told["number"]})
        positions = np.frombuffer(arrays[0], "<f4").reshape(-1, 3) if arrays else positions
    return told, positions


def paint(view, label, ids):
    return view.answer({"op": "paint", "label": label}, [memoryview(np.asarray(ids, "<u4").tobytes())])[0]


def pose(rotation=(0, 0, 0), shift=(0, 0, 0)):
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = Rotation.from_rotvec(rotation).as_matrix(), shift
    return matrix


def test_live_names_the_extra_where_it_is_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "anywidget", None)
    with pytest.raises(apd_viewer.InputError, match=r'pip install "apd-viewer\[notebook\]"'):
        apd_viewer.live(MESH)


@pytest.mark.parametrize("settings", [{}, {"method": "local"}, {"method": "arap", "contact": False}], ids=str)
def test_live_view_has_the_result_of_deform_bit_for_bit(settings):
    view = LiveView(MESH, BASE, HANDLE, **settings)
    view.move(pose((0, 0, 0.4), (0.3, 0, 0.2)))
    fixed = np.concatenate([BASE, HANDLE])
    turned = V[HANDLE] @ Rotation.from_rotvec((0, 0, 0.4)).as_matrix().T + [0.3, 0, 0.2]
    order = np.argsort(fixed)
    np.testing.assert_allclose(view.targets, np.vstack([V[BASE], turned])[order], rtol=0, atol=1e-12)
    other = apd_viewer.deform(V, F, fixed[order], view.targets, handle=np.sort(HANDLE), **settings)
    assert view.result.U.tobytes() == other.U.tobytes()
    assert view.result.iterations == other.iterations


def test_live_view_comes_to_rest_at_its_targets_with_its_area(view):
    view.move(pose(shift=(0.5, 0, 0)))
    told, positions = settled(view)
    assert told["problem"] == ""
    np.testing.assert_allclose(view.U[HANDLE], V[HANDLE] + [0.5, 0, 0], rtol=0, atol=1e-9)
    area = trimesh.Trimesh(view.U, F, process=False).area
    assert area == pytest.approx(trimesh.Trimesh(V, F, process=False).area, rel=1e-9)
    assert told["area"].startswith("100.000000")
    np.testing.assert_allclose(positions, view.U - CENTRE, rtol=0, atol=1e-5)
    np.testing.assert_allclose(view.U, view.result.U, rtol=0, atol=1e-2)


def test_live_view_follows_the_newest_drag_from_where_it_began(view):
    for begun in range(2):
        for k in range(1, 30):
            matrix = pose((0, 0.01 * k, 0), (0.01 * k, 0, 0))
            message = {"op": "drag", "label": 2, "begins": k == 1, "matrix": matrix.ravel().tolist()}
            view.answer(message | {"number": 10**9 if begun else 0})
    settled(view)
    # Twice the same motion about the page's origin, which is the centre of the mesh.
    once = Rotation.from_rotvec((0, 0.29, 0))
    expected = V[HANDLE] - CENTRE
    for _ in range(2):
        expected = once.apply(expected) + [0.29, 0, 0]
    np.testing.assert_allclose(view.U[HANDLE] - CENTRE, expected, rtol=0, atol=1e-9)
    view.undo()
    settled(view)
    np.testing.assert_allclose(
        view.U[HANDLE] - CENTRE, once.apply(V[HANDLE] - CENTRE) + [0.29, 0, 0], atol=1e-9
    )


def test_live_view_is_painted_and_undone_stroke_by_stroke():
    view = LiveView(MESH)
    told, arrays = view.answer({"op": "hello", "view": "one"})
    assert told["view"] == "one"
    assert "base" in told["hint"]
    np.testing.assert_allclose(np.frombuffer(arrays[2], "<f4").reshape(-1, 3), V - CENTRE, atol=1e-6)
    np.testing.assert_array_equal(np.frombuffer(arrays[3], "<u4").reshape(-1, 3), F)
    with pytest.raises(apd_viewer.InputError, match="no base"):
        view.move(np.eye(4))
    assert "handle" in paint(view, 0, BASE)["hint"]
    assert paint(view, 2, HANDLE)["hint"] == ""
    np.testing.assert_array_equal(view.base, np.sort(BASE))
    np.testing.assert_array_equal(view.handles[0], np.sort(HANDLE))
    paint(view, 1, HANDLE[:1])
    np.testing.assert_array_equal(view.handles[0], np.sort(HANDLE[1:]))
    view.answer({"op": "undo"})
    np.testing.assert_array_equal(view.handles[0], np.sort(HANDLE))
    view.undo()
    assert view.handles == []


def test_live_view_holds_what_is_painted_where_it_is(view):
    view.move(pose(shift=(0.5, 0, 0)))
    settled(view)
    free = np.setdiff1d(np.arange(len(V)), view.fixed)[:3]
    before = view.U[free]
    paint(view, 3, free)
    settled(view)
    np.testing.assert_allclose(view.U[free], before, rtol=0, atol=1e-9)
    assert len(view.handles) == 2
    view.move(before + [0, 0.1, 0], handle=1)
    settled(view)
    np.testing.assert_allclose(view.U[free], before + [0, 0.1, 0], rtol=0, atol=1e-9)


def test_live_view_says_below_the_picture_what_the_solver_refuses():
    view = LiveView(MESH, tolerance=-1.0)
    paint(view, 0, BASE)
    paint(view, 2, HANDLE)
    told, _ = settled(view)
    assert told["problem"].endswith(".")
    assert "tolerance" in told["problem"].lower()
    with pytest.raises(apd_viewer.InputError):
        LiveView(MESH, BASE, HANDLE, tolerance=-1.0)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"speed": 3}, "“speed” is no setting"),
        ({"base": [len(V)]}, "IDs run from 0"),
        ({"base": BASE, "handles": BASE[:2]}, "only"),
        ({"handles": 5}, "array"),
        ({"handles": [[k] for k in range(9)]}, "at most 8"),
        ({"mesh": "bottle.obj"}, "Mesh"),
    ],
    ids=lambda value: str(value)[:20],
)
def test_live_view_refuses_in_a_sentence(given, said):
    with pytest.raises(apd_viewer.InputError, match=said):
        LiveView(**{"mesh": MESH} | given)


@pytest.mark.parametrize(("motion", "handle"), [(np.eye(3), 0), (np.eye(4), 1), (np.eye(4), "0"), ("up", 0)])
def test_live_view_refuses_to_move_in_a_sentence(view, motion, handle):
    with pytest.raises(apd_viewer.InputError, match=r"\.$"):
        view.move(motion, handle)


def test_live_view_ends_its_thread_when_it_is_forgotten():
    view = LiveView(MESH, BASE, HANDLE)
    settled(view)
    threads = [thread for thread in threading.enumerate() if thread.name == "live"]
    del view
    gc.collect()
    for thread in threads:
        thread.join(20)
    assert [thread for thread in threading.enumerate() if thread.name == "live"] == []


def test_live_solver_waits_while_it_is_held():
    solver, made = LiveSolver(), apd_viewer.Deformation(V, F, np.r_[BASE, HANDLE], handle=HANDLE)
    with solver.held():
        solver.open(lambda: made, V[made.fixed], None)
        assert solver.newer_shape(0, 0.3).frame is None
    assert solver.newer_shape(0, 60).number == 1
    solver.close()


def test_live_solver_goes_on_after_waiting_for_it_was_interrupted(monkeypatch):
    solver, made = LiveSolver(), apd_viewer.Deformation(V, F, np.r_[BASE, HANDLE], handle=HANDLE)
    with monkeypatch.context() as patch:
        patch.setattr(threading.Condition, "wait_for", interrupted)
        with pytest.raises(KeyboardInterrupt), solver.held():
            pass
    solver.open(lambda: made, V[made.fixed], None)
    assert solver.newer_shape(0, 60).number == 1
    solver.close()


def interrupted(*_):
    raise KeyboardInterrupt


class Stub:
    """Widget of a notebook that only notes what is sent."""

    def __init__(self):
        self.sent, self.asked = [], None

    def on_msg(self, answer):
        self.asked = answer

    def send(self, content, buffers=()):
        self.sent.append((content, buffers))

    def _repr_mimebundle_(self, **_):
        return {"text/plain": "widget", "application/vnd.jupyter.widget-view+json": {}}, {}


def test_live_view_leaves_a_picture_and_no_mesh_in_a_notebook(view, monkeypatch):
    module = ModuleType("anywidget")
    module.AnyWidget = Stub
    monkeypatch.setitem(sys.modules, "anywidget", module)
    bundle = methodcaller("_repr_mimebundle_")(view)
    assert set(bundle) == {"text/plain", "image/png", "application/vnd.jupyter.widget-view+json"}
    assert f"{len(V)} vertices" in bundle["text/plain"]
    pixels = read_png(base64.b64decode(bundle["image/png"]), 1 << 20)
    assert (pixels[..., 3] > 0).any()
    widget = methodcaller("_display_")(view)
    assert "createMeshView" in attrgetter("_esm")(widget)
    view.move(pose(shift=(0.1, 0, 0)))
    assert widget.sent.pop() == ({"wake": True}, ())
    widget.asked(widget, {"op": "hello", "view": "a"}, [])
    told, arrays = widget.sent.pop()
    assert told["view"] == "a"
    assert len(arrays) == 4
