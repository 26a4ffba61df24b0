"""The command ``apd-viewer sweep``: table, curves, meshes and film of a motion."""

from __future__ import annotations

import argparse
import tempfile
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path

from apd_viewer.commands.motion_options import add_input_options, read_input
from apd_viewer.commands.sweep_output import (
    SWEPT_SHARE,
    mesh_path,
    shape_path,
    sweep_animation,
    sweep_row,
    sweep_summary,
    write_sweep_films,
)
from apd_viewer.commands.terminal.animation_options import AnimationTargets, add_animation_option
from apd_viewer.commands.terminal.parser import Parser
from apd_viewer.commands.terminal.progress import Progress
from apd_viewer.commands.terminal.setting_options import add_contact_option
from apd_viewer.commands.terminal.weld_option import add_weld_option
from apd_viewer.figures.rendered_pictures import no_pictures_reason, write_shape
from apd_viewer.files.animations.animation_files import replacing_series, write_animation
from apd_viewer.files.mesh_writing import save_mesh, suffix_for
from apd_viewer.files.storage.atomic_file import staging_folder
from apd_viewer.files.tables import write_table
from apd_viewer.geometry.solver.methods import COMPARED_METHODS, METHODS, passing_walls_warning
from apd_viewer.language import tr
from apd_viewer.session.model.view import SESSION_SUFFIX
from apd_viewer.session.studies.sweep import DEFAULT_ITERATIONS, SETTLING_ITERATIONS, Sweep
from apd_viewer.session.studies.sweep_setup import sweep_of
from apd_viewer.session.studies.sweep_step import SweepStep


def sweep_parser() -> Parser:
    """Parser of the command."""
    parser = Parser(
        prog="apd-viewer sweep",
        description=tr(
            "Go along the motion of the handles in steps: area, volume and energy by each method."
        ),
    )
    add_input_options(parser)
    parser.add_argument("--steps", metavar="N", type=int, default=20, help=tr("default: %(default)s"))
    parser.add_argument(
        "--to",
        metavar="PART",
        type=float,
        default=1.0,
        help=tr("of the motion, where to end; 1.5 goes past it"),
    )
    parser.add_argument(
        "--methods", metavar="M,M,...", default=",".join(COMPARED_METHODS), help=tr("default: %(default)s")
    )
    parser.add_argument(
        "--iterations",
        metavar="N",
        type=int,
        help=tr("at most so many a step; default: {usual}, with obstacles {settling}").format(
            usual=DEFAULT_ITERATIONS, settling=SETTLING_ITERATIONS
        ),
    )
    parser.add_argument(
        "-o", "--output", metavar="DIR", type=Path, required=True, help=tr("folder to write to")
    )
    add_contact_option(parser)
    parser.add_argument("--meshes", action="store_true", help=tr("write the mesh of every step, too"))
    add_animation_option(parser)
    parser.add_argument(
        "--progress-lines", action="store_true", help=tr("say how far it is as lines of JSON")
    )
    add_weld_option(parser)
    parser.set_defaults(run=_sweep)
    return parser


def _sweep(options: argparse.Namespace) -> None:
    methods = [word.strip() for word in options.methods.split(",") if word.strip()]
    state, view, motion = read_input(options, options.weld)
    document = state.document
    if options.contact is not None:
        document = document.with_settings(contact=options.contact)
    sweep = sweep_of(document, options.steps, options.to, methods, options.iterations, motion)
    animations = AnimationTargets(options, sweep.methods)
    progress = Progress(options.progress_lines)
    with replacing_series(animations.all_files()), ExitStack() as stack:
        folder = stack.enter_context(staging_folder(options.output))
        kept = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="apd-viewer-")))
        steps = _run(sweep, progress, folder if options.meshes else None, kept if animations else None)
        lines = [sweep_row(step, sweep) for step in steps]
        write_table(folder / "sweep.csv", list(lines[0]), [list(line.values()) for line in lines])

        # Imported here: matplotlib is slow to import, and must not delay the parsing of a command line.
        from apd_viewer.figures.curves import draw_sweep_curves

        draw_sweep_curves(steps, sweep.abscissa, folder, obstacles=[each.name for each in sweep.obstacles])
        for method in sweep.methods:
            for path in animations.files(method):
                animation = sweep_animation(sweep, steps, method, kept, partial(_tell_shape, progress, path))
                write_animation(animation, animations.scratch_path(path, folder, stack))
        films = [animations.scratch_path(path, folder, stack) for path in animations.films()]
        filmed = not films or write_sweep_films(sweep, steps, kept, view.camera, films, progress)
        progress.end()
    print(sweep_summary(steps, sweep, options.output))
    for sentence in _warnings(options, sweep):
        print(sentence)
    if not filmed:
        print(no_pictures_reason())


def _warnings(options: argparse.Namespace, sweep: Sweep) -> set[str]:
    """Sentences on missing contact, of a mesh without the option."""
    if options.contact is not None or Path(options.file).suffix.lower() == SESSION_SUFFIX:
        return set()
    passing = (passing_walls_warning(each, len(sweep.document.mesh.V), "--contact") for each in sweep.methods)
    return set(filter(None, passing))


def _tell_shape(progress: Progress, path: Path, number: int) -> None:
    progress.show(SWEPT_SHARE, tr("{name}: shape {number}").format(name=path.name, number=number + 1))


def _run(sweep: Sweep, progress: Progress, folder: Path | None, kept: Path | None) -> list[SweepStep]:
    """Run the sweep; write shapes to files on request, and keep none."""
    mesh, steps = sweep.document.mesh, []
    nothing, suffix = mesh.V[:0], suffix_for(mesh)

    def tick(done: float, method: str) -> None:
        progress.show(SWEPT_SHARE * done, METHODS[method].short_title)

    for step in sweep.steps(tick):
        if folder is not None:
            save_mesh(mesh, step.frame.U, mesh_path(folder, suffix, step))
        if kept is not None:
            write_shape(step.frame.U, shape_path(kept, step))
        # A thousand shapes need not be kept in memory.
        steps.append(step._replace(frame=replace(step.frame, U=nothing)))
    return steps
