"""The ``paper`` command: tables, figures and curves."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

from apd_viewer.commands.terminal.columns import column_count, padded_text
from apd_viewer.commands.terminal.command_output import CommandOutput
from apd_viewer.commands.terminal.parser import Parser, add_option
from apd_viewer.commands.terminal.progress import Progress
from apd_viewer.figures.rendered_pictures import Picture, draw_shapes, no_pictures_reason
from apd_viewer.files.samples import open_sample, resource_path
from apd_viewer.files.selections.survey_formats import read_transform
from apd_viewer.files.storage.atomic_file import staging_folder
from apd_viewer.files.tables import Cell, write_table
from apd_viewer.geometry.pose.constraints import constraints
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.solver.deformation_result import Result, deform
from apd_viewer.geometry.solver.methods import METHODS
from apd_viewer.language import comma_separated, tr
from apd_viewer.presentation.palette import label_colors
from apd_viewer.session.model.state import initial_document

# Picture size in pixels and view direction of each sample mesh.
_PICTURES = {"bottle": ((1900, 860), (0.55, 0.28, 1.0)), "duck": ((1900, 560), (0.25, 0.25, 1.0))}
_TABLES, _LOSSES, _HOLDS = 0.2, 0.4, 0.35  # estimated fractions of the work; the rest is drawing
TOLERANCE = 1e-3
_METHODS = "arap", "paper"  # in column order
TABLE_TITLES = {"bottle": tr("Table 1: twisting a bottle"), "duck": tr("Table 2: bending a duck")}
_MEASURED = "area_rest", "area", "area_error", "handle_drift", "iterations"
_PUBLISHED = "move", "said_area_rest", "said_area", "said_area_error", "within_tolerance"
_COLUMNS = "case", "method", *_MEASURED, *_PUBLISHED
_HEADINGS = (
    tr("motion"),
    "",
    tr("area at rest"),
    tr("ARAP"),
    tr("change"),
    tr("APD"),
    tr("change"),
    tr("handle drift"),
    tr("within 0.1 %"),
)


def paper_parser() -> Parser:
    """Argument parser for the ``paper`` command."""
    parser = Parser(prog="apd-viewer paper", description=tr("Re-run the paper's tables on the samples."))
    add_option(parser, "-o, --output DIR", tr("folder for tables, curves and figures"), type=Path)
    add_option(parser, "--progress-lines", tr("report progress as lines of JSON"))
    parser.set_defaults(run=_paper)
    return parser


def _paper(options: argparse.Namespace) -> CommandOutput:
    progress = Progress(options.progress_lines)
    drawn = True
    with ExitStack() as stack:
        folder = stack.enter_context(staging_folder(options.output)) if options.output else None
        fraction = _TABLES if folder else 1.0
        table = list(table_rows(lambda done, doing: progress.show(fraction * done, doing)))
        if folder is not None:
            write_csv(table, folder / "tables.csv")
            (folder / "tables.md").write_text(format_tables(table) + "\n", encoding="utf-8")
            _write_curves(folder, progress)
            drawn = _draw_shapes(table, folder, progress)
        progress.end()
    lines = [format_tables(table), "", tolerance_verdict(table)]
    lines += [] if drawn else [no_pictures_reason()]
    return CommandOutput(lines, lambda: [dict(zip(_COLUMNS, cells, strict=True)) for cells in _cells(table)])


def _write_curves(folder: Path, progress: Progress) -> None:
    # Imported here: matplotlib is slow to import, and this function alone needs it.
    from apd_viewer.figures.paper_curves import draw_handle_curves, draw_loss_curves, handle_curve, loss_curve

    document = initial_document(*open_sample("bottle"))
    doing, where, before = tr("area loss by angle"), tr("handle drift with Eq. 8"), _TABLES + _LOSSES
    lost = loss_curve(document, tick=lambda done: progress.show(_TABLES + _LOSSES * done, doing))
    said = [(60.0, "bottle-twist-60"), (120.0, "bottle-twist-120")]
    cases = [(degrees, PAPER_CASES[name]) for degrees, name in said if name in PAPER_CASES]
    draw_loss_curves(lost, [(degrees, case.arap / case.rest - 1) for degrees, case in cases], folder)
    write_table(folder / "loss-against-angle.csv", lost[0]._fields, lost)
    held = handle_curve(document, tick=lambda done: progress.show(before + _HOLDS * done, where))
    draw_handle_curves(held, folder)
    write_table(folder / "handle.csv", held[0]._fields, held)


def _draw_shapes(table: Sequence[PaperTableRow], folder: Path, progress: Progress) -> bool:
    """Draw the shapes of each table as in Figs. 3 and 5; False without OpenGL."""
    samples = list(dict.fromkeys(row.case.sample for row in table))
    for number, sample in enumerate(samples):
        progress.show(1 - 0.05 * (1 - number / len(samples)), tr("drawing"))
        mesh, labels = open_sample(sample)
        own = [row for row in table if row.case.sample == sample]
        shapes, words = [mesh.V], [[tr("Rest")]]
        for row in own:
            amount = row.case.title.rpartition(" by ")[2]
            for name, result in ((tr("ARAP"), row.arap), (tr("APD"), row.paper)):
                shapes.append(result.U)
                words.append([f"{amount}, {name}", *_readings(result)])
        size, look = _PICTURES[sample]
        picture = Picture(folder / f"{sample}.png", shapes, words, [label_colors(labels)])
        if not draw_shapes(mesh, [picture], size, view_direction=look):
            return False
    return True


def _readings(result: Result) -> list[str]:
    change = f"{100 * result.area_error:+.2f}"
    lines = [tr("area {change} %").format(change=change)]
    if METHODS[result.method].moves_handles:
        lines.append(tr("handle drift {drift} cm").format(drift=f"{result.handle_drift:.2f}"))
    return lines


class PaperCase(NamedTuple):
    """Motion of a table row, with the areas published in the paper.

    Attributes
    ----------
    title : str
        Of the move.
    rest, arap, paper : float
        The paper's areas: original, by ARAP, by its own method.
    """

    sample: str
    title: str
    rest: float
    arap: float
    paper: float


PAPER_CASES = {
    "bottle-twist-60": PaperCase("bottle", tr("bottle twisted by 60°"), 79.305, 77.781, 79.231),
    "bottle-twist-120": PaperCase("bottle", tr("bottle twisted by 120°"), 79.305, 78.957, 79.267),
    "duck-bend-015": PaperCase("duck", tr("duck's tail moved by 0.15 L"), 3725.0, 3699.5, 3721.6),
    "duck-bend-030": PaperCase("duck", tr("duck's tail moved by 0.3 L"), 3725.0, 3674.8, 3722.8),
}


class PaperTableRow(NamedTuple):
    """Results of one motion with ARAP alone and with the paper's method."""

    name: str
    case: PaperCase
    arap: Result
    paper: Result

    @property
    def is_within_tolerance(self) -> bool:
        """True if the area error of the paper's method is within the tolerance."""
        return abs(self.paper.area_error) <= TOLERANCE

    def lines(self) -> list[tuple[str, ...]]:
        """Cells of two table lines: our results, and the paper's below."""
        arap, paper, case = self.arap, self.paper, self.case
        return [
            (
                case.title,
                tr("this program"),
                f"{paper.area_rest:.3f}",
                f"{arap.area:.3f}",
                f"{100 * arap.area_error:+.2f} %",
                f"{paper.area:.3f}",
                f"{100 * paper.area_error:+.3f} %",
                f"{paper.handle_drift:.3f}",
                tr("pass") if self.is_within_tolerance else tr("fail"),
            ),
            (
                "",
                "Li & Hui",
                f"{case.rest:g}",
                f"{case.arap:g}",
                f"{100 * (case.arap / case.rest - 1):+.2f} %",
                f"{case.paper:g}",
                f"{100 * (case.paper / case.rest - 1):+.3f} %",
                tr("not given"),
                tr("pass") if abs(case.paper / case.rest - 1) <= TOLERANCE else tr("fail"),
            ),
        ]


def table_rows(tick: Callable[[float, str], object] = lambda *_: None) -> Iterator[PaperTableRow]:
    """Yield the rows of the tables, motion by motion; ``tick`` receives the progress."""
    for number, (name, case) in enumerate(PAPER_CASES.items()):
        mesh, labels = open_sample(case.sample)
        held = constraints(labels, mesh.V, [read_transform(resource_path(f"{name}.def"))])

        def hear(frame: Frame, number: int = number, case: PaperCase = case) -> None:
            tick((number + frame.iteration / (frame.iteration + 100)) / len(PAPER_CASES), case.title)

        results = [
            deform(
                mesh.V,
                mesh.F,
                held.fixed,
                held.targets,
                method,
                handle=held.handles,
                contact=False,  # the paper's methods have no contact
                progress=hear,
            )
            for method in _METHODS
        ]
        yield PaperTableRow(name, case, *results)


def format_tables(rows: Sequence[PaperTableRow]) -> str:
    """Format both tables, each below its title."""
    samples = dict.fromkeys(row.case.sample for row in rows)
    return "\n\n".join(
        f"{TABLE_TITLES[sample]}\n\n{format_markdown([row for row in rows if row.case.sample == sample])}"
        for sample in samples
    )


def format_markdown(rows: Sequence[PaperTableRow]) -> str:
    """Format a table as Markdown, in aligned columns."""
    lines = [_HEADINGS, *(line for row in rows for line in row.lines())]
    widths = [max(column_count(line[column]) for line in lines) for column in range(len(_HEADINGS))]
    text = [
        "| " + " | ".join(padded_text(cell, width) for cell, width in zip(line, widths, strict=True)) + " |"
        for line in lines
    ]
    text.insert(1, "|" + "|".join("-" * (width + 2) for width in widths) + "|")
    return "\n".join(text)


def tolerance_verdict(rows: Sequence[PaperTableRow]) -> str:
    """Sentence about the number of motions within the tolerance."""
    failed = [row.case.title for row in rows if not row.is_within_tolerance]
    if not failed:
        return tr("Pass: APD keeps the area within 0.1 % in all {count} motions.").format(count=len(rows))
    return tr("Fail: the area change exceeds 0.1 % in {moves}.").format(moves=comma_separated(failed))


def write_csv(rows: Iterable[PaperTableRow], path: Path) -> None:
    """Write all digits of the rows as CSV; raises InputError if that fails."""
    write_table(path, _COLUMNS, _cells(rows))


def _cells(rows: Iterable[PaperTableRow]) -> list[tuple[Cell, ...]]:
    """Cells of the rows, by method, with all digits."""
    return [
        (
            *(row.name, result.method, *(getattr(result, name) for name in _MEASURED)),
            *(row.case.title, row.case.rest, area, area / row.case.rest - 1),
            abs(result.area_error) <= TOLERANCE,
        )
        for row in rows
        for result, area in ((row.arap, row.case.arap), (row.paper, row.case.paper))
    ]
