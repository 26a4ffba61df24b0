"""The command ``apd-viewer sweep``: table, curves, meshes and film of a motion."""

from __future__ import annotations

import tempfile
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from apd_viewer.commands.motion_options import add_motion_options, motion_from, painted
from apd_viewer.commands.sweep_output import (
    SWEPT_SHARE,
    animation_of,
    mesh_path,
    row_of,
    shape_path,
    summary,
    write_sweep_films,
)
from apd_viewer.commands.terminal.animation_options import AnimationTargets, add_animation_option
from apd_viewer.commands.terminal.parser import Parser
from apd_viewer.commands.terminal.progress import Progress
from apd_viewer.errors import InputError
from apd_viewer.figures.shapes import keep_shape, no_pictures
from apd_viewer.files.animations.animation_files import write_animation
from apd_viewer.files.animations.series_files import replacing_series
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.selections.selection_files import read_selection_file
from apd_viewer.files.selections.survey_formats import read_transform
from apd_viewer.files.storage.atomic_folder import filling
from apd_viewer.files.tables import write_table
from apd_viewer.geometry.solver.methods import COMPARED, METHODS
from apd_viewer.language import tr
from apd_viewer.session.model.view import SUFFIX, Standpoint
from apd_viewer.session.storage.session_file import open_session
from apd_viewer.session.studies.sweep import DEFAULT_ITERATIONS, SETTLING_ITERATIONS
from apd_viewer.session.studies.sweep_setup import sweep_of

if TYPE_CHECKING:
    import argparse

    from apd_viewer.session.model.document import Document
    from apd_viewer.session.posing.motion_step import MotionStep
    from apd_viewer.session.studies.sweep import Sweep, SweepStep


def sweep_parser() -> Parser:
    """Parser of the command."""
    parser = Parser(
        prog="apd-viewer sweep",
        description="Go along the motion of the handles in steps: area, volume and energy by each method.",
    )
    parser.add_argument(
        "file",
        metavar="SESSION",
        help="saved session (.apd) with its handles moved; or a mesh, painted and moved by:",
    )
    parser.add_argument("--selection", metavar="SEL", help="of a mesh: what is base and handle")
    parser.add_argument(
        "--transform",
        metavar="DEF",
        action="append",
        default=[],
        help="of a mesh: 4x4 matrix that moves the handle; once for each handle",
    )
    add_motion_options(parser)
    parser.add_argument("--steps", metavar="N", type=int, default=20, help="default: %(default)s")
    parser.add_argument(
        "--to", metavar="PART", type=float, default=1.0, help="of the motion, where to end; 1.5 goes past it"
    )
    parser.add_argument(
        "--methods", metavar="M,M,...", default=",".join(COMPARED), help="default: %(default)s"
    )
    parser.add_argument(
        "--iterations",
        metavar="N",
        type=int,
        help=f"at most so many a step; default: {DEFAULT_ITERATIONS}, with obstacles {SETTLING_ITERATIONS}",
    )
    parser.add_argument("-o", "--output", metavar="DIR", type=Path, required=True, help="folder to write to")
    parser.add_argument("--meshes", action="store_true", help="write the mesh of every step, too")
    add_animation_option(parser)
    parser.add_argument("--progress-lines", action="store_true", help="say how far it is as lines of JSON")
    parser.set_defaults(run=_sweep)
    return parser


def _sweep(options: argparse.Namespace) -> None:
    methods = [word.strip() for word in options.methods.split(",") if word.strip()]
    document, camera, motion = _opened(options)
    sweep = sweep_of(document, options.steps, options.to, methods, options.iterations, motion)
    animations = AnimationTargets(options, sweep.methods)
    progress = Progress(options.progress_lines)
    with replacing_series(animations.all_files()), ExitStack() as stack:
        folder = stack.enter_context(filling(options.output))
        kept = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="apd-viewer-")))
        steps = _run(sweep, progress, folder if options.meshes else None, kept if animations else None)
        lines = [row_of(step, sweep) for step in steps]
        write_table(folder / "sweep.csv", list(lines[0]), [list(line.values()) for line in lines])

        # Here: matplotlib is slow to import, and must not delay the parsing of a command line.
        from apd_viewer.figures.sweeps import draw_sweep

        draw_sweep(steps, sweep.abscissa, folder, obstacles=[each.name for each in sweep.obstacles])
        for method in sweep.methods:
            for path in animations.files(method):
                animation = animation_of(sweep, steps, method, kept, partial(_tell_shape, progress, path))
                write_animation(animation, animations.begun(path, folder, stack))
        films = [animations.begun(path, folder, stack) for path in animations.films()]
        filmed = not films or write_sweep_films(sweep, steps, kept, camera, films, progress)
        progress.end()
    print(summary(steps, sweep, options.output))
    if not filmed:
        print(no_pictures())


def _tell_shape(progress: Progress, path: Path, number: int) -> None:
    progress.show(SWEPT_SHARE, tr("{name}: shape {number}").format(name=path.name, number=number + 1))


def _opened(
    options: argparse.Namespace,
) -> tuple[Document, Standpoint | None, tuple[MotionStep, ...]]:
    """State to sweep, the saved view, and the motion if one is given."""
    path = Path(options.file)
    if path.suffix.lower() == SUFFIX:
        if options.selection or options.transform:
            raise InputError(tr("A session has its own paint and motion; omit --selection and --transform."))
        state, view = open_session(path)
        return state.document, view.camera, motion_from(options, state, view.unit)
    if not options.selection or not (options.transform or options.motion):
        raise InputError(
            tr(
                "{name} is not a session; give a .apd file, or --selection with --transform or a motion "
                "such as --twist."
            ).format(name=path.name)
        )
    if options.transform and options.motion:
        raise InputError(tr("Give either --transform or a motion such as --twist, not both."))
    mesh = open_mesh(path)
    state = painted(mesh, read_selection_file(options.selection, mesh))
    document = state.document
    if options.transform and len(options.transform) != len(document.handles):
        raise InputError(
            tr("There are {handles} handles but {motions} motions; give one for each handle.").format(
                handles=len(document.handles), motions=len(options.transform)
            )
        )
    for k, transform in enumerate(options.transform):
        document = document.with_pose(k, read_transform(transform))
    return document, None, motion_from(options, state)


def _run(sweep: Sweep, progress: Progress, folder: Path | None, kept: Path | None) -> list[SweepStep]:
    """Run the sweep; write shapes to files on request, and keep none."""
    mesh, steps = sweep.document.mesh, []
    nothing = mesh.V[:0]

    def tick(done: float, method: str) -> None:
        progress.show(SWEPT_SHARE * done, METHODS[method].short_title)

    for step in sweep.steps(tick):
        if folder is not None:
            save_mesh(mesh, step.frame.U, mesh_path(folder, mesh, step))
        if kept is not None:
            keep_shape(step.frame.U, shape_path(kept, step))
        # A thousand shapes need not be kept in memory.
        steps.append(step._replace(frame=replace(step.frame, U=nothing)))
    return steps
