"""Output of a sweep: meshes, film, table and summary."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from apd_viewer.cases.sweep import Sweep
from apd_viewer.cases.sweep_step import SweepStep
from apd_viewer.commands.result_output import mesh_remarks
from apd_viewer.commands.terminal.columns import format_signed
from apd_viewer.commands.terminal.progress import Progress
from apd_viewer.figures.rendered_pictures import Picture, draw_shapes
from apd_viewer.files.animations.animation_shapes import Animation
from apd_viewer.files.tables import Cell
from apd_viewer.geometry.solver.methods import METHODS
from apd_viewer.language import comma_separated, tr
from apd_viewer.notation import localized_number
from apd_viewer.session.model.view import CameraPose

SWEPT_SHARE = 0.9  # of the work; the rest is drawing
_FILM_HEIGHT, _FILM_WIDTH = 560, 300  # pixels, the width of one shape


def mesh_path(folder: Path, suffix: str, step: SweepStep) -> Path:
    """Path of a step's mesh in the folder."""
    (folder / "meshes").mkdir(exist_ok=True)
    return folder / "meshes" / f"{step.method}-{step.number:03d}{suffix}"


def shape_path(folder: Path, step: SweepStep) -> Path:
    """Path of a step's shape for the drawing process."""
    return folder / f"{step.method}-{step.number}.npy"


def sweep_row(step: SweepStep, sweep: Sweep) -> dict[str, Cell]:
    """Row of the table by column name."""
    frame = step.frame
    # Methods that know no contact have no loads.
    loads = step.loads or (None,) * len(sweep.obstacles)
    excess = {"load_excess_percent": sweep.load_excess_percent(step.method)} if sweep.obstacles else {}
    return {
        "method": step.method,
        "step": step.number,
        "part": step.share,
        "degrees": step.degrees,
        "way": step.displacement,
        "area": frame.area,
        "area_error": frame.area_error,
        "volume": frame.volume,
        "volume_capped": frame.volume_capped,
        "volume_error": step.volume_error,
        "energy": step.energy,
        "local_change": frame.local_change,
        "handle_drift": frame.handle_drift,
        "iterations": frame.iteration,
        "settled": frame.settled,
        "share_reached": frame.share_reached,
        **dict(zip(("turned", "turned_held"), step.turn_degrees, strict=True)),
        **{f"load_{k}": load for k, load in enumerate(loads, start=1)},
        **excess,
    }


def sweep_animation(
    sweep: Sweep,
    steps: Sequence[SweepStep],
    method: str,
    shape_folder: Path,
    on_read: Callable[[int], object],
) -> Animation:
    """Animation of a method's sweep, from the shapes kept on disk."""
    document, own = sweep.document, [step for step in steps if step.method == method]
    files = [shape_path(shape_folder, step) for step in own]
    parts = [step.share for step in own]
    painted = document.labels, document.member
    return Animation(document.mesh, *painted, files, parts, document.target_shape, on_read)


def write_sweep_films(
    sweep: Sweep,
    steps: Sequence[SweepStep],
    shape_folder: Path,
    camera: CameraPose | None,
    paths: Sequence[Path],
    progress: Progress,
) -> bool:
    """Draw the shapes of all methods side by side as films; False without OpenGL."""
    # Imported here: Pillow is slow to import, and a film alone needs it.
    from apd_viewer.figures.films import write_film

    count, methods = len(sweep.shares), sweep.methods
    pictures = []
    for number in range(count):
        own = [steps[m * count + number] for m in range(len(methods))]
        words = [(METHODS[step.method].short_title, *_words(step, sweep.abscissa)) for step in own]
        pictures.append(
            Picture(
                shape_folder / f"{number:04d}.png", [shape_path(shape_folder, step) for step in own], words
            )
        )
    size = (_FILM_WIDTH * len(methods), _FILM_HEIGHT)

    def drawn(done: int) -> None:
        progress.show(SWEPT_SHARE + (1 - SWEPT_SHARE) * done / count, tr("drawing"))

    looks = {} if camera is None else _view_settings(camera)
    if not draw_shapes(sweep.document.mesh, pictures, size, on_drawn=drawn, legend=False, **looks):
        return False
    for path in paths:
        write_film([picture.path for picture in pictures], path)
    return True


def _view_settings(camera: CameraPose) -> dict[str, tuple[float, float, float]]:
    x, y, z = (a - b for a, b in zip(camera.position, camera.focal, strict=True))
    return {"view_direction": (x, y, z), "up": camera.up}


def _words(step: SweepStep, abscissa: str) -> list[str]:
    where = {
        "degrees": f"{step.degrees:.0f}°",
        "way": localized_number(f"{step.displacement:.3g}"),
        "part": f"{100 * step.share:.0f} %",
    }[abscissa]
    lines = [where, tr("area {change} %").format(change=format_signed(100 * step.frame.area_error, 2))]
    if step.volume_error is not None:
        lines.append(tr("volume {change} %").format(change=format_signed(100 * step.volume_error, 2)))
    return lines


def sweep_summary(steps: Sequence[SweepStep], sweep: Sweep, folder: Path) -> str:
    """Lines on a finished sweep, for the terminal."""
    lines = [
        tr("{folder}: {steps} steps by {methods}").format(
            folder=folder,
            steps=len(sweep.shares) - 1,
            methods=comma_separated(METHODS[method].short_title for method in sweep.methods),
        )
    ]
    for method in sweep.methods:
        own = [step for step in steps if step.method == method]
        worst = max(own, key=lambda step: abs(step.frame.area_error))
        said = tr("{method}: area {last} % at the end, {worst} % at most").format(
            method=METHODS[method].short_title,
            last=format_signed(100 * own[-1].frame.area_error, 2),
            worst=format_signed(100 * worst.frame.area_error, 2),
        )
        if own[-1].volume_error is not None:
            said += tr("; volume {change} %").format(change=format_signed(100 * own[-1].volume_error, 2))
            if own[-1].frame.volume is None:
                said += tr(", openings capped flat")
        lines.append(said)
        unsettled = sum(not step.frame.settled for step in own)
        if unsettled:
            lines.append(
                tr("    {count} of {steps} shapes did not converge within {most} iterations").format(
                    count=unsettled, steps=len(own), most=sweep.iterations
                )
            )
        lines += [f"    {sentence}" for sentence in sweep.warnings_of(own[-1])]
    lines += mesh_remarks(sweep.document.mesh)
    return "\n".join(lines)
