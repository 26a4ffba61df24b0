"""Frames of a sweep in contact: shapes at rest, once they touch beside one walk.

Which folds press against each other depends on the way there. Through shapes at rest it leads to others than
the walk of a single deformation does, and to others again by the number of the steps. So from the first shape
that touches itself each one comes to rest beside the walk, and the last one is that of a deformation to the
end of the motion. Before, the way does not matter, and each goes on from the one before: half the work.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np

from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.path_iteration import PathIteration
from apd_viewer.session.model.document import Document
from apd_viewer.session.processes.document_deformation import deformation_of, document_iteration


def contact_frames(
    solver: Deformation,
    documents: Sequence[Document],
    shares: Sequence[float],
    iterations: int,
    tick: Callable[[int, int], object],
    is_direct: bool,
) -> Iterator[Frame]:
    """Frame of each step.

    Parameters
    ----------
    solver : Deformation
        In contact.
    documents : sequence of Document
        With the handles at each step; the last one with all turns on its way.
    shares : sequence of float
        Of the way to the last one, for each.
    iterations : int
        At most so many for each step, without those on the way to it.
    tick : callable
        Called after every iteration with the numbers of the step and of the iteration, from 0.
    is_direct : bool
        Whether each step turns the handles by less than half a turn, so that it can be gone at once.
    """
    begun, U = 0, documents[0].grip if is_direct else None
    for number, document in enumerate(documents if is_direct else ()):
        step = document_iteration(solver, document, U, along_paths=False)
        frame = step.settle(iterations, partial(tick, number))
        if frame.contact is not None and frame.contact.pairs:
            break
        yield frame
        begun, U = number + 1, None
    if begun < len(documents):
        yield from _frames_beside_path(solver, documents, shares, iterations, tick, begun)


def _frames_beside_path(
    solver: Deformation,
    documents: Sequence[Document],
    shares: Sequence[float],
    iterations: int,
    tick: Callable[[int, int], object],
    begun: int,
) -> Iterator[Frame]:
    """Frames from step ``begun`` on, each beside a walk from rest to the last."""
    *others, last = documents
    U = last.grip
    walk = document_iteration(deformation_of(last, last.constraints(), solver.rest), last, U)
    for number, document in enumerate(others[begun:], begun):
        U = _shape_before(walk, shares[number], U, partial(tick, number))
        beside = document_iteration(solver, document, U, along_paths=False)
        yield beside.settle(iterations, partial(tick, number))
    yield walk.settle(iterations, partial(tick, len(others)))


def _shape_before(
    iteration: PathIteration, share: float, U: np.ndarray, tick: Callable[[int], object]
) -> np.ndarray:
    """Last shape (n, 3) of a walk up to a share of its way; ``U`` is the last so far."""
    while iteration.is_on_its_way:
        frame = iteration.frame()
        if frame.share_reached > share:
            break
        U = frame.U
        iteration.iterate()
        tick(0)  # the iterations at the step itself are counted
    return U
