"""The ``sweep`` command: table, curves, meshes and film of a motion."""

import argparse
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from apd_viewer.cases.case import (
    DEFAULT_ITERATIONS,
    SETTLING_ITERATIONS,
    Case,
    CaseStep,
    case_of,
    case_steps,
    cases_by_method,
)
from apd_viewer.commands.motion_options import add_input_options, read_input
from apd_viewer.commands.result_output import mesh_remarks
from apd_viewer.commands.terminal.animation_options import AnimationTargets, add_animation_option
from apd_viewer.commands.terminal.columns import format_signed
from apd_viewer.commands.terminal.command_output import CommandOutput
from apd_viewer.commands.terminal.mesh_options import add_weld_option
from apd_viewer.commands.terminal.parser import Parser, add_option
from apd_viewer.commands.terminal.progress import Progress
from apd_viewer.commands.terminal.setting_options import add_contact_option, add_criteria, given_criteria
from apd_viewer.figures.rendered_pictures import Picture, draw_shapes, no_pictures_reason, write_shape
from apd_viewer.files.animations.animation_files import replacing_series, write_animation
from apd_viewer.files.animations.animation_shapes import Animation
from apd_viewer.files.mesh_writing import save_mesh, suffix_for
from apd_viewer.files.storage.atomic_file import staging_folder
from apd_viewer.files.tables import Cell, write_table
from apd_viewer.geometry.solver.convergence import DISTURBANCE, check_convergence
from apd_viewer.geometry.solver.methods import COMPARED_METHODS, METHODS, no_contact_warning
from apd_viewer.language import comma_separated, tr
from apd_viewer.notation import localized_number
from apd_viewer.session.model.up_axis import mesh_up_axis
from apd_viewer.session.model.view import SESSION_SUFFIX, CameraPose, View

SWEPT_SHARE = 0.9  # fraction of the work; the rest is drawing
_FILM_HEIGHT, _FILM_WIDTH = 560, 300  # picture height, and width of each shape, in pixels


def sweep_parser() -> Parser:
    """Argument parser for the ``sweep`` command."""
    parser = Parser(
        prog="apd-viewer sweep",
        description=tr(
            "Compute area, volume and energy by each method in steps along the motion of the handles."
        ),
    )
    add_input_options(parser)
    add_option(parser, "--steps N", tr("default: %(default)s"), type=int, default=20)
    add_option(
        parser, "--to PART", tr("last fraction of the motion; 1.5 goes past it"), type=float, default=1.0
    )
    add_option(parser, "--methods M,M,...", tr("default: %(default)s"), default=",".join(COMPARED_METHODS))
    about = tr("iteration limit per step; default: {usual}, with obstacles {settling}").format(
        usual=DEFAULT_ITERATIONS, settling=SETTLING_ITERATIONS
    )
    add_option(parser, "--iterations N", about, type=int)
    add_option(parser, "-o, --output DIR", tr("folder to write to"), type=Path, required=True)
    add_contact_option(parser)
    add_criteria(parser, DISTURBANCE, of_session=True)
    add_option(parser, "--meshes", tr("write the mesh of every step, too"))
    add_animation_option(parser)
    add_option(parser, "--progress-lines", tr("report progress as lines of JSON"))
    add_weld_option(parser)
    parser.set_defaults(run=_sweep)
    return parser


def _sweep(options: argparse.Namespace) -> CommandOutput:
    methods = [word.strip() for word in options.methods.split(",") if word.strip()]
    document, view, motion = read_input(options, options.weld)
    if options.contact is not None:
        document = document.with_settings(contact=options.contact)
    convergence = document.settings.convergence._replace(**given_criteria(options))
    check_convergence(convergence)
    document = document.with_settings(convergence=convergence)
    case = case_of(document, options.steps, options.to, options.iterations, motion)
    cases = cases_by_method(case, methods)
    animations = AnimationTargets(options, methods)
    progress = Progress(options.progress_lines)
    with replacing_series(animations.files_of_all_versions()), ExitStack() as stack:
        folder = stack.enter_context(staging_folder(options.output))
        kept = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="apd-viewer-")))
        steps = _run(cases, progress, folder if options.meshes else None, kept if animations else None)
        swept = list(zip(cases, steps, strict=True))
        lines = [sweep_row(each, step) for each, own in swept for step in own]
        write_table(folder / "sweep.csv", list(lines[0]), [list(line.values()) for line in lines])

        # Imported here: matplotlib is slow to import, and must not delay the parsing of a command line.
        from apd_viewer.figures.curves import draw_sweep_curves

        every = [step for own in steps for step in own]
        draw_sweep_curves(every, case.abscissa, folder, [each.name for each in case.obstacles])
        for each, own in swept:
            for path in animations.files(each.method):
                animation = sweep_animation(each, own, kept, partial(_tell_shape, progress, path), view)
                write_animation(animation, animations.scratch_path(path, folder, stack))
        films = [animations.scratch_path(path, folder, stack) for path in animations.films()]
        filmed = not films or write_sweep_films(case, steps, kept, view.camera, films, progress)
        progress.end()
    warnings = [*_warnings(options, cases), *([] if filmed else [no_pictures_reason()])]
    told = {"folder": str(options.output), "steps": lines, "warnings": warnings}
    return CommandOutput([sweep_summary(swept, options.output), *warnings], lambda: told)


def _warnings(options: argparse.Namespace, cases: Sequence[Case]) -> set[str]:
    """Warnings that walls may pass through each other without ``--contact``."""
    if options.contact is not None or Path(options.file).suffix.lower() == SESSION_SUFFIX:
        return set()
    passing = (no_contact_warning(each.method, len(each.document.mesh.V), "--contact") for each in cases)
    return set(filter(None, passing))


def _tell_shape(progress: Progress, path: Path, number: int) -> None:
    progress.show(SWEPT_SHARE, tr("{name}: shape {number}").format(name=path.name, number=number + 1))


def _run(
    cases: Sequence[Case], progress: Progress, folder: Path | None, kept: Path | None
) -> list[list[CaseStep]]:
    """Steps of each case without their shapes; these are written to files on request."""
    mesh = cases[0].document.mesh
    nothing, suffix = mesh.V[:0], suffix_for(mesh)

    def tick(number: int, title: str, done: float) -> None:
        progress.show(SWEPT_SHARE * ((number + done) / len(cases)), title)

    def steps_of(number: int, case: Case) -> Iterator[CaseStep]:
        for step in case_steps(case, partial(tick, number, METHODS[case.method].short_title)):
            if folder is not None:
                save_mesh(mesh, step.frame.U, mesh_path(folder, suffix, step))
            if kept is not None:
                write_shape(step.frame.U, shape_path(kept, step))
            # Shapes are dropped: up to a thousand of them would fill the memory.
            yield step._replace(frame=replace(step.frame, U=nothing))

    return [list(steps_of(number, case)) for number, case in enumerate(cases)]


def mesh_path(folder: Path, suffix: str, step: CaseStep) -> Path:
    """Path of a step's mesh in the folder."""
    (folder / "meshes").mkdir(exist_ok=True)
    return folder / "meshes" / f"{step.method}-{step.number:03d}{suffix}"


def shape_path(folder: Path, step: CaseStep) -> Path:
    """Path of a step's shape for the drawing process."""
    return folder / f"{step.method}-{step.number}.npy"


def sweep_row(case: Case, step: CaseStep) -> dict[str, Cell]:
    """Table row of a step by column name."""
    # Methods without contact have no loads.
    loads = step.loads or (None,) * len(case.obstacles)
    excess = {"load_excess_percent": case.load_excess_percent} if case.obstacles else {}
    return {
        "method": step.method,
        "step": step.number,
        **step.readings,
        **{f"load_{k}": load for k, load in enumerate(loads, start=1)},
        **excess,
    }


def sweep_animation(
    case: Case, steps: Sequence[CaseStep], shape_folder: Path, on_read: Callable[[int], object], view: View
) -> Animation:
    """Animation of a case, from the shapes kept on disk, in the unit of the view."""
    document, files = case.document, [shape_path(shape_folder, step) for step in steps]
    painted = document.labels, document.member
    frame = mesh_up_axis(document.mesh, view.up_axis).frame
    return Animation(
        document.mesh, *painted, files, case.fractions, document.target_shape, on_read, view.unit, frame
    )


def write_sweep_films(
    case: Case,
    steps: Sequence[Sequence[CaseStep]],
    shape_folder: Path,
    camera: CameraPose | None,
    paths: Sequence[Path],
    progress: Progress,
) -> bool:
    """Draw the shapes of all methods side by side as films; False without OpenGL."""
    # Imported here: Pillow is slow to import, and only films need it.
    from apd_viewer.figures.films import write_film

    count = len(case.fractions)
    pictures = [
        Picture(
            shape_folder / f"{number:04d}.png",
            [shape_path(shape_folder, step) for step in own],
            [(METHODS[step.method].short_title, *_caption_lines(step, case.abscissa)) for step in own],
        )
        for number, own in enumerate(zip(*steps, strict=True))
    ]
    size = (_FILM_WIDTH * len(steps), _FILM_HEIGHT)

    def drawn(done: int) -> None:
        progress.show(SWEPT_SHARE + (1 - SWEPT_SHARE) * done / count, tr("drawing"))

    looks = {} if camera is None else _view_settings(camera)
    if not draw_shapes(case.document.mesh, pictures, size, on_drawn=drawn, legend=False, **looks):
        return False
    for path in paths:
        write_film([picture.path for picture in pictures], path)
    return True


def _view_settings(camera: CameraPose) -> dict[str, Any]:
    x, y, z = (a - b for a, b in zip(camera.position, camera.focal, strict=True))
    return {"view_direction": (x, y, z), "up": camera.up}


def _caption_lines(step: CaseStep, abscissa: str) -> list[str]:
    where = {
        "degrees": f"{step.degrees:.0f}°",
        "way": localized_number(f"{step.displacement:.3g}"),
        "part": f"{100 * step.fraction:.0f} %",
    }[abscissa]
    lines = [where, tr("area {change} %").format(change=format_signed(100 * step.frame.area_error, 2))]
    if step.volume_error is not None:
        lines.append(tr("volume {change} %").format(change=format_signed(100 * step.volume_error, 2)))
    return lines


def sweep_summary(swept: Sequence[tuple[Case, Sequence[CaseStep]]], folder: Path) -> str:
    """Terminal lines about the cases of a sweep and their steps."""
    first, _ = swept[0]
    lines = [
        tr("{folder}: {steps} steps by {methods}").format(
            folder=folder,
            steps=len(first.fractions) - 1,
            methods=comma_separated(METHODS[case.method].short_title for case, _ in swept),
        )
    ]
    for case, steps in swept:
        *_, last = steps
        worst = max(steps, key=lambda step: abs(step.frame.area_error))
        said = tr("{method}: area {last} % at the end, {worst} % at most").format(
            method=METHODS[case.method].short_title,
            last=format_signed(100 * last.frame.area_error, 2),
            worst=format_signed(100 * worst.frame.area_error, 2),
        )
        if last.volume_error is not None:
            said += tr("; volume {change} %").format(change=format_signed(100 * last.volume_error, 2))
            if last.frame.volume is None:
                said += tr(", openings capped flat")
        lines.append(said)
        unsettled = sum(not step.frame.settled for step in steps)
        if unsettled:
            lines.append(
                tr("    {count} of {steps} shapes did not converge within {most} iterations").format(
                    count=unsettled, steps=len(steps), most=case.iterations
                )
            )
        lines += [f"    {sentence}" for sentence in case.step_warnings(last)]
    return "\n".join([*lines, *mesh_remarks(first.document.mesh)])
