"""Mesh to paint and to drag in a notebook, while the solver runs in the kernel."""

from __future__ import annotations

import base64
import inspect
import weakref
from collections.abc import Sequence
from functools import cache, partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.picture_files import png_content
from apd_viewer.geometry.mesh.arrays import check_type, checked_floats
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import (
    BASE,
    FREE,
    HANDLE,
    MOST_HANDLES,
    next_paint_sentence,
    transform,
)
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.deformation_result import deform as plain_deform
from apd_viewer.geometry.solver.held_vertices import vertex_ids
from apd_viewer.geometry.solver.methods import DEFAULT_METHOD, contact_by_default, method_named
from apd_viewer.installation import missing_extra
from apd_viewer.language import tr
from apd_viewer.presentation import number_format
from apd_viewer.presentation.live_solver import LiveShape, LiveSolver
from apd_viewer.presentation.notebook_deform import NotebookResult, deform
from apd_viewer.presentation.palette import label_colors
from apd_viewer.presentation.shape_picture import shape_picture

# Settings of both a deformation and its result, which must have the same bits.
_SETTINGS = tuple(
    name
    for name in inspect.signature(plain_deform).parameters
    if name in inspect.signature(Deformation).parameters and name not in ("V", "F", "fixed", "handle")
)
_PATIENCE = 0.2  # seconds that a request of the page waits for a new shape, as the kernel does nothing else
_MOST_KEPT = 50  # gestures that can be undone
_SIDE = 560  # pixels of the longer side of the picture
_SCRIPTS = "mesh_view.js", "live_view.js"


class _Held(NamedTuple):
    """Labels (n,) of the vertices, and the places (n, 3) of those that are held."""

    labels: np.ndarray
    places: np.ndarray


def live(
    mesh: Mesh,
    base: Sequence[int] | np.ndarray | None = None,
    handles: Sequence[int] | np.ndarray | Sequence[np.ndarray] | None = None,
    **settings: Any,
) -> LiveView:
    """Show a mesh in a notebook, to paint its parts and drag its handles.

    Needs the extra ``notebook``. Pages of Jupyter and marimo show what it returns as the last line of a cell.

    Parameters
    ----------
    mesh : Mesh
    base : (b,) int array, optional
        Vertices that stay where they are; without them they are painted in the view.
    handles : int array or sequence of int arrays, optional
        Vertices of the handle, or of each handle; as above.
    settings
        Method and other settings of :func:`deform`, which are those of :class:`Deformation`.

    Returns
    -------
    LiveView

    Raises
    ------
    InputError
        If the mesh, its parts or a setting cannot be used, or the extra is not installed.

    Examples
    --------
    >>> import apd_viewer
    >>> import numpy as np
    >>> mesh = apd_viewer.open_mesh("bottle.obj")
    >>> base, neck = np.flatnonzero(mesh.V[:, 1] < 1.2), np.flatnonzero(mesh.V[:, 1] > 18.7)
    >>> apd_viewer.live(mesh, base, neck, contact=False)
    bottle.obj: 13,010 vertices, 1,279 of the base, 2,647 of handles; Exact
    """
    view = LiveView(mesh, base, handles, **settings)
    if find_spec("anywidget") is None:
        raise missing_extra(tr("Views in notebooks"), "notebook")
    return view


class LiveView:
    """View of a mesh in a notebook, made by :func:`live`.

    Attributes
    ----------
    mesh : Mesh
    settings : dict
        Those that were given.

    Examples
    --------
    >>> import apd_viewer
    >>> import numpy as np
    >>> mesh = apd_viewer.open_mesh("bottle.obj")
    >>> base, neck = np.flatnonzero(mesh.V[:, 1] < 1.2), np.flatnonzero(mesh.V[:, 1] > 18.7)
    >>> view = apd_viewer.LiveView(mesh, base, neck)
    >>> view.move([[1, 0, 0, 2], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    >>> bool(abs(view.result.area_error) < 1e-8)
    True
    """

    def __init__(
        self,
        mesh: Mesh,
        base: Sequence[int] | np.ndarray | None = None,
        handles: Sequence[int] | np.ndarray | Sequence[np.ndarray] | None = None,
        **settings: Any,
    ) -> None:
        check_type("mesh", mesh, Mesh)
        _check_settings(settings)
        self.mesh, self.settings = mesh, settings
        self._method = method_named(settings.get("method", DEFAULT_METHOD))
        self._held = _Held(_labels(len(mesh.V), base, handles), mesh.V)
        self._history: list[_Held] = []
        self._dragged: np.ndarray | None = None  # places when the drag began
        self._shown = 0  # number of the newest shape that pages have
        self._solver, self._widget = LiveSolver(), None
        weakref.finalize(self, self._solver.close)
        low, high = mesh.V.min(axis=0), mesh.V.max(axis=0)
        self._centre = (low + high) / 2
        if next_paint_sentence(self._held.labels) is None:
            made = _deformation(mesh, self.fixed, self.handles, settings)
            self._solver.open(lambda: made, self.targets, None)

    # What scripts read

    @property
    def fixed(self) -> np.ndarray:
        """Vertices of base and handles, (k,) int array, ascending."""
        return np.flatnonzero(self._held.labels != FREE)

    @property
    def base(self) -> np.ndarray:
        """Vertices of the base, (b,) int array, ascending."""
        return np.flatnonzero(self._held.labels == BASE)

    @property
    def handles(self) -> list[np.ndarray]:
        """Vertices of each handle, ascending."""
        labels = self._held.labels
        return [np.flatnonzero(labels == label) for label in np.unique(labels[labels >= HANDLE])]

    @property
    def targets(self) -> np.ndarray:
        """Target position of each vertex in ``fixed``, (k, 3) float array."""
        return self._held.places[self.fixed]

    @property
    def frame(self) -> Frame | None:
        """Newest frame of the solver; None before the first."""
        return self._solver.shape.frame

    @property
    def U(self) -> np.ndarray:
        """Newest shape, (n, 3) float array; at first the rest shape."""
        frame = self.frame
        return self.mesh.V if frame is None else frame.U

    @property
    def result(self) -> NotebookResult:
        """Result of :func:`deform` from the rest shape to the same targets, computed anew.

        It has the bits of ``deform``. The shape on screen came another way, from drag to drag: it has the
        same targets, and may have come to rest elsewhere, for instance after more than half a turn.
        """
        self._check_painted()
        with self._solver.held():
            return deform(
                self.mesh.V, self.mesh.F, self.fixed, self.targets, handle=self.handles, **self.settings
            )

    def move(self, motion: Any, handle: int = 0) -> None:
        """Move a handle to where a matrix takes it from rest, or to targets.

        Parameters
        ----------
        motion : (4, 4) or (k, 3) float array
            Matrix, or the target of each of the handle's vertices, in ascending order.
        handle : int
            Number of the handle, from 0.

        Raises
        ------
        InputError
            If there is no such handle, or the array has another shape.
        """
        self._check_painted()
        handles = self.handles
        if type(handle) is not int or not 0 <= handle < len(handles):
            raise InputError(tr("There are handles 0 to {last}.").format(last=len(handles) - 1))
        ids, given = handles[handle], checked_floats(motion, tr("The motion"))
        if given.shape == (4, 4):
            given = transform(given, self.mesh.V[ids])
        if given.shape != (len(ids), 3):
            raise InputError(tr("Give a matrix (4, 4), or {count} targets (x, y, z).").format(count=len(ids)))
        self._keep()
        self._place(ids, given)
        self._wake()

    def undo(self) -> None:
        """Undo the last stroke, drag or :meth:`move`."""
        if self._history:
            before = self._history.pop()
            is_same = np.array_equal(before.labels, self._held.labels)
            self._held = before
            self._aim() if is_same else self._open()
            self._wake()

    # What the page asks

    def answer(
        self, message: dict[str, Any], buffers: Sequence[Any] = ()
    ) -> tuple[dict[str, Any], list[bytes]]:
        """Answer and its arrays to a message of the page, in the kernel's own thread.

        The solver is on another thread, and has mostly computed the answer ahead.
        """
        told, arrays = self._answer(message, buffers)
        return told | {"view": message.get("view")}, arrays

    def _answer(self, message: dict[str, Any], buffers: Sequence[Any]) -> tuple[dict[str, Any], list[bytes]]:
        op = message.get("op")
        try:
            if op == "paint":
                self._paint(int(message["label"]), np.frombuffer(buffers[0], "<u4"))
            elif op == "drag":
                self._drag(message)
            elif op == "undo":
                self.undo()
        except InputError as error:
            return self._told(self._solver.shape) | {"problem": str(error)}, []
        if op in ("hello", "paint", "undo"):
            told = self._told(self._solver.shape) | {"labels": True}
            arrays = [self._held.labels.astype(np.uint8).tobytes(), self._positions(self.U)]
            if op == "hello":
                told |= {"hello": True, "texts": _texts(), "colors": _colors()}
                arrays += [self._positions(self.mesh.V), self.mesh.F.astype("<u4").tobytes()]
            return told, arrays
        # Of two requests on their way the second waits for the shape after the first one's.
        shape = self._solver.newer_shape(self._shown, _PATIENCE)
        if shape.frame is None or shape.number <= int(message.get("number", 0)):
            return self._told(shape), []
        self._shown = shape.number
        return self._told(shape), [self._positions(shape.frame.U)]

    def _told(self, shape: LiveShape) -> dict[str, Any]:
        """Readings of a shape for the page, and what it says below the view."""
        labels = self._held.labels
        missing = next_paint_sentence(labels)
        state = tr("solving") if shape.is_at_work else tr("converged")
        area = ""
        if shape.frame is not None:
            area = f"{number_format.format_grouped(100 * (1 + shape.frame.area_error), 6)}\u00a0%"
            if not shape.is_at_work and not shape.frame.converged:
                state = tr("not converged")
        elif shape.is_at_work:
            state = tr("preparing")
        places = {
            int(label): (self._held.places[labels == label].mean(axis=0) - self._centre).tolist()
            for label in np.unique(labels[labels >= HANDLE])
        }
        return {
            "number": shape.number,
            "isAtWork": shape.is_at_work,
            "area": area,
            "method": _plain(self._method.short_title),
            "state": "" if missing else _plain(state),
            "hint": _plain(missing or ""),
            "problem": shape.problem,
            "places": places,
            "canUndo": bool(self._history),
        }

    def _positions(self, X: np.ndarray) -> bytes:
        """Positions about the centre in single precision, which is enough to draw them."""
        return (X - self._centre).astype("<f4").tobytes()

    def _drag(self, message: dict[str, Any]) -> None:
        """Move the handle of a label by a matrix from where the drag began."""
        ids = np.flatnonzero(self._held.labels == int(message["label"]))
        if message.get("begins") or self._dragged is None:
            self._keep()
            self._dragged = self._held.places
        about = np.eye(4)
        about[:3, 3] = self._centre
        back = np.eye(4)
        back[:3, 3] = -self._centre
        matrix = about @ checked_floats(message["matrix"], "matrix").reshape(4, 4) @ back
        self._place(ids, transform(matrix, self._dragged[ids]))

    def _paint(self, label: int, ids: np.ndarray) -> None:
        """Give vertices a label; held ones stay where they are now."""
        if not 0 <= label < HANDLE + MOST_HANDLES:
            raise InputError(tr("There are at most {most} handles.").format(most=MOST_HANDLES))
        self._keep()
        labels, places = self._held.labels.copy(), self._held.places.copy()
        ids = vertex_ids(ids.astype(np.int64), len(labels))
        ids = ids[labels[ids] != label]
        newly = ids[labels[ids] == FREE]
        places[newly] = self.U[newly]
        labels[ids] = label
        self._held = _Held(labels, places)
        self._open()

    def _keep(self) -> None:
        """Keep the state before a gesture."""
        self._history = [*self._history[1 - _MOST_KEPT :], self._held]
        self._dragged = None

    def _place(self, ids: np.ndarray, targets: np.ndarray) -> None:
        places = self._held.places.copy()
        places[ids] = targets
        self._held = self._held._replace(places=places)
        self._aim()

    def _aim(self) -> None:
        if next_paint_sentence(self._held.labels) is None:
            self._solver.aim(self.targets)

    def _open(self) -> None:
        """Have the solver go on with the parts as they are now."""
        if next_paint_sentence(self._held.labels) is not None:
            self._solver.stop()
            return
        make = partial(_deformation, self.mesh, self.fixed, self.handles, self.settings)
        self._solver.open(make, self.targets, self.U)

    def _check_painted(self) -> None:
        missing = next_paint_sentence(self._held.labels)
        if missing:
            raise InputError(missing)

    # What notebooks show

    def _repr_mimebundle_(self, **_: Any) -> dict[str, Any]:
        """The widget, and for pages without a kernel a picture and a line of text."""
        colors = label_colors(self._held.labels)[:, :3]
        pixels = shape_picture([self.U], self.mesh.F, [_triangle_colors(colors, self.mesh.F)], _SIDE)
        own = {"text/plain": repr(self), "image/png": base64.b64encode(png_content(pixels)).decode()}
        shown = self._display_()._repr_mimebundle_()
        return (shown[0] if isinstance(shown, tuple) else shown or {}) | own

    def _display_(self) -> Any:
        """The widget, as marimo shows it."""
        if self._widget is None:
            self._widget = _widget(weakref.ref(self))
        return self._widget

    def __repr__(self) -> str:
        name = self.mesh.path.name if self.mesh.path else tr("mesh")
        counts = tr("{vertices:,} vertices, {base:,} of the base, {handles:,} of handles")
        told = counts.format(
            vertices=len(self.mesh.V), base=len(self.base), handles=sum(map(len, self.handles))
        )
        return f"{name}: {told}; {self._method.short_title}"

    def _wake(self) -> None:
        """Have open pages ask for shapes."""
        if self._widget is not None:
            self._widget.send({"wake": True})


def _check_settings(settings: dict[str, Any]) -> None:
    for name in settings:
        if name not in _SETTINGS:
            raise InputError(
                tr("“{name}” is no setting; known are {names}.").format(name=name, names=", ".join(_SETTINGS))
            )


def _labels(n: int, base: Any, handles: Any) -> np.ndarray:
    """Labels (n,) of given parts; raises InputError for wrong or common vertices."""
    labels = np.full(n, FREE)
    if base is not None:
        labels[vertex_ids(base, n)] = BASE
    listed = isinstance(handles, Sequence) or (isinstance(handles, np.ndarray) and handles.ndim > 0)
    if handles is not None and not listed:
        raise InputError(tr("The handle must be an array of vertex IDs, or a list of such arrays."))
    several = handles is not None and len(handles) > 0 and np.ndim(handles[0]) > 0
    for k, each in enumerate(() if handles is None else handles if several else (handles,)):
        if k >= MOST_HANDLES:
            raise InputError(tr("There are at most {most} handles.").format(most=MOST_HANDLES))
        ids = vertex_ids(each, n, "handle")
        if (labels[ids] != FREE).any():
            raise InputError(tr("A vertex can belong to the base or to one handle only."))
        labels[ids] = HANDLE + k
    return labels


def _deformation(
    mesh: Mesh, fixed: np.ndarray, handles: list[np.ndarray], settings: dict[str, Any]
) -> Deformation:
    """Deformation with the settings that :func:`deform` would take."""
    given = dict(settings)
    if given.get("contact") is None:
        given["contact"] = contact_by_default(given.get("method", DEFAULT_METHOD), len(mesh.V))
    return Deformation(mesh.V, mesh.F, fixed, handle=handles, **given)


def _triangle_colors(colors: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Mean colours (m, 3) uint8 of the corners of triangles."""
    return np.rint(colors[F].mean(axis=1)).astype(np.uint8)


def _colors() -> list[list[int]]:
    """RGB of each label."""
    return label_colors(np.arange(HANDLE + MOST_HANDLES))[:, :3].tolist()


def _texts() -> dict[str, str]:
    """Texts of the page, in the user's language."""
    texts = {
        "view": tr("Mesh to drag"),
        "drag": tr("Drag"),
        "base": tr("Base"),
        "handle": tr("Handle {k}"),
        "erase": tr("Erase"),
        "size": tr("Brush size"),
        "undo": tr("Undo"),
        "fit": tr("Fit"),
        "area": tr("Area"),
        "noView": tr("This browser has no WebGL2, which the view needs."),
    }
    return {name: _plain(text) for name, text in texts.items()}


def _plain(text: str) -> str:
    """Text of the type that all writers of JSON know."""
    return "".join(text)


def _widget(view: weakref.ref[LiveView]) -> Any:
    """Widget whose messages are answered by a view."""
    widget = _widget_class()()

    def answer(_: object, message: dict[str, Any], buffers: Sequence[Any]) -> None:
        shown = view()
        if shown is not None:
            told, arrays = shown.answer(message, buffers)
            widget.send(told, buffers=arrays)

    widget.on_msg(answer)
    return widget


@cache
def _widget_class() -> Any:
    # Imported here: it belongs to an extra.
    import anywidget

    folder = Path(__file__).parent
    script = "".join((folder / name).read_text(encoding="utf-8") for name in _SCRIPTS)
    # It has no state but its script: arrays in the state would be saved with the notebook.
    return type("LiveWidget", (anywidget.AnyWidget,), {"_esm": script})
