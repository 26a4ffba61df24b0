"""The command ``apd-viewer paper``: tables, figures and curves."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

from apd_viewer.commands import paper_tables
from apd_viewer.commands.paper_tables import PaperTableRow
from apd_viewer.commands.terminal.parser import Parser
from apd_viewer.commands.terminal.progress import Progress
from apd_viewer.figures.rendered_pictures import Picture, draw_shapes, no_pictures_reason
from apd_viewer.files.samples import open_sample
from apd_viewer.files.storage.atomic_file import staging_folder
from apd_viewer.files.tables import write_table
from apd_viewer.geometry.solver.deformation_result import Result
from apd_viewer.geometry.solver.methods import METHODS
from apd_viewer.language import tr
from apd_viewer.presentation.palette import label_colors
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.studies.paper_curves import HandleCurvePoint, LossCurvePoint, handle_curve, loss_curve

# Size in pixels, and direction of view.
_PICTURES = {"bottle": ((1900, 860), (0.55, 0.28, 1.0)), "duck": ((1900, 560), (0.25, 0.25, 1.0))}
_TABLES, _LOSSES, _HOLDS = 0.2, 0.4, 0.35  # estimated shares of the work; the rest is drawing


def paper_parser() -> Parser:
    """Parser of the command."""
    parser = Parser(prog="apd-viewer paper", description=tr("Re-run the paper's tables on the samples."))
    parser.add_argument(
        "-o", "--output", metavar="DIR", type=Path, help=tr("folder for tables, curves and figures")
    )
    parser.add_argument(
        "--progress-lines", action="store_true", help=tr("say how far it is as lines of JSON")
    )
    parser.set_defaults(run=_paper)
    return parser


def _paper(options: argparse.Namespace) -> None:
    progress = Progress(options.progress_lines)
    drawn = True
    with ExitStack() as stack:
        folder = stack.enter_context(staging_folder(options.output)) if options.output else None
        share = _TABLES if folder else 1.0
        table = list(paper_tables.table_rows(lambda done, doing: progress.show(share * done, doing)))
        if folder is not None:
            paper_tables.write_csv(table, folder / "tables.csv")
            (folder / "tables.md").write_text(paper_tables.format_tables(table) + "\n", encoding="utf-8")
            _write_curves(folder, progress)
            drawn = _draw_shapes(table, folder, progress)
        progress.end()
    print(paper_tables.format_tables(table))
    print()
    print(paper_tables.tolerance_verdict(table))
    if not drawn:
        print(no_pictures_reason())


def _write_curves(folder: Path, progress: Progress) -> None:
    # Imported here: matplotlib is slow to import, and this function alone needs it.
    from apd_viewer.figures.curves import draw_handle_curves, draw_loss_curves

    document = initial_state(*open_sample("bottle")).document
    doing = tr("area loss by angle")
    lost = loss_curve(document, tick=lambda done, _: progress.show(_TABLES + _LOSSES * done, doing))
    said = [(60.0, "bottle-twist-60"), (120.0, "bottle-twist-120")]
    cases = [
        (degrees, paper_tables.PAPER_CASES[name])
        for degrees, name in said
        if name in paper_tables.PAPER_CASES
    ]
    draw_loss_curves(lost, [(degrees, case.arap / case.rest - 1) for degrees, case in cases], folder)
    write_table(folder / "loss-against-angle.csv", LossCurvePoint._fields, lost)
    where = tr("handle drift with Eq. 8")
    before = _TABLES + _LOSSES
    held = handle_curve(document, tick=lambda done, _: progress.show(before + _HOLDS * done, where))
    draw_handle_curves(held, folder)
    write_table(folder / "handle.csv", HandleCurvePoint._fields, held)


def _draw_shapes(table: Sequence[PaperTableRow], folder: Path, progress: Progress) -> bool:
    """Draw the shapes of each table as in Figs. 3 and 5; False without OpenGL."""
    samples = list(dict.fromkeys(row.case.sample for row in table))
    for number, sample in enumerate(samples):
        progress.show(1 - 0.05 * (1 - number / len(samples)), tr("drawing"))
        mesh, labels = open_sample(sample)
        own = [row for row in table if row.case.sample == sample]
        shapes, words = [mesh.V], [[tr("Rest")]]
        for row in own:
            for name, result in ((tr("ARAP"), row.arap), (tr("APD"), row.paper)):
                shapes.append(result.U)
                words.append([f"{_amount(row)}, {name}", *_readings(result)])
        size, look = _PICTURES[sample]
        picture = Picture(folder / f"{sample}.png", shapes, words, label_colors(labels))
        if not draw_shapes(mesh, [picture], size, view_direction=look):
            return False
    return True


def _amount(row: PaperTableRow) -> str:
    """Shortest name of the motion."""
    return row.case.title.rpartition(" by ")[2]


def _readings(result: Result) -> list[str]:
    change = f"{100 * result.area_error:+.2f}"
    lines = [tr("area {change} %").format(change=change)]
    if METHODS[result.method].moves_handles:
        lines.append(tr("handle drift {drift} cm").format(drift=f"{result.handle_drift:.2f}"))
    return lines
