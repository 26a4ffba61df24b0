"""What a frame of a drag costs in the window with all plots and the heat map, against one without them.

    python tests/benchmarks/plots_cost.py [vertices] [--picture]

Needs a display. The plots are in their dock either way, so that the canvas is of one size; in a frame
without them they are not told of it. The kinds take turns, four frames each, of which the first is not
counted: it makes the shader too. The trace is long, as after a long drag. Beside the time until the picture
is there stands what all cores have worked for it, which says more where others use the machine too. A ratio
is the median of those of the rounds: within one of them a machine is hardly faster at the end than at the
start.
"""

import sys
import time

import frame_cost
import numpy as np
from meshes import sample_bottle

from apd_viewer.presentation.scales import Measure
from apd_viewer.session.model.trace import MOST_SAMPLES
from apd_viewer.ui.application import make_application

ROUNDS = 40
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
    bench.window.session.gestures.begin()
    bench.move()
    trace = bench.window.session.store.trace
    while len(trace) < MOST_SAMPLES // 2:
        trace.add_frame(bench.worker.request.document, bench.window.session.store.state.frame)
    bench.settle()
    follow, view, seconds = plots.refresh, plots.views["local"], []
    make = view.chart

    def timed():
        started = time.perf_counter()
        chart = make()
        seconds.append(time.perf_counter() - started)
        return chart

    view.chart = timed

    heat = bench.window.display_options.overlay
    heat.choose_measure(Measure.AREA)
    bench.until(lambda: heat.reading.values is not None)
    kinds = {
        "without": (lambda: None, None),
        "with plots": (follow, None),
        "with plots and heat map": (follow, Measure.AREA),
    }
    times = {name: [] for name in kinds}
    for _ in range(ROUNDS):
        for name, (plots.refresh, measure) in kinds.items():
            frames = []
            heat.choose_measure(measure)
            for k in range(4):
                bench.painted()
                worked, started = time.process_time(), time.perf_counter()
                bench.frame()
                bench.painted()
                if k:
                    frames.append((time.process_time() - worked, time.perf_counter() - started))
            times[name].append(np.median(frames, axis=0))
    ratios = {}
    for name, taken in times.items():
        work, whole = np.median(taken, axis=0)
        ratios[name] = np.median(np.divide(taken, times["without"]), axis=0)
        print(
            f"{name:24} {1e3 * whole:8.1f} ms ({ratios[name][1]:.2f} times without) to the picture, "
            f"{1e3 * work:8.1f} ms ({ratios[name][0]:.2f}) of all cores"
        )
    print(f"the histogram was drawn {len(seconds)} times, found in {1e3 * np.median(seconds):.1f} ms")
    assert len(seconds) >= ROUNDS, "the plots were not drawn"
    ratio = ratios["with plots and heat map"][1]
    print(f"with all of them a frame takes {ratio:.2f} times one without; at most {ALLOWED} is allowed")
    if "--picture" in sys.argv:
        bench.window.grab().save("plots_cost.png")
    bench.window.session.files._written.append(bench.window.session.store.state.frame.U)
    bench.window.close()
    sys.exit(int(ratio > ALLOWED))


if __name__ == "__main__":
    main()
