"""The results of the worked study in the window: table, plot and curves, and the shape of a case."""

import csv
from pathlib import Path

from PySide6.QtGui import QImage
from stage import Stage

from apd_viewer.__main__ import main

STUDY = Path(__file__).resolve().parents[2] / "studies" / "crushed-bottle"
_CASES, _CHOSEN = 16, 3


def draw(stage: Stage) -> QImage:
    """Compute some cases of the plan, choose those of least volume, and open the first."""
    plan, count = stage.folder / "plan.csv", 1 if stage.quick else _CASES
    with (STUDY / "plan.csv").open(encoding="utf-8", newline="") as stream:
        columns, *rows = csv.reader(stream)
    few = [[*row] for row in rows[:: len(rows) // count][:count]]
    for row in few:
        for name in ("mesh", "selection"):
            row[columns.index(name)] = str(STUDY / row[columns.index(name)])
        row[columns.index("steps")] = "1" if stage.quick else "5"
        row[columns.index("motion")] = "twist 5deg" if stage.quick else row[columns.index("motion")]
    with plan.open("w", encoding="utf-8", newline="") as stream:
        csv.writer(stream).writerows([columns, *few])
    results = stage.folder / "study"
    assert main(["study", str(plan), "-o", str(results), "--processes", "2"]) == 0
    stage.size = (1120, 860)
    stage.open_sample("bottle")
    stage.window.case_studies.open_study(results)
    panel = stage.window.case_studies.panel
    stage.wait(lambda: len(panel.model.rows) == count)
    stage.pause(300)
    least = _by_volume(panel.model.rows)[:_CHOSEN]
    panel.table.choose_rows(least)
    stage.window.case_studies._open_case(least[0])
    stage.settle()
    stage.window.canvas.frame_mesh()
    stage.settle()
    return stage.picture()


def _by_volume(rows) -> list[int]:
    """Rows by their volume, the least first."""
    return sorted(range(len(rows)), key=lambda k: rows[k].readings.get("volume", 0.0))
