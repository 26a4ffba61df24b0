"""Whatever the user does in whatever order: hypothesis tells the session what to do."""

import threading
import time

import numpy as np
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, precondition, rule
from meshes import box, rotation
from test_session import Driven, solver_threads

from apd_viewer.geometry.constraints import BASE, FREE, HANDLE
from apd_viewer.geometry.mesh import Mesh
from apd_viewer.session.session import Activity

SIZES = ((1, 1, 3), (2, 1, 3), (1, 1, 4))


def _at_rest(machine) -> bool:
    return machine.gesture is None


def _painting(machine) -> bool:
    return machine.gesture == "stroke"


def _dragging(machine) -> bool:
    return machine.gesture == "drag"


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
        z = self.session.state.document.mesh.V[:, 2]
        for label, ids in ((BASE, z == 0), (HANDLE, z == z.max())):
            before = self.session.state
            self.session.stroke(np.flatnonzero(ids), label)
            self._recorded(before)

    def _recorded(self, before) -> None:
        self.undos.append(before)
        self.redos.clear()

    # Gestures

    @precondition(_at_rest)
    @rule(kind=st.sampled_from(["stroke", "drag", "drag"]))
    def begin(self, kind) -> None:
        self.session.begin_gesture()
        self.gesture, self.before = kind, self.session.state

    @precondition(_painting)
    @rule(layer=st.integers(0, 4), label=st.sampled_from([BASE, FREE, FREE, HANDLE]))
    def paint(self, layer, label) -> None:
        z = self.session.state.document.mesh.V[:, 2]
        self.session.paint(np.flatnonzero(z == min(layer, z.max())), label)

    @precondition(_dragging)
    @rule(
        angle=st.floats(-0.5, 0.5),
        shift=st.tuples(*[st.floats(-0.4, 0.4)] * 3),
        steps=st.integers(1, 8),
        seconds=st.sampled_from([0.0, 0.0, 0.001]),
    )
    def drag(self, angle, shift, steps, seconds) -> None:
        for k in range(1, steps + 1):
            pose = np.eye(4)
            pose[:3, :3] = rotation((0, 0, 1), angle * k / steps)
            pose[:3, 3] = np.array(shift) * k / steps
            self.session.move_handle(pose)
            time.sleep(seconds)

    @precondition(_painting)
    @rule()
    def end_stroke(self) -> None:
        before, now = self.before, self.session.state
        self.session.end_stroke("Paint")
        if np.array_equal(before.document.labels, now.document.labels):
            assert self.session.state.document is before.document
        else:
            assert self.session.U is now.frame.U
            assert self.session.state.document.grip is now.frame.U
            self._recorded(before)
        self.gesture = None

    @precondition(_dragging)
    @rule()
    def end_drag(self) -> None:
        self.session.end_gesture("Move handle")
        if self.session.state.document is not self.before.document:
            self._recorded(self.before)
        self.gesture = None

    @rule()
    def cancel(self) -> None:
        self.session.cancel_gesture()
        if self.gesture:
            assert self.session.state is self.before
        self.gesture = None

    # Single acts, which take back the gesture that they come in the middle of.

    def _before_act(self):
        before = self.before if self.gesture else self.session.state
        self.gesture = None
        return before

    @rule()
    def reset(self) -> None:
        before = self._before_act()
        self.session.reset_handle()
        assert self.session.U is before.document.mesh.V
        if self.session.state is not before:
            self._recorded(before)

    @rule(method=st.sampled_from(["arap", "paper"]))
    def set_method(self, method) -> None:
        before = self._before_act()
        self.session.set_method(method)
        if method != before.document.method:
            self._recorded(before)

    @rule(tolerance=st.sampled_from([1e-3, 1e-2, 0.1]))
    def set_tolerance(self, tolerance) -> None:
        before = self._before_act()
        self.session.set_tolerance(tolerance)
        if tolerance != before.document.tolerance:
            self._recorded(before)

    @precondition(_at_rest)
    @rule(size=st.sampled_from(SIZES))
    def open(self, size) -> None:
        self.session.receive()
        self.session.show(Mesh(*box(*size)))
        before = self.session.state
        while self.session.errand is not None:
            before = self.session.state
            self.session.receive()
        self._recorded(before)

    # Going back

    def _expected(self, target, now) -> None:
        document = self.session.state.document
        assert self.session.state is (target or now)
        assert document.mesh.V.shape == self.session.U.shape
        self.gesture = None

    @rule()
    def undo(self) -> None:
        now = self.before if self.gesture else self.session.state
        target = self.undos.pop() if self.undos else None
        if target:
            self.redos.append(now)
        self.session.undo()
        self._expected(target, now)

    @rule()
    def redo(self) -> None:
        now = self.before if self.gesture else self.session.state
        target = self.redos.pop() if self.redos else None
        if target:
            self.undos.append(now)
        self.session.redo()
        self._expected(target, now)

    # Time

    @rule(seconds=st.sampled_from([0.0, 0.001, 0.005]))
    def receive(self, seconds) -> None:
        time.sleep(seconds)
        self.session.receive()

    @precondition(_at_rest)
    @rule()
    def settle(self) -> None:
        self.session.settle()
        state = self.session.state
        document, U = state.document, state.frame.U
        assert U.shape == document.mesh.V.shape
        assert np.isfinite(U).all()
        if self.session.activity is Activity.SETTLED:
            held = document.constraints()
            base = ~np.isin(held.fixed, held.handle)
            assert np.array_equal(U[held.fixed][base], held.targets[base])
            if document.method == "arap":
                assert np.allclose(U[held.fixed], held.targets, rtol=0, atol=1e-12)
            else:
                assert abs(state.frame.area_error) <= document.tolerance

    @precondition(_at_rest)
    @rule()
    def there_and_back(self) -> None:
        """Undo everything, then do it all again."""
        last, undos, redos = self.session.state, list(self.undos), list(self.redos)
        while self.undos:
            self.undo()
        if undos:
            assert self.session.state is undos[0]
        while len(self.undos) < len(undos):
            self.redo()
        assert self.session.state is last
        assert all(a is b for a, b in zip(self.redos, redos, strict=True))

    def teardown(self) -> None:
        try:
            self.session.cancel_gesture()
            self.gesture = None
            self.there_and_back()
            assert self.session.failed == []
        finally:
            self.session.close()
        assert solver_threads() == []
        assert set(threading.enumerate()) <= self.others


TestUse = Use.TestCase
TestUse.settings = settings(max_examples=30, stateful_step_count=25, deadline=None)
