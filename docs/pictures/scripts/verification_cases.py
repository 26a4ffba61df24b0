"""The answers of all cases that can be set up, against their exact curves."""

from dataclasses import replace
from pathlib import Path

from matplotlib.figure import Figure
from stage import Stage

from apd_viewer.figures.curves import draw_case
from apd_viewer.figures.style import draw_figure
from apd_viewer.verification.case_table import CASES
from apd_viewer.verification.verification_run import run_cases


def draw(stage: Stage) -> Path:
    """Run the cases, two panels a row."""
    cases = [case for case in CASES.values() if case.quantities]
    if stage.quick:
        cases = [replace(CASES["G"], resolutions=(4, 6))]
    runs = list(run_cases(cases))

    def fill(figure: Figure) -> None:
        panels = figure.subplots(-(-len(runs) // 2), 2, squeeze=False).ravel()
        for axes, run in zip(panels, runs, strict=False):
            draw_case(axes, run)
            axes.legend(fontsize=7.5, frameon=True, framealpha=0.9, edgecolor="none")

    draw_figure(fill, (9.6, 13.2), stage.folder, "cases")
    return stage.folder / "cases.png"
