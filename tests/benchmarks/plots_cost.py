"""What a frame of a drag costs in the window with all plots drawn, against one without them.

    python tests/benchmarks/plots_cost.py [vertices] [--picture]

Needs a display. The plots are in their dock either way, so that the canvas is of one size; in a frame
without them they are not told of it. The two kinds take turns. The trace is full, as after a long drag.
"""

import sys
import time

import frame_cost
import numpy as np
from meshes import sample_bottle

from apd_viewer.session.trace import MOST
from apd_viewer.ui.application import make_application

ROUNDS = 60
ALLOWED = 1.25


def main() -> None:
    """Measure frames with and without plots, in turns."""
    vertices = next((int(word) for word in sys.argv[1:] if word.isdigit()), 164_000)
    V, F, labels = sample_bottle(frame_cost.EDGE_OF_655_000 * (655_000 / vertices) ** 0.5)
    print(f"{len(V):,} vertices, {len(F):,} triangles")
    bench = frame_cost.Bench(make_application([""]), V, F, labels)
    plots = bench.window.plots
    for button in plots.choices.values():
        button.setChecked(True)
    bench.window.docks["plots"].show()
    bench.window.session.begin_gesture()
    bench.move()
    trace = bench.window.session.trace
    while len(trace) < MOST - 2 * ROUNDS:
        trace.add(bench.worker.request.document, bench.window.session.state.frame)
    bench.settle()
    follow, view, seconds = plots.follow, plots.views["local"], []
    make = view.chart

    def timed():
        started = time.perf_counter()
        chart = make()
        seconds.append(time.perf_counter() - started)
        return chart

    view.chart = timed

    def with_plots():
        plots.follow = follow
        bench.frame()

    def without():
        plots.follow = lambda: None
        bench.frame()

    frame_cost.ROUNDS = ROUNDS
    kinds = {"frame without plots": without, "frame with plots": with_plots}
    medians = frame_cost.rounds(bench, kinds)
    for name, (work, whole) in medians.items():
        print(f"{name:24} {1e3 * work:8.2f} ms of work {1e3 * whole:8.1f} ms to the picture")
    print(f"the histogram was drawn {len(seconds)} times, found in {1e3 * np.median(seconds):.1f} ms")
    assert len(seconds) >= ROUNDS, "the plots were not drawn"
    ratio = medians["frame with plots"][1] / medians["frame without plots"][1]
    print(f"a frame with plots takes {ratio:.2f} times one without; at most {ALLOWED} is allowed")
    if "--picture" in sys.argv:
        bench.window.grab().save("plots_cost.png")
    bench.window.session._kept.append(bench.window.session.state.frame.U)
    bench.window.close()
    sys.exit(int(ratio > ALLOWED))


if __name__ == "__main__":
    main()
