"""Choosing vertices in every way on a real window, and a look at every vertex and triangle beside it."""

from collections import defaultdict
from typing import Any

import meshes
import numpy as np
import pytest
from driving import Mouse, arrow_grip, drag, idle, show, work_off
from PySide6.QtCore import QEvent, QSettings, Qt
from PySide6.QtWidgets import QApplication

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.presentation.palette import BASE_COLOR, FREE_COLOR, HANDLE_COLORS, REGION_COLORS, label_colors
from apd_viewer.ui.filing import file_controller
from apd_viewer.ui.filing.file_controller import UnsavedAnswer
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.tools.tool_modes import SelectionMode, Tool
from apd_viewer.ui.workbench import Workbench

NONE = Qt.KeyboardModifier.NoModifier
ALT = Qt.KeyboardModifier.AltModifier
CONTROL = Qt.KeyboardModifier.ControlModifier
OUTLINES = SelectionMode.BOX, SelectionMode.LASSO, SelectionMode.POLYGON
TOUCHES = SelectionMode.FILL, SelectionMode.PIECE, SelectionMode.LOOP
COLORS = {
    Tool.BASE: BASE_COLOR,
    Tool.HANDLE: HANDLE_COLORS[0],
    Tool.REGION: REGION_COLORS[0],
    Tool.ERASE: FREE_COLOR,
}
CREASE = 12.5  # degrees: on all meshes a fill then is more than a triangle, and less than a piece


def in_polygon(points, corners):
    """Oracle: whether a ray to the right crosses an odd number of the sides."""
    odd = np.zeros(len(points), dtype=bool)
    for (ax, ay), (bx, by) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if ay != by:
            crosses = (ay <= points[:, 1]) != (by <= points[:, 1])
            odd ^= crosses & (points[:, 0] < ax + (points[:, 1] - ay) / (by - ay) * (bx - ax))
    return odd


def meets(origin, directions, A, B, C):
    """Oracle: how far lines (k, 3) go until they meet triangles (m, 3); (k, m), infinite where they miss."""
    e, g, s = B - A, C - A, origin - A
    p, q = np.cross(directions[:, None], g), np.cross(s, e)
    with np.errstate(divide="ignore", invalid="ignore"):
        det = (p * e).sum(axis=2)
        u, v = (p * s).sum(axis=2) / det, directions @ q.T / det
        t = (q * g).sum(axis=1) / det
        within = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9) & (t > 0)
    return np.where(within, t, np.inf)


class Sight:
    """Oracle: what a window shows, found out from its positions and its camera by plain search.

    Attributes
    ----------
    place : (n,) int array
        Number of the position of each vertex at rest: those at a seam have the same.
    F : (m, 3) int array
        Triangles between places.
    U : (p, 3) float array
        Of the places, as shown.
    """

    _found: dict[tuple, Any] = {}  # noqa: RUF012 - it is slow, and the same views come again

    def __init__(self, window):
        state, self.eye = window.session.store.state, window.canvas.viewport.camera_controller.camera
        mesh = state.document.mesh
        _, first, place = np.unique(mesh.V, axis=0, return_index=True, return_inverse=True)
        self.place = place.ravel()
        self.F, self.U = self.place[mesh.F], state.frame.U[first]
        self.screen = window.canvas.viewport.camera_controller.camera.project(self.U)
        self.surface = self.F.tobytes()

    def _cached(self, name, find, *key):
        """What is found for a key, and found again without a search."""
        whole = name, *key
        if whole not in self._found:
            self._found[whole] = find()
        return self._found[whole]

    @property
    def ring(self):
        """The places beside each."""
        return self._cached("ring", self._find_ring, self.surface)

    def _find_ring(self):
        ring = defaultdict(set)
        for corners in self.F.tolist():
            for v in corners:
                ring[v] |= set(corners) - {v}
        return ring

    def vertices(self, places):
        """The vertices at places, (n,) bool array."""
        return np.isin(self.place, list(places))

    @property
    def seen(self):
        """Whether no triangle is in the way to a place, (p,) bool array."""
        return self._cached("seen", self._find_seen, self.U.tobytes(), self.eye.key)

    def _find_seen(self):
        far = meets(self.eye.position, self.U - self.eye.position, *self.U[self.F].swapaxes(0, 1))
        own = (self.F[None] == np.arange(len(self.U))[:, None, None]).any(axis=2)
        return ~((far < 1 - 1e-6) & ~own).any(axis=1)

    def hit(self, at):
        """Triangle and point (3,) that are seen at a position on the screen; None where there is nothing."""
        origin, direction = self.eye.ray(*at)
        far = meets(origin, direction[None], *self.U[self.F].swapaxes(0, 1))[0]
        face = int(np.argmin(far))
        return (face, origin + far[face] * direction) if np.isfinite(far[face]) else None

    def within(self, corners, through=False):
        ahead = (self.U - self.eye.position) @ self.eye.axes[2] > 0
        found = ahead & in_polygon(self.screen, np.array(corners, dtype=float))
        return set(np.flatnonzero(found if through else found & self.seen).tolist())

    def rings(self, seeds):
        """How many edges every place is away from the nearest seed that it is connected with."""
        away, front = dict.fromkeys(seeds, 0), set(seeds)
        while front:
            count = away[next(iter(front))] + 1
            front = {w for v in front for w in self.ring[v]} - set(away)
            away |= dict.fromkeys(front, count)
        return away

    @property
    def faces_of_edges(self):
        return self._cached("faces", self._find_faces, self.surface)

    def _find_faces(self):
        found = defaultdict(list)
        for t, corners in enumerate(self.F.tolist()):
            for c in range(3):
                found[frozenset((corners[c], corners[c - 1]))].append(t)
        return found

    def fill(self, face, crease):
        A, B, C = self.U[self.F].swapaxes(0, 1)
        normal = np.cross(B - A, C - A)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        beside = defaultdict(set)
        for faces in self.faces_of_edges.values():
            if len(faces) == 2 and normal[faces[0]] @ normal[faces[1]] >= np.cos(np.deg2rad(crease)):
                beside[faces[0]].add(faces[1])
                beside[faces[1]].add(faces[0])
        found, front = {face}, {face}
        while front:
            front = {s for t in front for s in beside[t]} - found
            found |= front
        return set(self.F[list(found)].ravel().tolist())

    @property
    def loops(self):
        """The loops of the border, each a set of places."""
        return self._cached("loops", self._find_loops, self.surface)

    def _find_loops(self):
        beside = defaultdict(set)
        for edge, faces in self.faces_of_edges.items():
            if len(faces) == 1:
                a, b = edge
                beside[a].add(b)
                beside[b].add(a)
        loops = []
        while beside:
            loop, front = set(), {next(iter(beside))}
            while front:
                loop |= front
                front = {w for v in front for w in beside.pop(v)} - loop
            loops.append(loop)
        return loops

    def loop(self, face):
        away = self.rings(set(self.F[face].tolist()))
        near = sorted((min(away.get(v, len(away)) for v in loop), sorted(loop)) for loop in self.loops)
        if not near or near[0][0] == len(away):
            return set()
        assert len(near) == 1 or near[0][0] < near[1][0], "the click leaves no doubt which one is nearest"
        return set(near[0][1])

    def aim(self, middle):
        """The middle of the seen triangle that is nearest to a border, or else to the middle."""
        key = self.surface, self.U.tobytes(), self.eye.key, tuple(middle)
        return self._cached("aim", lambda: self._find_aim(middle), *key)

    def _find_aim(self, middle):
        border = list(set().union(*self.loops))
        centres = self.U[self.F].mean(axis=1)
        screen = self.screen[self.F].mean(axis=1)
        far = np.linalg.norm(screen - middle, axis=1)
        if border:
            far = np.abs(centres[:, None] - self.U[border]).sum(axis=2).min(axis=1)
        for face in np.argsort(far):
            hit = self.hit(screen[face])
            if hit is not None and hit[0] == face:
                return screen[face]
        raise AssertionError("no triangle is seen")

    def slab(self, start, end, axis):
        """Between where a drag begins and where it ends on the plane through the axis that faces it most."""
        _, here = self.hit(start)
        sight = here - self.eye.position
        sight[axis] = 0.0
        origin, direction = self.eye.ray(*end)
        there = origin + ((here - origin) @ sight) / (direction @ sight) * direction
        low, high = sorted((here[axis], there[axis]))
        return set(np.flatnonzero((low <= self.U[:, axis]) & (self.U[:, axis] <= high)).tolist())

    def dab(self, at, pixels):
        """Connected with the triangle under a brush, and under it."""
        face, here = self.hit(at)
        radius = pixels * self.eye.pixel_height * ((here - self.eye.position) @ self.eye.axes[2])
        under = np.linalg.norm(self.U - here, axis=1) <= radius
        seeds, found = self.F[face], set()
        front = {int(seeds[np.argmin(np.linalg.norm(self.U[seeds] - here, axis=1))])}
        front |= {int(v) for v in seeds if under[v]}
        while front:
            found |= front
            front = {w for v in front for w in self.ring[v] if under[w]} - found
        return found


class Gesture:
    """A stroke in one of the ways, near the middle of the mesh, and what it should choose.

    Attributes
    ----------
    press, moves : positions on the screen
        Of a polygon: the first corner, and the others.
    chosen : (n,) bool array
    """

    def __init__(self, window, way, through=False):
        sight, self.way = Sight(window), way
        low, high = sight.screen.min(axis=0), sight.screen.max(axis=0)
        middle, size = 0.5 * (low + high), high - low
        if way not in OUTLINES:
            aim = sight.aim(middle)
        if way is SelectionMode.BOX:
            self.press, end = middle - (0.31, 0.22) * size, middle + (0.27, 0.33) * size
            self.moves = [middle, end]
            corners = [self.press, (end[0], self.press[1]), end, (self.press[0], end[1])]
        elif way is SelectionMode.LASSO:
            turn = np.linspace(0.0, 6.0, 40)[:, None]
            reach = 0.3 + 0.08 * np.sin(5 * turn)
            corners = middle + reach * size * np.hstack([np.cos(turn), np.sin(turn)])
            self.press, *self.moves = corners
        elif way is SelectionMode.POLYGON:
            corners = middle + size * [(-0.4, -0.3), (0.35, -0.3), (0.05, 0.05), (0.3, 0.4), (-0.3, 0.3)]
            self.press, *self.moves = corners
        elif way is SelectionMode.SLAB:
            self.press, self.moves = aim, [aim - (3.0, 40.0), aim - (7.0, 0.21 * size[1])]
            places = sight.slab(self.press, self.moves[-1], window.canvas.selectors[way].axis)
        else:
            self.press, self.moves = aim, [aim]
            face = sight.hit(aim)[0]
            if way is SelectionMode.BRUSH:
                places = sight.dab(aim, window.canvas.brush.size.radius)
            elif way is SelectionMode.FILL:
                places = sight.fill(face, window.canvas.selectors[way].crease_angle)
            elif way is SelectionMode.PIECE:
                places = set(sight.rings(set(sight.F[face].tolist())))
            else:
                places = sight.loop(face)
        if way in OUTLINES:
            places = sight.within(corners, through)
        self.chosen = sight.vertices(places)

    def begin(self, view, modifiers=NONE):
        """All of it but the release, the double click of a polygon or the press of a click."""
        mouse = Mouse(view)
        mouse.move(self.press, modifiers)
        if self.way in TOUCHES:
            return mouse
        mouse.press(self.press, modifiers=modifiers)
        for at in self.moves:
            if self.way is SelectionMode.POLYGON:
                mouse.release(self.press, modifiers=modifiers)
                mouse.move(at, modifiers)
                mouse.press(at, modifiers=modifiers)
            else:
                mouse.move(at, modifiers)
        if self.way is SelectionMode.POLYGON:
            mouse.release(at, modifiers=modifiers)
        return mouse

    def end(self, mouse, modifiers=NONE):
        if self.way is SelectionMode.POLYGON:
            mouse.double_click(self.moves[-1])
            return
        if self.way in TOUCHES:
            mouse.press(self.press, modifiers=modifiers)
        mouse.release(self.moves[-1], modifiers=modifiers)


class Scene:
    """A window on a mesh, painted if its name is not "bare", and the way back to it.

    Attributes
    ----------
    state : State
    """

    def __init__(self, qtbot, window, name):
        self.qtbot, self.window, self.name = qtbot, window, name
        self.canvas, self.view = window.canvas, window.canvas.viewport
        mesh = Mesh(*MESHES[name]())
        window.session.files.open_mesh(mesh)
        idle(qtbot, window)
        if name != "bare":
            self._make_up(mesh)
        idle(qtbot, window)
        window.tools.choose_tool(Tool.HANDLE)  # a tool with the bar that the mesh keeps clear of
        self.state, self.eye = window.session.store.state, self.view.camera_controller.camera

    def _make_up(self, mesh):
        """Ends to bend it by, and a pattern in which every stroke finds some of all."""
        qtbot, window = self.qtbot, self.window
        x, y, z = mesh.V.T
        self.paint(y < np.quantile(y, 0.2), BASE)
        self.paint(y > np.quantile(y, 0.8), HANDLE)
        if self.name == "bent":
            window.tools.choose_tool(Tool.MOVE)
            work_off()
            drag(qtbot, window, arrow_grip(window, 0), (70, -20), steps=4)
            idle(qtbot, window)
            assert not np.allclose(window.session.store.state.frame.U, mesh.V, atol=0.05)
        self.paint(np.sin(9 * x + 4 * z) < -0.5, BASE)
        self.paint(np.sin(9 * x + 4 * z) > 0.5, HANDLE)
        self.paint(np.sin(12 * y - 3 * x) > 0.0, 1, window.session.painting.paint_region)

    def paint(self, member, code, how=None):
        session = self.window.session
        session.gestures.begin()
        (how or session.painting.paint)(np.flatnonzero(member), code)
        session.painting.end_stroke("Paint")

    def reset(self, qtbot, tool=Tool.HANDLE, way=SelectionMode.BRUSH):
        """All as it was, with another tool in the hand."""
        self.qtbot = qtbot
        self.view.mouse.cancel()
        self.take(Tool.ORBIT, SelectionMode.BRUSH)
        while self.document is not self.state.document:
            assert self.steps, "the way back is lost"
            self.window.actions_.undo.trigger()
        idle(qtbot, self.window)
        self.view.camera_controller.camera = self.eye
        self.window.actions_.select.select_hidden.setChecked(False)
        self.canvas.selectors[SelectionMode.FILL].crease_angle = CREASE
        self.canvas.selectors[SelectionMode.SLAB].axis = 1
        self.canvas.brush.size.radius = 60.0
        self.take(tool, way)
        self.window.shell.setUpdatesEnabled(False)  # what is drawn is looked at by few

    def draw(self):
        """Bring to the screen what has changed."""
        self.window.shell.setUpdatesEnabled(True)
        work_off()
        self.window.shell.setUpdatesEnabled(False)

    def take(self, tool, way):
        self.window.tools.choose_mode(way)
        self.window.tools.choose_tool(tool)

    @property
    def document(self):
        return self.window.session.store.state.document

    @property
    def steps(self):
        """Number of the steps that can be undone."""
        return len(self.window.session.gestures.history.undo_states)

    @property
    def colors(self):
        return np.array(self.canvas.surface.arrays.rgba)

    @property
    def own_colors(self):
        """What is painted, in colours: nothing is previewed."""
        return label_colors(self.document.labels, self.document.member)

    @property
    def previewed(self):
        """Which vertices are previewed, (n,) bool array."""
        selector = self.canvas.selectors[self.canvas.selection_mode]
        if hasattr(selector, "preview_timer"):
            self.qtbot.waitUntil(lambda: not selector.preview_timer.isActive())
        found = np.zeros(len(self.document.labels), dtype=bool)
        if self.canvas.coloring.previewed_ids is not None:
            found[self.canvas.coloring.previewed_ids] = True
        return found

    def leave(self):
        """The cursor leaves the view."""
        QApplication.sendEvent(self.view, QEvent(QEvent.Type.Leave))

    def assert_nothing_is_previewed(self):
        assert self.canvas.coloring.previewed_ids is None
        np.testing.assert_array_equal(self.colors, self.own_colors)

    def assert_nothing_has_changed(self):
        assert self.window.session.store.state is self.state
        assert self.window.session.gestures.history.next_redo_name is None


def painted(document, chosen, tool, modifiers):
    """Oracle: labels and numbers of regions after a stroke."""
    labels, member = document.labels.copy(), document.member.copy()
    codes, code, nothing = {
        Tool.BASE: (labels, BASE, FREE),
        Tool.HANDLE: (labels, HANDLE, FREE),
        Tool.REGION: (member, 1, 0),
        Tool.ERASE: (labels, FREE, FREE),
    }[tool]
    if tool is Tool.ERASE:
        member[chosen & (labels == FREE)] = 0
        labels[chosen] = FREE
        return labels, member
    if modifiers == CONTROL:
        codes[codes == code] = nothing
    codes[chosen] = nothing if modifiers == ALT else code
    return labels, member


def two_pieces():
    (V, F), (W, G) = meshes.rabbit(2), meshes.rabbit(2)
    W = W @ meshes.rotation((1, 2, 3), 1.0).T + (1.1, 0.2, -1.4)
    return np.vstack([V, W]), np.vstack([F, G + len(V)])


MESHES = {
    "rabbit": meshes.rabbit,
    "cup": meshes.cup,
    "seams": lambda: meshes.soup(*meshes.rabbit(2)),
    "pieces": two_pieces,
    "bent": meshes.rabbit,
    "bare": meshes.rabbit,
}


class Theatre:
    """A window for all tests of a file, and the scene that is on it."""

    def __init__(self, folder):
        self.window = Workbench(Shell(QSettings(str(folder / "settings.ini"), QSettings.Format.IniFormat)))
        self.window.shell.resize(1000, 700)
        self._scene = None

    def scene(self, qtbot, name="rabbit"):
        """The mesh with a name, as it was when it was opened; only another one is opened."""
        if not self.window.shell.isVisible():
            show(qtbot, self.window.shell, self.window.canvas.viewport)
        if self._scene is None or self._scene.name != name:
            self.window.shell.setUpdatesEnabled(True)
            self._scene = Scene(qtbot, self.window, name)
        self._scene.reset(qtbot)
        return self._scene

    @classmethod
    def opened(cls, folder):
        """Itself, for a fixture, and its end."""
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(file_controller, "ask_before_leaving", lambda *_: UnsavedAnswer.DISCARD)
            theatre = cls(folder)
            yield theatre
            theatre.window.shell.close()
            theatre.window.shell.deleteLater()
