"""Whatever the user does in whatever order: hypothesis tells the session what to do."""

import contextlib
import threading
import time
from collections.abc import Callable

import numpy as np
import pytest
from driven_session import Driven, solver_threads
from hypothesis import settings, strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, precondition, rule
from meshes import box, rotation

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.session.model.document_parts import PaintedPart, have_same_paint
from apd_viewer.session.part_operations import PartOperation
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.settings_editor import SettingsEditor
from apd_viewer.session.state_store import Activity

SIZES = ((1, 1, 3), (2, 1, 3), (1, 1, 4))


def _at_rest(machine) -> bool:
    return machine.gesture is None


def _painting(machine) -> bool:
    return machine.gesture == "stroke"


def _dragging(machine) -> bool:
    return machine.gesture == "drag"


def _with_regions(machine) -> bool:
    return bool(machine.session.store.state.document.regions)


NUMBERS = st.integers(0, 7)
PERCENT = st.sampled_from([95.0, 100.0, 105.0])


class Use(RuleBasedStateMachine):
    """Keeps two lists of states, as the history should, and compares by identity."""

    def __init__(self) -> None:
        super().__init__()
        self.others = set(threading.enumerate())
        self.session = Driven()
        self.gesture: str | None = None
        self.before = None
        self.undos: list = []
        self.redos: list = []

    @initialize(size=st.sampled_from(SIZES))
    def open_first(self, size) -> None:
        self.session.show_now(Mesh(*box(*size)))
        z = self.session.store.state.document.mesh.V[:, 2]
        for label, ids in ((BASE, z == 0), (HANDLE, z == z.max())):
            before = self.session.store.state
            self.session.stroke(np.flatnonzero(ids), label)
            self._recorded(before)
        for verb in (
            self.session.parts.add_handle,
            lambda: self.session.stroke(np.flatnonzero(z == z.max())[:2], HANDLE + 1),
            self.session.parts.add_region,
            lambda: self._region_stroke(np.flatnonzero(z <= 2)),
        ):
            before = self.session.store.state
            verb()
            self._recorded(before)

    def _region_stroke(self, ids) -> None:
        self.session.gestures.begin()
        self.session.painting.paint_region(ids, 1)
        self.session.painting.end_stroke("Paint region")

    def _recorded(self, before) -> None:
        self.undos.append(before)
        self.redos.clear()

    # Gestures

    @precondition(_at_rest)
    @rule(kind=st.sampled_from(["stroke", "drag", "drag", "sweep"]))
    def begin(self, kind) -> None:
        self.session.gestures.begin()
        self.gesture, self.before = kind, self.session.store.state

    @precondition(_painting)
    @rule(layer=st.integers(0, 4), label=st.sampled_from([BASE, FREE, FREE, HANDLE]), k=NUMBERS)
    def paint(self, layer, label, k) -> None:
        document = self.session.store.state.document
        if label == HANDLE:
            label += k % len(document.handles)
        z = document.mesh.V[:, 2]
        self.session.painting.paint(np.flatnonzero(z == min(layer, z.max())), label)

    @precondition(_painting)
    @rule(layer=st.integers(0, 4), k=NUMBERS)
    def paint_region(self, layer, k) -> None:
        document = self.session.store.state.document
        z, poses = document.mesh.V[:, 2], [handle.pose for handle in document.handles]
        self.session.painting.paint_region(
            np.flatnonzero(abs(z - layer) <= 1), k % (len(document.regions) + 1)
        )
        now = self.session.store.state.document
        assert all(a is handle.pose for a, handle in zip(poses, now.handles, strict=True))
        assert now.labels is document.labels

    @precondition(_dragging)
    @rule(
        angle=st.floats(-0.5, 0.5),
        shift=st.tuples(*[st.floats(-0.4, 0.4)] * 3),
        steps=st.integers(1, 8),
        seconds=st.sampled_from([0.0, 0.0, 0.001]),
        which=NUMBERS,
    )
    def drag(self, angle, shift, steps, seconds, which) -> None:
        which %= len(self.session.store.state.document.handles)
        for k in range(1, steps + 1):
            pose = np.eye(4)
            pose[:3, :3] = rotation((0, 0, 1), angle * k / steps)
            pose[:3, 3] = np.array(shift) * k / steps
            self.session.handles.drag(pose, which)
            time.sleep(seconds)

    @precondition(_painting)
    @rule()
    def end_stroke(self) -> None:
        before, now = self.before, self.session.store.state
        self.session.painting.end_stroke("Paint")
        if np.array_equal(before.document.labels, now.document.labels):
            assert self.session.store.state.document is now.document
        else:
            assert self.session.U is now.frame.U
            assert self.session.store.state.document.initial_positions is now.frame.U
            assert not self.session.store.state.document.is_posed
            self._motions_are_kept(before.document, now.frame.U)
        if before.document is not now.document:
            self._recorded(before)
        self.gesture = None

    def _motions_are_kept(self, before, U) -> None:
        """A handle that was in place, and keeps a vertex, has the motion from rest that it had."""
        document = self.session.store.state.document
        for k, handle in enumerate(before.handles):
            mine = before.labels == HANDLE + k
            held = before.initial_positions[mine] @ handle.pose[:3, :3].T + handle.pose[:3, 3]
            whole, now = before.relative_to_rest.handles[k], document.relative_to_rest.handles[k]
            if not (mine & (document.labels == HANDLE + k)).any():
                assert np.array_equal(now.pose, np.eye(4))
            elif np.allclose(U[mine], held, rtol=0, atol=1e-12):
                assert np.allclose(now.pose, whole.pose, rtol=0, atol=1e-9)
                assert np.allclose(now.rotation, whole.rotation, rtol=0, atol=1e-9)

    @precondition(lambda machine: machine.gesture in ("drag", "sweep"))
    @rule()
    def end_gesture(self) -> None:
        self.session.gestures.end("Move handle")
        if self.session.store.state.document is not self.before.document:
            self._recorded(self.before)
        self.gesture = None

    @rule()
    def cancel(self) -> None:
        self.session.gestures.cancel()
        if self.gesture:
            assert self.session.store.state is self.before
        self.gesture = None

    # Single acts, which take back the gesture that they come in the middle of.

    def _before_act(self):
        before = self.before if self.gesture else self.session.store.state
        self.gesture = None
        return before

    @rule()
    def reset(self) -> None:
        before = self._before_act()
        self.session.shapes.restore()
        assert self.session.U is before.document.mesh.V
        if self.session.store.state is not before:
            self._recorded(before)

    @rule(of=st.sampled_from(["handle", "region"]))
    def add(self, of) -> None:
        before = self._before_act()
        count = len(getattr(before.document, f"{of}s"))
        number = getattr(self.session.parts, f"add_{of}")()
        assert number == len(getattr(self.session.store.state.document, f"{of}s")) - 1
        if number == count:
            self._recorded(before)
        else:
            assert count == 8
            self.session.failed.clear()
        assert self.session.U is before.frame.U

    @rule(of=st.sampled_from(["handle", "handle", "region"]), k=NUMBERS)
    def remove(self, of, k) -> None:
        document = self.session.store.state.document
        count = len(getattr(self.before.document if self.gesture else document, f"{of}s"))
        if count:
            before = self._before_act()
            getattr(self.session.parts, f"remove_{of}")(k % count)
            self._recorded(before)
            now = self.session.store.state.document
            assert len(getattr(now, f"{of}s")) == (max(1, count - 1) if of == "handle" else count - 1)
            assert now.labels.max() < HANDLE + len(now.handles)
            assert now.member.max() <= len(now.regions)

    @rule(k=NUMBERS, name=st.sampled_from(["Neck", " ", "Handle 1"]))
    def rename(self, k, name) -> None:
        k %= len(self.session.store.state.document.handles)
        before, now = self.before if self.gesture else self.session.store.state, self.session.store.state
        self.session.parts.rename_handle(k, name)
        assert all(handle.name for handle in self.session.store.state.document.handles)
        if self.session.store.state is not now:
            self.gesture = None
            self._recorded(before)

    def _acted(self, before, gesture=None) -> None:
        """After an act that is a step of its own, or a part of the one before, or nothing."""
        if self.session.store.state.document is before.document:
            assert len(self.session.gestures.history.undo_names) == len(self.undos)
        elif len(self.session.gestures.history.undo_names) > len(self.undos):
            self._recorded(before)
        else:
            assert self.session.gestures.history.next_undo_name == gesture == "Nudge handle"
            assert self.redos == []

    @rule(
        k=NUMBERS,
        of=st.sampled_from(["base", "handle", "region"]),
        change=st.sampled_from(list(PartOperation)),
    )
    def reshape(self, k, of, change) -> None:
        document = (self.before if self.gesture else self.session.store.state).document
        if of == "region" and not document.regions:
            return
        before = self._before_act()
        if of == "region":
            part = PaintedPart(1 + k % len(document.regions), is_region=True)
        else:
            part = PaintedPart(BASE if of == "base" else HANDLE + k % len(document.handles))
        others = ~part.mask(document) & (part.codes(document) != part.unpainted_code)
        self.session.painting.apply_operation(part, change)
        now = self.session.store.state.document
        assert np.array_equal(part.codes(now)[others], part.codes(document)[others])
        assert len(self.session.gestures.history.undo_names) == len(self.undos) + (now is not document)
        if now is not document:
            self._recorded(before)

    @rule(
        k=NUMBERS,
        motion=st.sampled_from(list(MOTIONS.values())),
        text=st.sampled_from(["10", "0.05L", "1.1", "mm"]),
    )
    def type_motion(self, k, motion, text) -> None:
        before = self._before_act()
        with contextlib.suppress(InputError):
            self.session.handles.move_by(motion, text, k % len(before.document.handles))
        self._problem_was_said(before)
        self._acted(before)

    @rule(k=NUMBERS, times=st.integers(1, 3))
    def nudge(self, k, times) -> None:
        before = self._before_act()
        k %= len(before.document.handles)
        for _ in range(times):
            self.session.gestures.cancel()
            pose = self.session.store.state.document.handles[k].pose.copy()
            pose[0, 3] += 0.02
            self.session.handles.set_pose(pose, k, "Nudge handle", is_repeat=True)
            self._problem_was_said(before)
        self._acted(before, "Nudge handle")

    @rule(k=NUMBERS)
    def put_back(self, k) -> None:
        before = self._before_act()
        k %= len(before.document.handles)
        self.session.handles.reset_handle(k)
        self._problem_was_said(before)
        self._acted(before)
        now = self.session.store.state.document
        if now.paint_problem is None:
            assert not self.session.store.state.is_handle_moved(k)
            held, mine = now.constraints(), np.flatnonzero(now.labels == HANDLE + k)
            assert np.array_equal(held.targets[np.isin(held.fixed, mine)], now.mesh.V[mine])

    def _problem_was_said(self, before) -> None:
        if self.session.store.state.document.paint_problem:
            assert self.session.store.state.document is before.document
            assert set(self.session.failed) <= {before.document.paint_problem}
            self.session.failed.clear()

    # Settings, which become part of a gesture, but take back a stroke that they come in the middle of.

    def _set(self, change: Callable[[SettingsEditor], object]) -> None:
        now = self.session.store.state
        painted = self.gesture and not have_same_paint(now.document, self.before.document)
        before = self.before if painted else now
        change(self.session.settings)
        if self.session.store.state.document is now.document:
            return
        if painted or not self.gesture:
            self.gesture = None
            self._recorded(before)

    @rule(method=st.sampled_from(["exact", "arap", "paper"]))
    def set_method(self, method) -> None:
        self._set(lambda editor: editor.change(method=method))

    @rule(tolerance=st.sampled_from([1e-3, 1e-2, 0.1]))
    def set_tolerance(self, tolerance) -> None:
        self._set(lambda editor: editor.change(tolerance=tolerance))

    @rule(percent=PERCENT)
    def set_area(self, percent) -> None:
        self._set(lambda editor: editor.change(area=percent))

    @rule(percent=st.none() | PERCENT)
    def set_volume(self, percent) -> None:
        self._set(lambda editor: editor.change(volume=percent))

    @rule(stiffness=st.sampled_from([0.0, 0.05]))
    def set_stiffness(self, stiffness) -> None:
        self._set(lambda editor: editor.change(stiffness=stiffness))

    @rule(falloff=st.sampled_from([0.0, 0.7, 1.5]), k=NUMBERS)
    def set_falloff(self, falloff, k) -> None:
        # The handle must be there also after a stroke has been taken back.
        count = len(self.session.store.state.document.handles)
        self._set(lambda editor: editor.set_falloff(k % count, falloff))

    @precondition(_with_regions)
    @rule(percent=st.none() | PERCENT, k=NUMBERS)
    def set_region_area(self, percent, k) -> None:
        # The region must be there also after a stroke has been taken back.
        count = len(self.session.store.state.document.regions)
        self._set(lambda editor: editor.set_region_area(k % count, percent))

    @precondition(_at_rest)
    @rule(size=st.sampled_from(SIZES))
    def open(self, size) -> None:
        self.session.receive_results()
        self.session.files.open_mesh(Mesh(*box(*size)))
        before = self.session.store.state
        while self.session.jobs.current is not None:
            before = self.session.store.state
            self.session.receive_results()
        self._recorded(before)

    @precondition(_at_rest)
    @rule()
    def bake(self) -> None:
        self.session.receive_results()
        before = shown = self.session.store.state
        self.session.shapes.bake()
        while self.session.jobs.current is not None:
            before = self.session.store.state
            self.session.receive_results()
        now = self.session.store.state.document
        assert now.mesh.V is shown.frame.U
        assert now.mesh.F is shown.document.mesh.F
        assert now.labels is shown.document.labels
        assert self.session.store.state.is_at_rest
        self._recorded(before)

    # Going back

    def _expected(self, target, now) -> None:
        document = self.session.store.state.document
        assert self.session.store.state is (target or now)
        assert document.mesh.V.shape == self.session.U.shape
        assert len(self.session.store.state.frame.regions) == len(document.regions)
        self.gesture = None

    @rule()
    def undo(self) -> None:
        now = self.before if self.gesture else self.session.store.state
        target = self.undos.pop() if self.undos else None
        if target:
            self.redos.append(now)
        self.session.gestures.undo()
        self._expected(target, now)

    @rule()
    def redo(self) -> None:
        now = self.before if self.gesture else self.session.store.state
        target = self.redos.pop() if self.redos else None
        if target:
            self.undos.append(now)
        self.session.gestures.redo()
        self._expected(target, now)

    @rule(share=st.floats(0.0, 1.0))
    def travel(self, share) -> None:
        now = self.before if self.gesture else self.session.store.state
        steps = round(share * (len(self.undos) + len(self.redos)))
        target = now
        while len(self.undos) > steps:
            self.redos.append(target)
            target = self.undos.pop()
        while len(self.undos) < steps:
            self.undos.append(target)
            target = self.redos.pop()
        self.session.gestures.go_to_step(steps)
        assert len(self.session.gestures.history.undo_names) == steps
        self._expected(target, now)

    # Time

    @rule(seconds=st.sampled_from([0.0, 0.001, 0.005]))
    def receive(self, seconds) -> None:
        time.sleep(seconds)
        self.session.receive_results()

    @precondition(_at_rest)
    @rule()
    def settle(self) -> None:
        self.session.settle()
        state = self.session.store.state
        document, U = state.document, state.frame.U
        assert U.shape == document.mesh.V.shape
        assert np.isfinite(U).all()
        if self.session.store.activity is Activity.SETTLED:
            held = document.constraints()
            moving = np.isin(held.fixed, np.concatenate(held.handles))
            assert np.array_equal(U[held.fixed][~moving], held.targets[~moving])
            if document.settings.method != "paper":
                assert np.allclose(U[held.fixed], held.targets, rtol=0, atol=1e-12)
            assert not state.has_unmet_target
        # One place measures: what the worker says, and what is said while it sleeps, is the same.
        assert np.allclose(state.frame.regions, document.region_areas(U), rtol=1e-12)

    @precondition(_at_rest)
    @rule()
    def there_and_back(self) -> None:
        """Undo everything, then do it all again."""
        last, undos, redos = self.session.store.state, list(self.undos), list(self.redos)
        while self.undos:
            self.undo()
        if undos:
            assert self.session.store.state is undos[0]
        while len(self.undos) < len(undos):
            self.redo()
        assert self.session.store.state is last
        assert all(a is b for a, b in zip(self.redos, redos, strict=True))

    def teardown(self) -> None:
        try:
            self.session.gestures.cancel()
            self.gesture = None
            self.there_and_back()
            assert self.session.failed == []
        finally:
            self.session.close()
        assert solver_threads() == []
        assert set(threading.enumerate()) <= self.others


class TestUse(Use.TestCase):
    settings = settings(max_examples=15, stateful_step_count=30, deadline=None)


@pytest.mark.night
class TestLongUse(Use.TestCase):
    settings = settings(max_examples=150, stateful_step_count=30, deadline=None)
