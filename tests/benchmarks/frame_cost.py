"""What a frame of a drag and a move of a brush cost in the window, against redraws of the same mesh there.

    python tests/benchmarks/frame_cost.py [vertices] [--profile] [--overlays]

Needs a display. The worker is silent: the frames are made beforehand and handed in where the worker's
come in, so what is measured is all that the window does for a frame, and nothing of what makes one. The
kinds of frames take turns, so that whatever else the machine does falls on all of them.
"""

import cProfile
import pstats
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from PySide6.QtCore import QSettings, QTimer

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from driving import Mouse, document
from meshes import rotation, sample_bottle

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.warmup import warm_up
from apd_viewer.presentation.scales import Measure
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.processes.solver_worker import Reply
from apd_viewer.ui.application import make_application
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.tools.tool_modes import Tool
from apd_viewer.ui.workbench import Workbench

ROUNDS, WARM_UP = 24, 4
EDGE_OF_655_000 = 0.141  # lengths of edges, in those of the sample


class Silent:
    """Takes all requests, and answers with what lies in ``reply``."""

    def __init__(self) -> None:
        self.reply = None

    def ask(self, request) -> None:
        self.request = request

    def take(self):
        reply, self.reply = self.reply, None
        return reply

    def close(self) -> None:
        pass


class Pace:
    """The longest time between two turns of the event loop."""

    def __init__(self) -> None:
        self.gaps, self._last = [], time.perf_counter()
        self._timer = QTimer(interval=1)
        self._timer.timeout.connect(self._tick)
        self._timer.start()

    def _tick(self) -> None:
        now = time.perf_counter()
        self.gaps.append(now - self._last)
        self._last = now

    def over(self, least: float) -> str:
        return ", ".join(f"{1e3 * gap:.0f}" for gap in self.gaps if gap > least) or "none"


class Bench:
    """The window on a mesh, and ways to have it draw."""

    def __init__(self, application, V, F, labels) -> None:
        self.application = application
        self.window = Workbench(
            Shell(QSettings(tempfile.mkdtemp() + "/none.ini", QSettings.Format.IniFormat))
        )
        self.window.session._worker.close()
        self.worker = self.window.session.store._worker = self.window.session._worker = Silent()
        self.view = self.window.canvas.viewport
        self.surface = self.window.canvas.surface
        self.window.shell.show()
        self.until(lambda: self.view.draw_count > 0)
        self.view.antialiasing.idle_timer.setInterval(10**8)
        warm_up("window")  # as behind the first picture
        pace = Pace()
        started = time.perf_counter()
        mesh = Mesh(V, F)
        self.window.session.files.open_result("bottle", lambda: initial_state(mesh, frozen(labels)))
        self.until(lambda: self.window.session.store.state is not None and not self.view.is_stale)
        took = time.perf_counter() - started
        self.settle()
        print(f"opening took {took:.2f} s; gaps over 50 ms of the event loop, in ms: {pace.over(0.05)}")
        pace._timer.stop()
        self.shapes = []
        for k in range(6):
            U = V.copy()
            U[:, 0] += 0.02 * (k + 1) * np.ptp(V[:, 0]) * np.sin(V[:, 1])
            self.shapes.append(frozen(U))
        self.next = 0

    def until(self, done) -> None:
        while not done():
            self.application.processEvents()

    def settle(self) -> None:
        until = time.perf_counter() + 0.3
        while time.perf_counter() < until:
            self.application.processEvents()

    def painted(self) -> None:
        self.until(lambda: not self.view.is_stale)
        self.application.processEvents()

    def bare(self) -> None:
        self.view.update()

    def camera(self) -> None:
        eye = self.view.camera_controller.camera
        turned = eye.focal + rotation([0, 1, 0], 0.01) @ (eye.position - eye.focal)
        self.view.camera_controller.camera = replace(eye, position=turned)

    def upload(self) -> None:
        self.surface.arrays.data.points.VTKObject.Modified()
        self.surface.arrays.data.point_data["Normals"].VTKObject.Modified()
        self.view.update()

    def move(self) -> None:
        pose = np.eye(4)
        pose[0, 3] = 0.001 * self.next
        self.window.session.handles.drag(pose, 0)

    def frame(self) -> None:
        self.next += 1
        state, request = self.window.session.store.state, self.worker.request
        frame = replace(
            state.frame,
            U=self.shapes[self.next % len(self.shapes)],
            iteration=self.next,
            area=state.inspection.area * (1 + 1e-4 * self.next),
            area_error=1e-4 * self.next,
            converged=False,
            settled=False,
        )
        self.worker.reply = Reply(request, frame, seconds=0.01)
        self.window._receive()

    def move_and_frame(self) -> None:
        self.move()
        self.frame()


def rounds(bench, kinds, profile=None):
    """Seconds of the work and of all up to the picture, for each kind, in turns."""
    times = {name: [] for name in kinds}
    for _ in range(ROUNDS):
        for name, act in kinds.items():
            bench.painted()
            if profile is not None and name == profile[0]:
                profile[1].enable()
            started = time.perf_counter()
            act()
            worked = time.perf_counter()
            if profile is not None:
                profile[1].disable()
            bench.painted()
            times[name].append((worked - started, time.perf_counter() - started))
    return {name: np.median(taken[WARM_UP:], axis=0) for name, taken in times.items()}


def report(title, medians):
    """Print the medians, and their ratios to a redraw without and with an upload of the points."""
    bare, upload = medians["bare redraw"][1], medians["redraw, points uploaded"][1]
    print(f"\n{title:34} {'work ms':>9} {'to picture ms':>14} {'x bare':>7} {'x uploaded':>11}")
    for name, (work, whole) in medians.items():
        print(
            f"{name:34} {1e3 * work:9.2f} {1e3 * whole:14.1f} {whole / bare:7.2f} {whole / upload:11.2f}",
            flush=True,
        )


def redraws(bench):
    return {
        "bare redraw": bench.bare,
        "redraw, camera turned": bench.camera,
        "redraw, points uploaded": bench.upload,
    }


def dragging(bench, title, profile):
    bench.window.tools.choose_tool(Tool.MOVE)
    bench.window.session.gestures.begin()
    bench.move()
    kinds = {
        "frame of a drag": bench.frame,
        "move of the handle": bench.move,
        "move and frame": bench.move_and_frame,
    }
    watched = ("move and frame", cProfile.Profile()) if profile else None
    report(title, rounds(bench, redraws(bench) | kinds, watched))
    show(watched)
    bench.window.session.gestures.end("Move handle")


def overlays(bench):
    """Frames with each overlay against frames without, by the seconds that all cores have worked for them.

    Where others use the machine too, these say more than the time until the picture is there.
    """
    heat, turns = bench.window.display_options.overlay, [None, *Measure]
    bench.window.session.gestures.begin()
    bench.move()
    heat.choose(Measure.AREA)
    bench.until(lambda: heat.reading.values is not None)
    times = {measure: [] for measure in turns}
    for _ in range(ROUNDS):
        for measure in turns:
            heat.choose(measure)
            for k in range(4):
                bench.painted()
                started = time.process_time()
                bench.frame()
                bench.painted()
                if k:  # the first one makes the shader too
                    times[measure].append(time.process_time() - started)
    heat.choose(None)
    bench.window.session.gestures.end("Move handle")
    without = np.median(times[None][WARM_UP:])
    print(f"\n{'frame of a drag':34} {'CPU ms':>9} {'x without':>10}")
    for measure, taken in times.items():
        name = "without an overlay" if measure is None else measure.traits.title
        median = np.median(taken[WARM_UP:])
        print(f"{name:34} {1e3 * median:9.1f} {median / without:10.2f}", flush=True)


def stroking(bench, profile):
    """A stroke to and fro over the front, with paint where there was none and where there was."""
    bench.window.tools.choose_tool(Tool.BASE)
    bench.painted()
    mouse = Mouse(bench.view)
    middle = np.array([bench.view.width() / 2, bench.view.height() / 2])
    way = [middle + [30 * np.cos(t), 6 * t] for t in np.linspace(0, 12, ROUNDS)]
    points = iter(way)
    mouse.move(middle)
    mouse.press(middle)
    watched = ("move of the brush", cProfile.Profile()) if profile else None
    kinds = {"move of the brush": lambda: mouse.move(next(points))}
    before = document(bench.window).labels
    report("stroke", rounds(bench, redraws(bench) | kinds, watched))
    print(f"painted {int((document(bench.window).labels != before).sum()):,} vertices")
    show(watched)
    started = time.perf_counter()
    mouse.release(way[-1])
    print(f"end of the stroke: {1e3 * (time.perf_counter() - started):.1f} ms")
    hover = iter(way)
    report("hover", rounds(bench, redraws(bench) | {"move of the brush": lambda: mouse.move(next(hover))}))


def show(watched):
    if watched is not None:
        pstats.Stats(watched[1]).sort_stats("tottime").print_stats(14)


def main() -> None:
    """Measure dragging without and with regions, and painting."""
    profile = "--profile" in sys.argv
    numbers = [int(word) for word in sys.argv[1:] if word.isdigit()]
    edge = EDGE_OF_655_000 * (655_000 / numbers[0]) ** 0.5 if numbers else EDGE_OF_655_000
    V, F, labels = sample_bottle(edge)
    print(f"{len(V):,} vertices, {len(F):,} triangles")
    bench = Bench(make_application([""]), V, F, labels)
    if "--overlays" in sys.argv:
        overlays(bench)
    dragging(bench, "drag", profile)
    session = bench.window.session
    for low, high in ((2.0, 6.0), (8.0, 12.0)):
        k = session.parts.add_region()
        session.gestures.begin()
        session.painting.paint_region(np.flatnonzero((V[:, 1] > low) & (V[:, 1] < high)), k + 1)
        session.painting.end_stroke("Paint region")
        session.settings.set_region_area(k, 100.0)
    dragging(bench, "drag, two regions kept", profile)
    stroking(bench, profile)
    if "--picture" in sys.argv:
        bench.window.shell.grab().save("frame_cost.png")
    bench.window.session.files._written.append(bench.window.session.store.state.frame.U)
    bench.window.files.may_discard_work = lambda *_, **__: True
    bench.window.shell.close()


if __name__ == "__main__":
    main()
