"""The user's verbs. Owns the history, and the stage on which all is answered; knows no window.

All methods are called on one thread.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from apd_viewer.files.meshes import Written, check_target, open_mesh, save_mesh
from apd_viewer.files.samples import SAMPLES, open_sample
from apd_viewer.geometry.mesh import Mesh
from apd_viewer.session.document import Document, Handle, NamedRegion, State, opened, rest_frame
from apd_viewer.session.errand import Errand, Errands
from apd_viewer.session.history import History
from apd_viewer.session.names import new_name, next_name
from apd_viewer.session.stage import Activity, Listener, Stage
from apd_viewer.session.units import Unit
from apd_viewer.session.worker import Worker

__all__ = ["MOST_HANDLES", "MOST_REGIONS", "Activity", "Listener", "Session"]

MOST_HANDLES = MOST_REGIONS = 8


class Session:
    """One mesh, what is painted on it, what is asked of it, and the worker that answers.

    Attributes
    ----------
    history : History
    unit : Unit
        Of lengths, for what is told; the mesh that is open is in it.
    """

    def __init__(self, listener: Listener) -> None:
        self._listener = listener
        self._worker = Worker(listener.wake)
        self._stage = Stage(listener, self._worker)
        self._errands = Errands(listener.wake, listener.failed)
        self._gesture: State | None = None
        self._saved: list[np.ndarray] = []
        self.history = History()
        self.unit = Unit.NONE

    @property
    def state(self) -> State | None:
        """What is open; None until there is something."""
        return self._stage.state

    @property
    def activity(self) -> Activity:
        """What the worker is doing about the shape on screen."""
        return self._stage.activity

    @property
    def preparing(self) -> bool:
        """Whether the first shape has to wait until the worker is ready for it."""
        return self._stage.preparing

    @property
    def seconds_per_iteration(self) -> float:
        """Time that the last iteration took."""
        return self._stage.seconds_per_iteration

    @property
    def errand(self) -> Errand | None:
        """The file that is being opened or written."""
        return self._errands.current

    # Opening and writing

    def open(self, path: str | Path) -> None:
        """Open the mesh at ``path``, in the background; what is open stays until the new one is there."""
        self._open(Path(path).name, lambda: opened(open_mesh(path)))

    def open_sample(self, name: str) -> None:
        """Open a sample, painted, in the background."""
        self._open(SAMPLES[name], lambda: opened(*open_sample(name)))

    def show(self, mesh: Mesh) -> None:
        """Open a mesh that is in memory already."""
        self._open(mesh.name, lambda: opened(mesh))

    def _open(self, name: str, work: Callable[[], State]) -> None:
        self._send(f"Opening {name}", work, lambda state: self._opened(state, name))

    def _opened(self, state: State, name: str) -> None:
        before, self._gesture = self._gesture or self.state, None
        if before is not None:
            self.history.record(f"Open {name}", before)
            state = state.at(state.document.with_settings_of(before.document))
        self._stage.jump(state)
        findings = state.inspection.findings
        if len(findings) == 1:
            self._listener.told(findings[0].sentence)
        elif findings:
            count = f"{len(findings)} findings"
            self._listener.told(f"The mesh has {count}: the badge at the lower right lists and shows them.")

    def export(self, path: str | Path) -> None:
        """Write the shape on screen, in the background."""
        state = self._stage.required()
        path, U, unit = Path(path), state.frame.U, self.unit

        def write() -> Written:
            return save_mesh(state.document.mesh, U, check_target(path))

        def written(file: Written) -> None:
            self._saved.append(U)
            area, part = unit.area(f"{file.area:.6g}"), 100.0 * file.area / state.inspection.area
            self._listener.told(f"Exported {path.name}: area {area}, {part:.3f} % of the rest area.")

        self._send(f"Writing {path.name}", write, written, can_be_cancelled=False)

    def _send(
        self, title: str, work: Callable[[], object], done: Callable[..., None], can_be_cancelled: bool = True
    ) -> None:
        self._errands.send(title, work, done, can_be_cancelled)
        self._listener.status_changed()

    def cancel_errand(self) -> None:
        """Forget the file that is being opened; a file being written is left to finish, whole."""
        if cancelled := self._errands.cancel():
            self._listener.told(f"{cancelled.title}: cancelled.")
            self._listener.status_changed()

    @property
    def unsaved(self) -> list[Mesh]:
        """The meshes, on screen or a few undos away, whose latest shape has not been exported."""
        states = [*self.history.past, *([self.state] if self.state else [])]
        latest = {id(state.document.mesh): state for state in states}
        return [
            state.document.mesh
            for state in latest.values()
            if not any(state.frame.U is kept for kept in (state.document.mesh.V, *self._saved))
        ]

    @property
    def moved(self) -> bool:
        """Whether anything is not as it was at rest, or asked not to be."""
        state = self._stage.required()
        document = state.document
        asks = any(percent not in (None, 100.0) for percent in document.targets)
        return state.frame.U is not document.mesh.V or document.posed or asks

    # Gestures

    def begin_gesture(self) -> None:
        """Start what will be one step of undo, such as a stroke, a drag or the sweep of a slider."""
        self._gesture = self._stage.required()

    def end_gesture(self, gesture: str) -> None:
        """Finish a drag or a sweep; the worker goes on until the shape has settled."""
        before, self._gesture = self._gesture, None
        if before is not None and before.document is not self._stage.required().document:
            self._record(gesture, before)

    def cancel_gesture(self) -> None:
        """Go back to where the gesture began."""
        if self._gesture is not None:
            before, self._gesture = self._gesture, None
            self._stage.jump(before)

    # Painting

    def paint(self, ids: np.ndarray, label: int) -> None:
        """Label the vertices ``ids`` within the current gesture; the shape stays as it is."""
        state = self._stage.required()
        if self._gesture is not None:  # undo may have ended the stroke
            self._stage.show(state.at(state.document.painted(ids, label)))

    def paint_region(self, ids: np.ndarray, number: int) -> None:
        """Put the vertices ``ids`` in region ``number``, from 1, within the current gesture; 0 erases.

        One number past the last makes a region: the first stroke needs none to be there.
        """
        state = self._stage.required()
        if self._gesture is not None:
            document = state.document
            if number > len(document.regions):
                document = document.with_region(number - 1, _next_region(document))
            document = document.painted_region(ids, number)
            asks = any(region.area is not None for region in document.regions)
            (self._stage.say if asks else self._stage.note)(document)

    def end_stroke(self, gesture: str) -> None:
        """Finish painting; under new labels, base and handles are gripped where they are now."""
        before, document = self._gesture, self._stage.required().document
        self.end_gesture(gesture)
        if before is not None and not np.array_equal(before.document.labels, document.labels):
            self._stage.regrip(before.document, document)

    # Handles

    def move_handle(self, pose: np.ndarray, which: int = 0) -> None:
        """Put a handle at ``pose`` (4, 4), measured from where it was gripped, within a gesture."""
        state = self._stage.required()
        if self._gesture is not None:  # another mesh may have ended the drag
            self._stage.say(state.document.moved(which, pose))

    def reset_handle(self) -> None:
        """Put the handles back and the mesh in its rest shape, asked for 100 % of all; the paint stays."""
        state = self._alone()
        if self.moved:
            self._record("Reset handle", state)
            rest = rest_frame(state.document.mesh, state.inspection)
            self._stage.jump(state.at(state.document.at_rest(), rest))

    def add_handle(self) -> int:
        """One more handle, not painted yet; its number, or that of the last where there can be no more."""
        state = self._alone()
        handles = state.document.handles
        if len(handles) >= MOST_HANDLES:
            self._listener.failed(f"There are {MOST_HANDLES} handles already; remove one of them first.")
            return len(handles) - 1
        self._record("Add handle", state)
        name = next_name("Handle", [handle.name for handle in handles])
        self._stage.note(state.document.with_handle(len(handles), Handle(name)))
        return len(handles)

    def remove_handle(self, k: int) -> None:
        """Remove handle ``k``: what it held is free, and the others are gripped where they are now."""
        state = self._alone()
        self._record("Remove handle", state)
        self._stage.regrip(state.document, state.document.without_handle(k))

    def rename_handle(self, k: int, name: str) -> None:
        """Give handle ``k`` a name of its own."""
        state = self._stage.required()
        handle = state.document.handles[k]
        name = new_name(name, handle.name, [other.name for other in state.document.handles])
        if name != handle.name:
            state = self._alone()
            self._record("Rename", state)
            self._stage.note(state.document.with_handle(k, replace(handle, name=name)))

    # Regions

    def add_region(self) -> int:
        """One more region, without a vertex; its number, or that of the last where there can be no more."""
        state = self._alone()
        regions = state.document.regions
        if len(regions) >= MOST_REGIONS:
            self._listener.failed(f"There are {MOST_REGIONS} regions already; remove one of them first.")
            return len(regions) - 1
        self._record("Add region", state)
        self._stage.note(state.document.with_region(len(regions), _next_region(state.document)))
        return len(regions)

    def remove_region(self, k: int) -> None:
        """Remove region ``k``, and what is asked of its area."""
        state = self._alone()
        self._record("Remove region", state)
        asked = state.document.regions[k].area is not None
        (self._stage.say if asked else self._stage.note)(state.document.without_region(k))

    def rename_region(self, k: int, name: str) -> None:
        """Give region ``k`` a name of its own."""
        state = self._stage.required()
        region = state.document.regions[k]
        name = new_name(name, region.name, [other.name for other in state.document.regions])
        if name != region.name:
            state = self._alone()
            self._record("Rename", state)
            self._stage.note(state.document.with_region(k, replace(region, name=name)))

    def set_region_area(self, k: int, percent: float | None) -> None:
        """Ask for an area of region ``k``, in percent of its area at rest; None only measures it."""
        document = self._stage.required().document
        region = document.regions[k]
        if percent != region.area:
            self._set("Change region", regions=document.with_region(k, replace(region, area=percent)).regions)

    # Settings: outside a gesture each is one step of undo, within it they are part of it

    def set_area(self, percent: float) -> None:
        """Ask for another total area, in percent of the area at rest."""
        self._set("Change area", area=percent)

    def hold_area(self, on: bool) -> None:
        """Have the method "local" keep the total area too, or not."""
        self._set("Change area", hold_area=on)

    def set_volume(self, percent: float | None) -> None:
        """Ask for a volume, in percent of the volume at rest; None leaves it free."""
        inspection = self._stage.required().inspection
        if percent is not None and not inspection.volume:
            why = inspection.why_no_volume or "the surface encloses nothing"
            self._listener.failed(f"There is no volume to keep: {why}; leave the volume free.")
        else:
            self._set("Change volume", volume=percent)

    def set_method(self, method: str) -> None:
        """Deform by another method, from the shape on screen."""
        self._set("Change method", method=method)

    def set_tolerance(self, tolerance: float) -> None:
        """Have "paper" accept another relative error of the area."""
        self._set("Change tolerance", tolerance=tolerance)

    def set_stiffness(self, stiffness: float) -> None:
        """Resist bending by another weight."""
        self._set("Change stiffness", stiffness=stiffness)

    def set_material(self, area_stiffness: float | None = None, shear_stiffness: float | None = None) -> None:
        """Have the method "local" resist changes of areas and of shapes by other weights."""
        given = {"area_stiffness": area_stiffness, "shear_stiffness": shear_stiffness}
        self._set("Change stiffness", **{name: x for name, x in given.items() if x is not None})

    def _set(self, gesture: str, **what: object) -> None:
        state = self._stage.required()
        if all(getattr(state.document, name) == value for name, value in what.items()):
            return
        painted = self._gesture is not None and not state.document.painted_like(self._gesture.document)
        if self._gesture is None or painted:
            # What a stroke has painted is not gripped yet, and would leap.
            state = self._alone()
            self._record(gesture, state)
        self._stage.say(replace(state.document, **what))  # type: ignore[arg-type]

    # Going back

    def undo(self) -> None:
        """Take the last gesture back: the very document and shape that were there before it."""
        self._go(self.history.undo)

    def redo(self) -> None:
        """Do again what was undone last."""
        self._go(self.history.redo)

    def _go(self, swap: Callable[[State], State | None]) -> None:
        target = swap(self._alone())
        if target is not None:
            self._stage.jump(target)

    def _alone(self) -> State:
        """The state, after going back to where a gesture under way began."""
        self.cancel_gesture()
        return self._stage.required()

    def _record(self, gesture: str, before: State) -> None:
        self.history.record(gesture, before)
        self._listener.status_changed()

    # The other threads

    def receive(self) -> None:
        """Take in what the worker and the errands have left; call it when woken."""
        while self._errands.receive():
            self._listener.status_changed()
        self._stage.receive()

    def wait_idle(self, timeout: float) -> bool:
        """Receive until nothing is under way any more; False if that took longer than ``timeout`` seconds."""
        until = time.monotonic() + timeout
        while time.monotonic() < until:
            self.receive()
            if self.errand is None and self.activity is not Activity.REFINING:
                return True
            time.sleep(0.002)
        return False

    def close(self) -> None:
        """Stop the worker; a file that is being written is finished first."""
        self._errands.close()
        self._worker.close()


def _next_region(document: Document) -> NamedRegion:
    """A region with a name that is not in use."""
    return NamedRegion(next_name("Region", [region.name for region in document.regions]))
