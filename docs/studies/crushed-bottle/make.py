"""Make the mesh, the plan and the table of the study of a crushed bottle.

    python docs/studies/crushed-bottle/make.py mesh          # bottle.obj and bottle.sel, of 3,290 vertices
    python docs/studies/crushed-bottle/make.py plan          # plan.csv, from the command below
    apd-viewer study docs/studies/crushed-bottle/plan.csv -o OUT
    python docs/studies/crushed-bottle/make.py table OUT     # results.csv
    make pictures                                            # the picture of it

The mesh is the sample bottle with edges twice as long: contact takes a quarter of the time.
"""

import csv
import runpy
import shutil
import sys
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from apd_viewer.__main__ import main
from apd_viewer.figures.style import INK, QUIET, draw_figure

HERE = Path(__file__).parent
COARSER = 2.0
DESIGN = [
    *("--vary", "twist=0..180deg", "--vary", "push=0..40%", "--vary", "stiffness=1e-4..1e-2:log"),
    *("--set", "method=local", "--set", "hold_area=yes", "--set", "contact=yes", "--set", "steps=8"),
    *("--samples", "200", "--method", "lhs", "--seed", "1"),
]
LEAST = 5  # cases with a ring


def mesh() -> None:
    """Write the bottle with longer edges, and its selection."""
    script = runpy.run_path(str(HERE.parents[2] / "resources" / "make_samples.py"))
    sizes = script["write_bottle"].__globals__
    sizes["BOTTLE_EDGE"] *= COARSER
    sizes["NECK_EDGE"] *= COARSER
    V, F = script["bottle"]()
    script["write_mesh"](HERE / "bottle.obj", "the sample bottle with edges twice as long", V, F)
    script["write_selection"](
        HERE / "bottle.sel", "bottle.obj: held at the base; handle: neck and cap", script["bottle_labels"](V)
    )


def plan() -> None:
    """Write the plan by the command."""
    files = ["--mesh", str(HERE / "bottle.obj"), "--selection", str(HERE / "bottle.sel")]
    assert main(["study", "design", *files, *DESIGN, "-o", str(HERE / "plan.csv")]) == 0


def table(out: Path) -> None:
    """Copy the table of a folder of results."""
    shutil.copy(out / "results.csv", HERE / "results.csv")


def picture(folder: Path) -> None:
    """Draw the table into a folder, as least-volume.png."""
    with (HERE / "results.csv").open(encoding="utf-8", newline="") as stream:
        rows = [row for row in csv.DictReader(stream) if row["status"] == "done"]
    draw_figure(lambda figure: fill(figure, rows), (11.0, 4.4), folder, "least-volume")


def fill(figure: Figure, rows: list[dict[str, str]]) -> None:
    """Draw what twist and push leave of the volume, and what the stiffness of the wall changes."""
    names = "volume", "volume_rest", "#twist", "#push", "stiffness"
    column = {name: np.array([float(row[name]) for row in rows]) for name in names}
    left = 100.0 * column["volume"] / column["volume_rest"]
    twist, push, stiffness = column["#twist"], column["#push"], column["stiffness"]
    least = np.argsort(left)[:LEAST]
    by_motion, by_wall = figure.subplots(1, 2)
    dots(by_motion, twist, push, left, Normalize(50.0, 115.0), least, "volume left, %")
    by_motion.set(title="What a twist and a push leave", xlabel="twist, degrees", ylabel="push, %")
    dots(by_wall, push, left, stiffness, LogNorm(1e-4, 1e-2), least, "bending stiffness")
    by_wall.set(title="Stiffer walls keep more", xlabel="push, %", ylabel="volume left, %")


def dots(
    axes: Axes,
    x: np.ndarray,
    y: np.ndarray,
    value: np.ndarray,
    norm: Normalize,
    ringed: np.ndarray,
    title: str,
) -> None:
    """Scatter plot with a colour bar; the cases of least volume have rings."""
    axes.scatter(x, y, 26, value, cmap="cividis", norm=norm)
    axes.scatter(x[ringed], y[ringed], 70, facecolor="none", edgecolor=INK, linewidth=1.2)
    bar = axes.figure.colorbar(ScalarMappable(norm, "cividis"), ax=axes, label=title)
    bar.outline.set_visible(False)
    bar.ax.yaxis.set_minor_formatter(NullFormatter())
    axes.tick_params(colors=QUIET)


if __name__ == "__main__":
    {"mesh": mesh, "plan": plan, "table": lambda: table(Path(sys.argv[2]))}[sys.argv[1]]()
