"""The Blender add-on in Blender's own module, without a window, beside the real solver.

`make night-blender` runs it; ``APD_VIEWER`` names another program, ``APD_MESHES`` other meshes to be timed.
"""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import bpy
import numpy as np
import pytest

ROOT = Path(__file__).parents[3]
sys.path.insert(0, str(ROOT / "resources" / "blender"))
import build  # noqa: E402

# Blender's numbers have 24 bits; the mean of the rounding of a few hundred vertices shows in the area.
ROUNDING = 5e-8
SHAPES, TURN = 240, 20  # of a timed drag
# Of the solver’s own rate: quiet machines give 0.91 to 1.02, and one core that waits busily 0.63 to 0.8.
# Other programs may slow one drag down; what is slow by itself stays so.
ENOUGH = 0.85
MOST_DRAGS = 3
PROGRAM = os.environ.get("APD_VIEWER") or str(ROOT / ".venv" / "bin" / "apd-viewer")


@pytest.fixture(scope="session")
def addon(tmp_path_factory):
    """The assembled add-on as a module, registered."""
    place = build.assembled_addon(tmp_path_factory.mktemp("addon"))
    sys.path.insert(0, str(place.parent))
    import apd_live

    apd_live.register()
    apd_live.operators.solver_command = lambda _: [PROGRAM, "serve"]
    yield apd_live
    apd_live.unregister()


@pytest.fixture
def scene(addon):
    """An empty scene."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return bpy.context.scene


def area_of(V, F):
    P = np.asarray(V, np.float64)[F]
    return np.linalg.norm(np.cross(P[:, 1] - P[:, 0], P[:, 2] - P[:, 0]), axis=1).sum() / 2.0


def tube(quads=False, n=24, rows=20):
    """An open tube along z, with the groups "foot" and "top", and an empty "hand" at its top."""
    angle = 2.0 * np.pi * np.arange(n) / n
    V = [(np.cos(a), np.sin(a), 0.25 * row) for row in range(rows + 1) for a in angle]
    four = [
        (row * n + k, row * n + (k + 1) % n, (row + 1) * n + (k + 1) % n, (row + 1) * n + k)
        for row in range(rows)
        for k in range(n)
    ]
    three = [t for a, b, c, d in four for t in ((a, b, c), (a, c, d))]
    mesh = bpy.data.meshes.new("tube")
    mesh.from_pydata(V, [], four if quads else three)
    return placed(mesh)


def placed(mesh):
    """Object of a mesh with groups at both ends of z, selected, with an empty as handle."""
    obj = bpy.data.objects.new("tube", mesh)
    bpy.context.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    V = np.array([v.co for v in mesh.vertices])
    height = (V[:, 2] - V[:, 2].min()) / np.ptp(V[:, 2])
    for name, ids in (("foot", height < 0.06), ("top", height > 0.94)):
        obj.vertex_groups.new(name=name).add(np.flatnonzero(ids).tolist(), 1.0, "REPLACE")
    hand = bpy.data.objects.new("hand", None)
    hand.location = (0.0, 0.0, float(V[:, 2].max()))
    bpy.context.collection.objects.link(hand)
    obj.apd.base = "foot"
    handle = obj.apd.handles.add()
    handle.group, handle.target = "top", hand
    bpy.context.view_layer.update()
    return obj, hand


def started(addon):
    return addon.operators.SESSION.started(bpy.context)


def settled(live):
    """Tick as a window does until the shape has settled."""
    end = time.monotonic() + 60.0
    while True:
        live.tick()
        if live.is_settled:
            return
        assert time.monotonic() < end
        time.sleep(0.002)


def shown(obj):
    """Positions and triangles as they are drawn, in the world."""
    seen = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    seen.calc_loop_triangles()
    V, F = np.empty(3 * len(seen.vertices), np.float32), np.empty(3 * len(seen.loop_triangles), np.int32)
    seen.vertices.foreach_get("co", V)
    seen.loop_triangles.foreach_get("vertices", F)
    M = np.array(obj.matrix_world)
    return V.reshape(-1, 3).astype(np.float64) @ M[:3, :3].T + M[:3, 3], F.reshape(-1, 3)


def group_of(obj, name):
    index = obj.vertex_groups[name].index
    return [v.index for v in obj.data.vertices if any(g.group == index for g in v.groups)]


@pytest.mark.parametrize("quads", [False, True])
def test_live_deformation_follows_the_empty_and_keeps_the_area(addon, scene, quads):
    obj, hand = tube(quads)
    basis = addon.object_arrays.positions(obj.data).copy()
    before, F = shown(obj)
    live = started(addon)
    settled(live)
    np.testing.assert_allclose(shown(obj)[0], before, atol=1e-6)
    for shift in (0.3, 0.6, 1.0):  # as a drag does
        hand.location.x = shift
        bpy.context.view_layer.update()
        live.tick()
    settled(live)
    after, _ = shown(obj)
    top, foot = group_of(obj, "top"), group_of(obj, "foot")
    np.testing.assert_allclose(after[top], before[top] + [1.0, 0.0, 0.0], atol=2e-6)
    np.testing.assert_allclose(after[foot], before[foot], atol=1e-6)
    assert abs(area_of(after, F) / area_of(before, F) - 1.0) < ROUNDING
    np.testing.assert_array_equal(addon.object_arrays.rest_positions(obj.data), basis)
    assert abs(live.readings["area_error"]) < 1e-9
    assert live.status == "Settled"
    live.keep()


def test_live_deformation_turns_and_scales_with_the_empty(addon, scene):
    obj, hand = tube()
    before, _ = shown(obj)
    live = started(addon)
    hand.rotation_euler.z, hand.scale.x = np.radians(30.0), 1.2
    bpy.context.view_layer.update()
    settled(live)
    top = group_of(obj, "top")
    turn = np.array([[np.cos(np.pi / 6), -0.5, 0], [0.5, np.cos(np.pi / 6), 0], [0, 0, 1]])
    pivot = np.array([0.0, 0.0, 5.0])
    asked = (before[top] - pivot) * [1.2, 1.0, 1.0] @ turn.T + pivot
    np.testing.assert_allclose(shown(obj)[0][top], asked, atol=3e-6)
    live.keep()


@pytest.mark.parametrize("scale", [(2.0, 2.0, 2.0), (1.0, 3.0, 0.5), (-1.0, 1.0, 1.0)])
def test_live_deformation_keeps_the_area_seen_of_a_scaled_object(addon, scene, scale):
    obj, hand = tube()
    obj.scale, obj.rotation_euler, obj.location = scale, (0.3, 0.2, 0.1), (5.0, -2.0, 1.0)
    bpy.context.view_layer.update()
    before, F = shown(obj)
    live = started(addon)
    hand.location.x += 0.5
    bpy.context.view_layer.update()
    settled(live)
    after, _ = shown(obj)
    assert abs(area_of(after, F) / area_of(before, F) - 1.0) < ROUNDING
    top = group_of(obj, "top")
    np.testing.assert_allclose(after[top], before[top] + [0.5, 0.0, 0.0], atol=1e-5)
    live.keep()


def test_live_deformation_follows_a_bone(addon, scene):
    obj, _ = tube()
    arm = bpy.data.objects.new("arm", bpy.data.armatures.new("arm"))
    bpy.context.collection.objects.link(arm)
    bpy.context.view_layer.objects.active = arm
    bpy.ops.object.mode_set(mode="EDIT")
    bone = arm.data.edit_bones.new("wrist")
    bone.head, bone.tail = (0, 0, 4), (0, 0, 5)
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.objects.active = obj
    obj.apd.handles[0].target, obj.apd.handles[0].bone = arm, "wrist"
    before, _ = shown(obj)
    live = started(addon)
    arm.pose.bones["wrist"].location = (0.0, 0.5, 0.0)  # along the bone, which points upwards
    bpy.context.view_layer.update()
    settled(live)
    top = group_of(obj, "top")
    np.testing.assert_allclose(shown(obj)[0][top], before[top] + [0.0, 0.0, 0.5], atol=3e-6)
    live.keep()


def test_live_deformation_undoes_what_it_has_added(addon, scene):
    obj, hand = tube()
    live = started(addon)
    hand.location.x = 1.0
    bpy.context.view_layer.update()
    settled(live)
    assert list(obj.data.shape_keys.key_blocks.keys()) == ["Basis", "APD"]
    live.undo()
    assert obj.data.shape_keys is None


def test_live_deformation_undoes_to_the_shape_key_that_was_there(addon, scene):
    obj, hand = tube()
    other = obj.shape_key_add(name="Basis")
    other = obj.shape_key_add(name="smile")
    other.value = 0.0
    started(addon)
    hand.location.x = 1.0
    bpy.context.view_layer.update()
    settled(addon.operators.SESSION.live)
    addon.operators.SESSION.live.keep()
    kept, _ = shown(obj)
    live = started(addon)
    hand.location.y = 1.0
    bpy.context.view_layer.update()
    settled(live)
    assert np.abs(shown(obj)[0] - kept).max() > 0.1
    live.undo()
    np.testing.assert_array_equal(shown(obj)[0], kept)
    assert list(obj.data.shape_keys.key_blocks.keys()) == ["Basis", "smile", "APD"]


def test_live_deformation_takes_no_shape_of_the_mesh_before(addon, scene):
    obj, hand = tube()
    live = started(addon)
    hand.location.x = 1.0
    bpy.context.view_layer.update()
    for _ in range(100):
        live.tick()
        time.sleep(0.01)
        if live.readings:
            break
    live.keep()  # while another shape is under way
    obj, hand = tube(n=30)
    live = started(addon)
    settled(live)
    assert len(shown(obj)[0]) == 30 * 21


def test_operator_is_one_undo_step(addon, scene):
    obj, hand = tube()
    hand.location.x = 0.0
    bpy.ops.ed.undo_push(message="before")
    before, _ = shown(obj)
    assert bpy.ops.apd.live("EXEC_DEFAULT") == {"FINISHED"}
    assert obj.data.shape_keys is not None
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()
    obj = bpy.context.view_layer.objects.active
    assert obj.data.shape_keys is None
    np.testing.assert_array_equal(shown(obj)[0], before)


def refused(addon, words):
    with pytest.raises(RuntimeError, match=words):
        bpy.ops.apd.live("EXEC_DEFAULT")
    assert addon.operators.SESSION.live is None


def test_operator_refuses_in_a_sentence_what_it_cannot_mean(addon, scene):
    obj, hand = tube()
    bpy.ops.object.mode_set(mode="EDIT")
    refused(addon, "Leave edit mode")
    bpy.ops.object.mode_set(mode="OBJECT")
    wave = obj.modifiers.new("ripple", "WAVE")
    refused(addon, "Turn the modifier “ripple” off")
    wave.show_viewport = False
    obj.scale.x = 0.0
    bpy.context.view_layer.update()
    refused(addon, "The scale of the object is 0")
    obj.scale.x = 1.0
    bpy.context.view_layer.update()
    obj.apd.handles[0].target = None
    refused(addon, "Choose the object that moves “top”")
    obj.apd.handles[0].target = hand
    obj.vertex_groups["top"].remove(range(len(obj.data.vertices)))
    refused(addon, "The vertex group “top” is empty")
    obj.vertex_groups["top"].add(group_of(obj, "foot"), 1.0, "REPLACE")
    refused(addon, "in two of the groups")
    obj.apd.base = "nothing"
    refused(addon, "There is no vertex group “nothing”")
    obj.apd.handles.clear()
    refused(addon, "Add a handle")
    obj.shape_key_add(name="Basis")
    obj.shape_key_add(name="smile").value = 0.5
    refused(addon, "Set the shape key “smile” to 0")


def test_operator_tells_the_sentence_of_the_solver(addon, scene):
    obj, _ = tube()
    obj.data.vertices[30].co = (np.nan, 0.0, 0.0)
    refused(addon, ".")


def test_session_starts_a_solver_anew_after_its_end(addon, scene):
    _, hand = tube()
    live = started(addon)
    settled(live)
    addon.operators.SESSION.solver.process.kill()
    addon.operators.SESSION.solver.process.wait()
    hand.location.x = 0.5
    bpy.context.view_layer.update()
    with pytest.raises(addon.solver_process.SolverError, match="The solver has ended; start again"):
        settled(live)
    addon.operators.SESSION.live = None
    assert bpy.ops.apd.live("EXEC_DEFAULT") == {"FINISHED"}


def test_session_forgets_what_is_live_when_a_file_is_loaded(addon, scene, tmp_path):
    tube()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "tube.blend"))
    started(addon)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "tube.blend"))
    assert addon.operators.SESSION.live is None
    obj = bpy.context.view_layer.objects.active
    assert obj.apd.base == "foot"
    assert obj.apd.handles[0].target.name == "hand"
    assert bpy.ops.apd.live("EXEC_DEFAULT") == {"FINISHED"}


def test_live_deformation_notices_that_the_mesh_has_changed(addon, scene):
    obj, hand = tube()
    live = started(addon)
    settled(live)
    obj.data.clear_geometry()
    hand.location.x = 0.5
    bpy.context.view_layer.update()
    with pytest.raises(addon.solver_process.SolverError, match="The mesh has changed"):
        settled(live)
    addon.operators.SESSION.live = None


def keyed(hand, scene):
    scene.frame_start, scene.frame_end = 1, 5
    for frame, x in ((1, 0.0), (5, 1.0)):
        hand.location.x = x
        hand.keyframe_insert("location", index=0, frame=frame)
    scene.frame_set(1)


# Shapes a second of the solver alone, in the Python of the program.
_ALONE = """
import sys, time
import numpy as np
import apd_viewer
given = np.load(sys.argv[1])
solver = apd_viewer.Deformation(*(given[name] for name in ("V", "F", "fixed")), handle=given["handle"])
for line in sys.stdin:
    started = time.perf_counter()
    for targets in given["targets"][slice(*map(int, line.split()))]:
        solver.aim(targets)
        solver.step()
    print(time.perf_counter() - started, flush=True)
"""


def imported(path, low, high, axis, refinements=0):
    """An object from an OBJ file, each triangle split in four, with its groups and its empty."""
    bpy.ops.wm.obj_import(filepath=str(path), forward_axis="Y", up_axis="Z")
    obj = bpy.context.selected_objects[0]
    bpy.context.view_layer.objects.active = obj
    if refinements:
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        for _ in range(refinements):
            bpy.ops.mesh.subdivide()
        bpy.ops.object.mode_set(mode="OBJECT")
    V = np.array([v.co for v in obj.data.vertices])
    height = (V[:, axis] - V[:, axis].min()) / np.ptp(V[:, axis])
    for name, ids in (("foot", height < low), ("top", height > high)):
        obj.vertex_groups.new(name=name).add(np.flatnonzero(ids).tolist(), 1.0, "REPLACE")
    hand = bpy.data.objects.new("hand", None)
    bpy.context.collection.objects.link(hand)
    obj.apd.base = "foot"
    handle = obj.apd.handles.add()
    handle.group, handle.target = "top", hand
    obj.apd.contact = False
    bpy.context.view_layer.update()
    return obj, hand


@pytest.mark.parametrize("refinements", [0, 1])
@pytest.mark.parametrize(
    "mesh",
    os.environ.get("APD_MESHES", str(ROOT / "resources" / "bottle.obj")).split(os.pathsep),
    ids=lambda path: Path(path).name,
)
def test_live_deformation_is_as_fast_as_the_solver(addon, scene, mesh, refinements, tmp_path):
    obj, hand = imported(mesh, 0.06, 0.93, 1, refinements)
    before, F = shown(obj)
    basis = addon.object_arrays.positions(obj.data).copy()
    size = np.linalg.norm(np.ptp(before, axis=0))
    top, foot = group_of(obj, "top"), group_of(obj, "foot")
    step = np.array([0.1 * size / SHAPES, 0.0, 0.0])
    targets = [np.concatenate([before[foot], before[top] + k * step]) for k in range(1, SHAPES + 1)]
    given = {"V": before, "F": F, "fixed": [*foot, *top], "handle": top, "targets": targets}
    np.savez(tmp_path / "drag.npz", **given)
    python = Path(PROGRAM).with_name("python")
    words = [os.environ.get("APD_PYTHON") or str(python), "-c", _ALONE, str(tmp_path / "drag.npz")]
    live = started(addon)
    settled(live)
    solver = addon.operators.SESSION.solver.process

    def live_drag(begin, duration):
        """Shapes a second, while the hand moves on at every tick of a timer as in a window."""
        began, came = time.perf_counter(), []
        for tick in range(round(duration * addon.operators.TICKS_A_SECOND)):
            passed = tick / addon.operators.TICKS_A_SECOND
            time.sleep(max(began + passed - time.perf_counter(), 0.0))
            hand.location = step * (begin + TURN * passed / duration)
            bpy.context.view_layer.update()
            if live.tick():
                came.append(time.perf_counter())
        return (len(came) - 1) / (came[-1] - came[0])

    def ratios_of_a_drag(alone):
        """Pace of a drag over that of the solver alone, by turns; and shapes a second."""
        own, shown_a_second = [], []
        # By turns, as the speed of a machine changes within seconds; the one that waits is stopped.
        for begin in range(0, SHAPES, TURN):
            solver.send_signal(signal.SIGSTOP)
            alone.stdin.write(f"{begin} {begin + TURN}\n")
            alone.stdin.flush()
            seconds = float(alone.stdout.readline())
            own.append(TURN / seconds)
            solver.send_signal(signal.SIGCONT)
            shown_a_second.append(live_drag(begin, seconds))
        # The first ones compile and fill caches.
        return np.array(shown_a_second[1:]) / own[1:], np.mean(shown_a_second[1:])

    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    with subprocess.Popen(words, **pipes) as alone:
        for _ in range(MOST_DRAGS):
            ratios, rate = ratios_of_a_drag(alone)
            low, middle, high = np.quantile(ratios, (0.25, 0.5, 0.75))
            print(
                f"{len(before)} vertices: {rate:.1f} shapes a second, {middle:.2f} ({low:.2f} to {high:.2f}) "
                "of the solver alone"
            )
            if middle > ENOUGH:
                break
        alone.stdin.close()
    hand.location = SHAPES * step
    bpy.context.view_layer.update()
    live.tick()
    while live.readings["motion"] != live.motion:
        live.tick()
        time.sleep(0.0002)
    after, _ = shown(obj)
    live.keep()
    assert middle > ENOUGH
    assert abs(area_of(after, F) / area_of(before, F) - 1.0) < 1e-8
    np.testing.assert_array_equal(addon.object_arrays.rest_positions(obj.data), basis)
    np.testing.assert_allclose(after[top], before[top] + SHAPES * step, atol=1e-5 * size)


@pytest.mark.parametrize("form", ["KEYS", "CACHE"])
def test_bake_gives_the_shape_of_each_frame(addon, scene, form, tmp_path):
    obj, hand = tube()
    keyed(hand, scene)
    rest, F = shown(obj)
    assert bpy.ops.apd.bake("EXEC_DEFAULT", form=form, path=str(tmp_path / "tube.pc2")) == {"FINISHED"}
    top = group_of(obj, "top")
    for frame in range(1, 6):
        scene.frame_set(frame)
        V, _ = shown(obj)
        np.testing.assert_allclose(
            V[top] - rest[top], np.tile([hand.location.x, 0, 0], (len(top), 1)), atol=3e-6
        )
        assert abs(area_of(V, F) / area_of(rest, F) - 1.0) < ROUNDING
    scene.frame_set(5)
    assert hand.location.x == pytest.approx(1.0)


def bake(form, path, **more):
    return bpy.ops.apd.bake("EXEC_DEFAULT", form=form, path=str(path), **more)


def keys_of(obj):
    keys = obj.data.shape_keys.key_blocks if obj.data.shape_keys else ()
    return [(key.name, key.value, key.mute, [tuple(point.co) for point in key.points]) for key in keys]


@pytest.mark.parametrize("form", ["KEYS", "CACHE"])
def test_bake_holds_shapes_between_frames_until_the_end_of_the_scene(addon, scene, form, tmp_path):
    obj, hand = tube()
    keyed(hand, scene)
    scene.frame_start, scene.frame_end = 101, 106
    hand.animation_data_clear()
    for frame in range(101, 108):
        hand.location.x = 0.1 * (frame - 101)
        hand.keyframe_insert("location", index=0, frame=frame)
    rest, _ = shown(obj)
    assert bake(form, tmp_path / "tube.pc2", step=2) == {"FINISHED"}
    top = group_of(obj, "top")
    for frame in range(101, 107):
        scene.frame_set(frame)
        far = (shown(obj)[0] - rest)[top]
        np.testing.assert_allclose(far, np.tile([0.1 * (frame - 101), 0, 0], (len(top), 1)), atol=3e-6)
    for frame, reached in ((90, 0.0), (120, 0.6)):
        scene.frame_set(frame)
        np.testing.assert_allclose((shown(obj)[0] - rest)[top, 0], reached, atol=3e-6)


@pytest.mark.parametrize("form", ["KEYS", "CACHE"])
def test_bake_deforms_nothing_where_all_moves_as_one(addon, scene, form, tmp_path):
    obj, hand = tube()
    root = bpy.data.objects.new("root", None)
    bpy.context.collection.objects.link(root)
    obj.parent = hand.parent = root
    scene.frame_start, scene.frame_end = 1, 3
    for frame in (1, 3):
        root.location, root.rotation_euler.x = (5.0 * (frame - 1), 0.0, 0.0), 0.5 * (frame - 1)
        root.keyframe_insert("location", frame=frame)
        root.keyframe_insert("rotation_euler", frame=frame)
    rest = addon.object_arrays.positions(obj.data).copy()
    assert bake(form, tmp_path / "tube.pc2") == {"FINISHED"}
    for frame in (1, 2, 3):
        scene.frame_set(frame)
        seen = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        np.testing.assert_allclose(addon.object_arrays.positions(seen), rest, atol=2e-5)


def test_live_deformation_follows_a_handle_that_stays_while_the_object_moves(addon, scene):
    obj, _ = tube()
    rest, _ = shown(obj)
    live = started(addon)
    settled(live)
    obj.location.x = 0.3
    bpy.context.view_layer.update()
    settled(live)
    top, foot = group_of(obj, "top"), group_of(obj, "foot")
    V, _ = shown(obj)
    np.testing.assert_allclose(V[top], rest[top], atol=2e-6)
    np.testing.assert_allclose(V[foot], rest[foot] + [0.3, 0.0, 0.0], atol=2e-6)
    live.undo()


def test_bake_plays_a_cache_before_the_modifiers_that_add_vertices(addon, scene, tmp_path):
    obj, hand = tube()
    keyed(hand, scene)
    obj.modifiers.new("finer", "SUBSURF")
    rest, _ = shown(obj)
    assert bake("CACHE", tmp_path / "tube.pc2") == {"FINISHED"}
    scene.frame_set(5)
    V, _ = shown(obj)
    assert len(V) == len(rest) > len(obj.data.vertices)
    assert np.ptp((V - rest)[:, 0]) > 0.9


def test_bake_leaves_other_curves_as_they_are(addon, scene, tmp_path):
    obj, hand = tube()
    keyed(hand, scene)
    for frame in (1, 5):
        obj.location.y = 0.1 * frame
        obj.keyframe_insert("location", index=1, frame=frame)
    obj.shape_key_add(name="Basis")
    smile = obj.shape_key_add(name="smile")
    smile.value = 0.0
    for frame in (10, 20):
        smile.keyframe_insert("value", frame=frame)
    assert bake("KEYS", "") == {"FINISHED"}
    actions = {obj.animation_data.action, obj.data.shape_keys.animation_data.action}
    ways = {
        curve.data_path: {point.interpolation for point in curve.keyframe_points}
        for action in actions
        for layer in action.layers
        for strip in layer.strips
        for bag in strip.channelbags
        for curve in bag.fcurves
    }
    assert ways.pop("location") == ways.pop('key_blocks["smile"].value') == {"BEZIER"}
    assert len(ways) == 5
    assert set.union(*ways.values()) == {"LINEAR"}


@pytest.mark.parametrize("second", ["KEYS", "CACHE"])
@pytest.mark.parametrize("first", ["KEYS", "CACHE"])
def test_bake_replaces_an_earlier_one(addon, scene, first, second, tmp_path):
    obj, hand = tube()
    keyed(hand, scene)
    rest, _ = shown(obj)
    assert bake(first, tmp_path / "tube.pc2") == {"FINISHED"}
    hand.location.x = 0.5
    hand.keyframe_insert("location", index=0, frame=5)
    scene.frame_end = 3
    assert bake(second, tmp_path / "tube.pc2") == {"FINISHED"}
    top = group_of(obj, "top")
    for frame in (1, 2, 3):
        scene.frame_set(frame)
        np.testing.assert_allclose((shown(obj)[0] - rest)[top, 0], hand.location.x, atol=3e-6)
    assert len([each for each in obj.modifiers if each.type == "MESH_CACHE"]) <= 1
    if second == "KEYS":
        assert [key.name for key in obj.data.shape_keys.key_blocks] == ["Basis", "APD 1", "APD 2", "APD 3"]


@pytest.mark.parametrize("form", ["KEYS", "CACHE"])
def test_bake_that_fails_leaves_everything_as_it_was(addon, scene, form, tmp_path):
    obj, hand = tube()
    keyed(hand, scene)
    assert bpy.ops.apd.live("EXEC_DEFAULT") == {"FINISHED"}
    smile = obj.shape_key_add(name="smile")
    for frame, value in ((3, 0.0), (4, 1.0)):
        smile.value = value
        smile.keyframe_insert("value", frame=frame)
    scene.frame_set(1)
    (tmp_path / "tube.pc2").write_bytes(b"an older one")
    before = keys_of(obj)
    with pytest.raises(RuntimeError, match="Set the shape key “smile” to 0, or mute it"):
        bake(form, tmp_path / "tube.pc2")
    assert keys_of(obj) == before
    assert not list(obj.modifiers)
    assert [(each.name, each.read_bytes()) for each in tmp_path.iterdir()] == [("tube.pc2", b"an older one")]
    assert addon.operators.SESSION.live is None


def test_bake_that_fails_shows_the_earlier_one_again(addon, scene, tmp_path):
    obj, hand = tube()
    keyed(hand, scene)
    assert bake("KEYS", "") == {"FINISHED"}
    with pytest.raises(RuntimeError, match="cannot be written"):
        bake("CACHE", tmp_path / "none" / "tube.pc2")
    scene.frame_set(5)
    assert shown(obj)[0][:, 0].max() == pytest.approx(2.0, abs=0.1)


def test_live_deformation_is_in_sight_after_a_bake(addon, scene, tmp_path):
    obj, hand = tube()
    keyed(hand, scene)
    assert bpy.ops.apd.live("EXEC_DEFAULT") == {"FINISHED"}
    assert bake("CACHE", tmp_path / "tube.pc2") == {"FINISHED"}
    assert obj.data.shape_keys.key_blocks["APD"].value == 0.0
    obj.modifiers["APD"].show_viewport = False
    hand.animation_data_clear()
    live = started(addon)
    hand.location.x = 0.5
    bpy.context.view_layer.update()
    settled(live)
    top = group_of(obj, "top")
    assert shown(obj)[0][top, 0].max() == pytest.approx(1.5, abs=0.01)
    live.undo()
    assert obj.data.shape_keys.key_blocks["APD"].value == 0.0


def test_bake_tells_a_file_that_cannot_be_written(addon, scene, tmp_path):
    _, hand = tube()
    keyed(hand, scene)
    with pytest.raises(RuntimeError, match="cannot be written"):
        bpy.ops.apd.bake("EXEC_DEFAULT", form="CACHE", path=str(tmp_path / "none" / "tube.pc2"))


def test_solver_command_finds_the_program_or_says_what_to_do(addon, monkeypatch, tmp_path):
    found = addon.solver_process.solver_command
    assert found("/some/apd-viewer") == ["/some/apd-viewer", "serve"]
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(addon.solver_process.SolverError, match="was not found"):
        found()
    (tmp_path / "apd-viewer").write_text("#!/bin/sh\n")
    (tmp_path / "apd-viewer").chmod(0o755)
    assert found() == [str(tmp_path / "apd-viewer"), "serve"]


def test_operator_refuses_a_mesh_that_is_linked_from_another_file(addon, scene, tmp_path):
    tube()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "tube.blend"))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(str(tmp_path / "tube.blend"), link=True) as (_, into):
        into.objects = ["tube", "hand"]
    for each in into.objects:
        bpy.context.collection.objects.link(each)
    bpy.context.view_layer.objects.active = bpy.data.objects["tube"]
    bpy.context.view_layer.update()
    refused(addon, "The mesh is linked from another file; make it local first")
    bpy.ops.object.make_local(type="ALL")
    bpy.context.view_layer.objects.active = bpy.data.objects["tube"]
    bpy.context.view_layer.update()
    assert bpy.ops.apd.live("EXEC_DEFAULT") == {"FINISHED"}


def test_operator_refuses_absolute_shape_keys(addon, scene):
    obj, _ = tube()
    obj.shape_key_add(name="Basis")
    obj.data.shape_keys.use_relative = False
    refused(addon, "The shape keys are absolute")
    obj.data.shape_keys.use_relative = True
    assert bpy.ops.apd.live("EXEC_DEFAULT") == {"FINISHED"}


def test_solver_process_refuses_another_protocol(addon, monkeypatch):
    monkeypatch.setattr(addon.solver_process, "PROTOCOL", 2)
    solver = addon.solver_process.SolverProcess([PROGRAM, "serve"])
    with pytest.raises(addon.solver_process.SolverError, match="speaks protocol 1"):
        solver.greet()
    solver.close()


def test_add_handle_puts_an_empty_at_the_middle_of_the_group(addon, scene):
    obj, _ = tube()
    obj.apd.handles.clear()
    obj.vertex_groups.active = obj.vertex_groups["top"]
    assert bpy.ops.apd.add_handle() == {"FINISHED"}
    assert obj.apd.handles[0].group == "top"
    np.testing.assert_allclose(obj.apd.handles[0].target.location, [0, 0, 4.875], atol=0.13)
    assert bpy.ops.apd.remove_handle(index=0) == {"FINISHED"}
    assert len(obj.apd.handles) == 0


def test_build_makes_an_archive_that_blender_takes(tmp_path):
    archive = build.archive(build.assembled_addon(tmp_path))
    assert archive.stat().st_size < 50_000
