"""Frames of a sweep in contact: shapes at rest, once they touch beside one walk.

Which folds press against each other depends on the way there. Through shapes at rest it leads to others than
the walk of a single deformation does, and to others again by the number of the steps. So from the first shape
that touches itself each one comes to rest beside the walk, and the last one is that of a deformation to the
end of the motion. Before, the way does not matter, and each goes on from the one before: half the work.
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
    straight: bool,
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
    straight : bool
        Whether each step turns the handles by less than half a turn, so that it can be gone at once.
    """
    begun, U = 0, documents[0].grip if straight else None
    for number, document in enumerate(documents if straight else ()):
        step = Walk(solver, document, U, walks=False)
        frame = _at_rest(step, iterations, partial(tick, number))
        if frame.contact is not None and frame.contact.pairs:
            break
        yield frame
        begun, U = number + 1, None
    if begun < len(documents):
        yield from _beside_a_walk(solver, documents, shares, iterations, tick, begun)


def _beside_a_walk(
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
    walk = Walk(deformation_of(last, last.constraints(), solver.rest), last, U)
    for number, document in enumerate(others[begun:], begun):
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
