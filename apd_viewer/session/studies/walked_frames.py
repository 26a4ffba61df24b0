"""Frames of a sweep in contact: shapes at rest beside one walk to the last.

Which folds press against each other depends on the way there. Through shapes at rest it leads to others than
the walk of a single deformation does, and to others again by the number of the steps. So each shape comes to
rest beside the walk, and the last one is that of a deformation to the end of the motion.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING

from apd_viewer.session.processes.deforming import deformation_of
from apd_viewer.session.processes.walk import Walk

if TYPE_CHECKING:
    import numpy as np

    from apd_viewer.geometry.pose.frame import Frame
    from apd_viewer.geometry.solver.deformation import Deformation
    from apd_viewer.session.model.document import Document


def walked_frames(
    solver: Deformation,
    documents: Sequence[Document],
    shares: Sequence[float],
    iterations: int,
    tick: Callable[[int, int], object],
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
    """
    *others, last = documents
    U = last.grip
    walk = Walk(deformation_of(last, last.constraints(), solver.rest), last, U)
    for number, document in enumerate(others):
        U = _shape_before(walk, shares[number], U, partial(tick, number))
        beside = Walk(solver, document, U, walks=False)
        yield _at_rest(beside, iterations, partial(tick, number))
    yield _at_rest(walk, iterations, partial(tick, len(others)))


def _shape_before(walk: Walk, share: float, U: np.ndarray, tick: Callable[[int], object]) -> np.ndarray:
    """Last shape (n, 3) of a walk up to a share of its way; ``U`` is the last so far."""
    while walk.is_on_its_way:
        frame = walk.frame()
        if frame.share_reached > share:
            break
        U = frame.U
        walk.iterate()
        tick(0)  # the iterations at the step itself are counted
    return U


def _at_rest(walk: Walk, most: int, tick: Callable[[int], object]) -> Frame:
    """Frame at the end of a walk, after at most so many iterations there."""
    count = 0
    while walk.is_on_its_way or (count < most and not walk.settled):
        walk.iterate()
        count += not walk.is_on_its_way
        tick(count)
    return walk.frame()
