"""The paper's tables, re-run on the sample bottle and duck [Li & Hui, Tables 1 and 2]."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from apd_viewer.files.replacing import replacing
from apd_viewer.files.samples import open_sample, resource
from apd_viewer.files.selections import read_transform
from apd_viewer.geometry.constraints import constraints
from apd_viewer.geometry.deform import Result, deform
from apd_viewer.language import tr

CASES = {
    "bottle-twist-60": ("bottle", tr("bottle twisted by 60°")),
    "bottle-twist-120": ("bottle", tr("bottle twisted by 120°")),
    "duck-bend-015": ("duck", tr("duck's tail moved by 0.15 L")),
    "duck-bend-030": ("duck", tr("duck's tail moved by 0.3 L")),
}
_HEADINGS = (
    tr("move"),
    tr("area at rest"),
    tr("ARAP"),
    tr("change"),
    tr("paper"),
    tr("change"),
    tr("handle drift"),
    tr("within 0.1 %"),
)


class Row(NamedTuple):
    """One move, deformed by ARAP alone and by the paper's method."""

    name: str
    title: str
    arap: Result
    paper: Result

    def cells(self) -> tuple[str, ...]:
        """The row in words, under the headings of the table."""
        arap, paper = self.arap, self.paper
        return (
            self.title,
            f"{paper.area_rest:.3f}",
            f"{arap.area:.3f}",
            f"{100 * arap.area_error:+.2f} %",
            f"{paper.area:.3f}",
            f"{100 * paper.area_error:+.3f} %",
            f"{paper.handle_drift:.3f}",
            tr("yes") if abs(paper.area_error) <= 1e-3 else tr("no"),
        )


def rows(folder: Path | None = None) -> Iterator[Row]:
    """Run the moves one after another; with ``folder`` draw a picture of each there."""
    for name, (sample, title) in CASES.items():
        mesh, labels = open_sample(sample)
        held = constraints(labels, mesh.V, [read_transform(resource(f"{name}.def"))])
        results = [
            deform(mesh.V, mesh.F, held.fixed, held.targets, method, handle=held.handles)
            for method in ("arap", "paper")
        ]
        if folder is not None:
            from apd_viewer.ui.picture import draw

            draw(mesh, labels, results[1], folder / f"{name}.png")
        yield Row(name, title, *results)


def markdown(table: list[Row]) -> str:
    """The table as people read it, in columns of equal width."""
    lines = [_HEADINGS, *(row.cells() for row in table)]
    widths = [max(len(line[column]) for line in lines) for column in range(len(_HEADINGS))]
    text = [
        "| " + " | ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)) + " |"
        for line in lines
    ]
    text.insert(1, "|" + "|".join("-" * (width + 2) for width in widths) + "|")
    return "\n".join(text)


def write_csv(table: list[Row], path: Path) -> None:
    """Write all digits; raises InputError if the file cannot be written."""
    with replacing(path) as scratch, scratch.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(("case", "method", "area_rest", "area", "area_error", "handle_drift", "iterations"))
        for row in table:
            for result in (row.arap, row.paper):
                writer.writerow(
                    (
                        row.name,
                        result.method,
                        result.area_rest,
                        result.area,
                        result.area_error,
                        result.handle_drift,
                        result.iterations,
                    )
                )
