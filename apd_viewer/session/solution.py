"""Solutions: the documents that displayed shapes solve, and the way to each."""

from dataclasses import dataclass
from weakref import WeakKeyDictionary

from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import State
from apd_viewer.session.processes.request_and_reply import Cost, are_same_keys, solution_key


@dataclass(frozen=True, eq=False)
class Solution:
    """Document solved by a converged shape, with its cost and the way to it.

    Attributes
    ----------
    cost : Cost
        Its seconds are those of the last request alone.
    is_from_rest : bool
        True if one request has led from the rest shape to it, as in a comparison of methods. Otherwise it was
        reached by way of other shapes, as in a drag.
    """

    document: Document
    cost: Cost
    is_from_rest: bool


class Solutions:
    """Solutions by the frames that show them, which they do not keep alive."""

    def __init__(self) -> None:
        self._found: WeakKeyDictionary[Frame, Solution] = WeakKeyDictionary()
        self._finished: WeakKeyDictionary[Frame, Document] = WeakKeyDictionary()
        self._is_from_rest = False

    def begin(self, state: State, is_jump: bool, from_initial_positions: bool, is_busy: bool) -> None:
        """Note the beginning of a request.

        Parameters
        ----------
        is_jump : bool
            Whether the solver starts anew; otherwise it goes on from its last shape.
        from_initial_positions : bool
            Whether it starts there, instead of from the shape of the state.
        is_busy : bool
            Whether an earlier request has not been finished.
        """
        document = state.document
        # Half turns are followed along their paths, from the initial positions, only after a jump.
        starts_there = from_initial_positions or (is_jump and document.has_half_turn)
        start = document.initial_positions if starts_there else state.frame.U
        begins_anew = is_jump or not (is_busy or document.has_half_turn)
        moves_obstacles = any(each.shift.any() for each in document.obstacles)
        self._is_from_rest = (
            start is document.mesh.V
            and begins_anew
            and document.relative_to_rest is document
            and not moves_obstacles
        )

    def interrupt(self) -> None:
        """Note that the solver goes on from a shape on its way."""
        self._is_from_rest = False

    def add(self, document: Document, frame: Frame, cost: Cost | None) -> None:
        """Add the last shape of a request, if it has converged."""
        if frame.converged and cost is not None:
            self._found[frame] = Solution(document, cost, self._is_from_rest)

    def note_finished(self, state: State) -> None:
        """Note that the solver has finished with the shape of a state, converged or not."""
        self._finished[state.frame] = state.document

    def is_finished(self, state: State) -> bool:
        """True if the solver has finished with the shape for the document of a state."""
        document = self._finished.get(state.frame)
        return document is not None and are_same_keys(solution_key(document), solution_key(state.document))

    def solution_of(self, state: State) -> Solution | None:
        """Solution that a state displays; None if its document asks for another one."""
        found = self._found.get(state.frame)
        if found is None or not are_same_keys(solution_key(found.document), solution_key(state.document)):
            return None
        return found
