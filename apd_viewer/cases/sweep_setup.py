"""Set-up of a sweep: its settings checked, and the paths of its handles."""

from __future__ import annotations

from collections.abc import Sequence

from apd_viewer.cases.sweep import DEFAULT_ITERATIONS, SETTLING_ITERATIONS, Sweep, SweepPath
from apd_viewer.errors import InputError
from apd_viewer.geometry.pose.constraints import next_paint_sentence
from apd_viewer.geometry.solver.methods import COMPARED_METHODS, method_named
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import obstacle_shifts
from apd_viewer.session.model.handle_paths import handle_paths
from apd_viewer.session.posing.motion_path import MotionStep, motion_paths

MOST_STEPS = 1000


def sweep_of(
    document: Document,
    steps: int,
    last_share: float = 1.0,
    methods: Sequence[str] = COMPARED_METHODS,
    iterations: int | None = None,
    motion: Sequence[MotionStep] = (),
) -> Sweep:
    """Sweep of the ways of a document's handles and obstacles, or of a given motion.

    Parameters
    ----------
    document : Document
    steps : int
        Beside the one at the start.
    last_share : float
        Part of the motion that is the last step.
    methods : sequence of str
    iterations : int
        At most so many for each step; without, as many as are usual, and more where there are obstacles.
    motion : sequence of MotionStep
        Instead: typed motions of the handles from rest.

    Raises
    ------
    InputError
        If there is nothing to sweep; the message says why.
    """
    if not 1 <= steps <= MOST_STEPS:
        raise InputError(tr("A sweep has 1 to {most} steps; enter another number.").format(most=MOST_STEPS))
    if not 0.0 < last_share <= 100.0:
        raise InputError(
            tr("The end of a sweep must be a fraction of the motion greater than 0, such as 1 or 1.5.")
        )
    if iterations is None:
        iterations = SETTLING_ITERATIONS if document.has_active_obstacles else DEFAULT_ITERATIONS
    if iterations < 1:
        raise InputError(tr("Each step needs at least one iteration; enter a larger number."))
    for method in methods:
        if (
            not method_named(method).may_use_contact
            and document.has_active_obstacles
            and next_paint_sentence(document.labels)
        ):
            raise InputError(
                tr("Without contact obstacles move nothing, and {method!r} has none; omit it.").format(
                    method=method
                )
            )
    if not methods or len(set(methods)) < len(methods):
        raise InputError(tr("Give at least one method, and each method only once."))
    if document.paint_problem:
        raise InputError(document.paint_problem)
    document = document.relative_to_rest
    paths: tuple[SweepPath, ...] = motion_paths(document, motion) if motion else handle_paths(document)
    if not any(path.has_motion for path in paths) and not obstacle_shifts(document).any():
        raise InputError(
            tr("No handle has moved, so there is no motion to sweep; move a handle or give a twist.")
        )
    parts = tuple(last_share * k / steps for k in range(steps + 1))
    return Sweep(document, paths, parts, tuple(methods), iterations)
