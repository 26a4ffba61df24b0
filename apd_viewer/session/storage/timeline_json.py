"""JSON conversion of a timeline; its arrays are stored separately.

Programs that know no timeline open the session without it.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from apd_viewer.files.storage.json_fields import JsonFields
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import State
from apd_viewer.session.model.timeline import (
    MEASURING_FIELDS,
    MOST_STEPS,
    NO_TIMELINE,
    Timeline,
    TimelineStep,
)
from apd_viewer.session.storage import session_json
from apd_viewer.session.storage.session_json import NO_MAPS, WallMaps

MOST_BYTES = 128 * 2**20  # limit for all arrays of a timeline in a session file
_ARRAYS = "labels", "grip", "shape"
_KINDS = {"labels": "|u1", "grip": "<f8", "shape": "<f8"}
ArrayReader = Callable[[str, str], np.ndarray]


def saved_timeline(timeline: Timeline, state: State) -> Timeline:
    """Part of a timeline that is stored in the session file of ``state``.

    It has at least two steps, all of the same rest shape; the oldest beyond ``MOST_BYTES`` are left out.
    """
    mesh = state.document.mesh
    steps = [step for step in timeline.steps if step.state.document.mesh is mesh]
    # Two arrays of positions per step, and the shape of its Wall result.
    counts = np.cumsum([2 + (step.wall_result is not None) for step in reversed(steps)])
    count = int(np.count_nonzero(counts * mesh.V.nbytes <= MOST_BYTES))
    kept = steps[-max(2, count) :]
    if len(kept) < 2:
        return NO_TIMELINE
    return Timeline(tuple(kept), timeline.dropped + len(timeline.steps) - len(kept))


class _SavedStates:
    """Rows of JSON of states; documents and arrays that they share are stored once.

    Attributes
    ----------
    documents : list of dict
        JSON of the documents of the states.
    arrays : dict of str to array
        Arrays not among the arrays of the session.
    """

    def __init__(self, state: State) -> None:
        document = state.document
        own = {"labels": document.labels, "grip": document.initial_positions, "shape": state.frame.U}
        self._names = {id(array): name for name, array in ({"rest": document.mesh.V} | own).items()}
        self._numbers: dict[int, int] = {}
        self.documents: list[dict[str, Any]] = []
        self.arrays: dict[str, np.ndarray] = {}

    def row(self, state: State) -> dict[str, Any]:
        """JSON of a state; its document and its arrays are added."""
        document, U = state.document, state.frame.U
        found = dict(zip(_ARRAYS, (document.labels, document.initial_positions, U), strict=True))
        told = {name: self._name(name, array) for name, array in found.items()}
        if id(document) not in self._numbers:
            self._numbers[id(document)] = len(self.documents)
            said = _document_to_json(document) | {name: told[name] for name in _ARRAYS[:2]}
            self.documents.append(said)
        frame = session_json.frame_to_json(state.frame, len(document.obstacles))
        return {"document": self._numbers[id(document)], "shape": told["shape"], "frame": frame}

    def _name(self, kind: str, array: np.ndarray) -> str:
        if id(array) not in self._names:
            self._names[id(array)] = f"timeline-{kind}-{len(self.arrays)}"
            self.arrays[self._names[id(array)]] = array
        return self._names[id(array)]


def timeline_to_json(timeline: Timeline, state: State) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """JSON of a saved timeline and its arrays by name, for the session of a state."""
    saved = _SavedStates(state)
    rows = [saved.row(step.state) | {"begins_run": step.begins_run} for step in timeline.steps]
    count = len(saved.documents)
    for row, step in zip(rows, timeline.steps, strict=True):
        if step.wall_result is not None:
            row["wall"] = saved.row(step.wall_result)
    shown = timeline.index_of(state)
    # Versions that know no Wall results replace the session's shape by the state of the step ``shown``.
    is_wall = shown is not None and not timeline.steps[shown].has_own_shape_of(state)
    numbers = {"shown": None, "shown_wall": shown} if is_wall else {"shown": shown}
    said = {"documents": saved.documents[:count], "wall_documents": saved.documents[count:], "steps": rows}
    return {"dropped": timeline.dropped, **numbers, **said}, saved.arrays


def _document_to_json(document: Document) -> dict[str, Any]:
    """JSON of the fields of a document that determine its shape."""
    bare = replace(document, regions=(), measurements=(), poses=(), closed_openings=())
    return session_json.document_to_json(bare)


def timeline_from_json(
    fields: JsonFields, state: State, read: ArrayReader, maps: WallMaps = NO_MAPS
) -> tuple[Timeline, State]:
    """Timeline from JSON, and the session's state, replaced by its step if it has one.

    Parameters
    ----------
    read : callable
        ``read(name, kind)``: an array of the session, (n,) or (n, 3), by its name and type.
    """
    documents = [
        _document(each, state, read, maps)
        for name in ("documents", "wall_documents")
        if name == "documents" or fields.has_value(name)
        for each in fields.nested_list(name, MOST_STEPS)
    ]
    steps = [_step(each, state, documents, read) for each in fields.nested_list("steps", MOST_STEPS)]
    dropped, shown = fields.count("dropped"), state
    if fields.has_value("shown_wall"):
        k = _checked_index(fields, "shown_wall", steps)
        shown = steps[k].wall_state or state
    elif fields.has_value("shown"):
        k = _checked_index(fields, "shown", steps)
        if state.document.settings.traits.is_wall and steps[k].non_wall_state is not None:
            steps[k] = replace(steps[k], wall_result=state)  # older sessions had no other place for it
        else:
            shown = steps[k].state
    return Timeline(tuple(steps), dropped), shown


def _document(fields: JsonFields, state: State, read: ArrayReader, maps: WallMaps) -> Document:
    mesh = state.document.mesh
    labels, initial = (read(fields.text(name), _KINDS[name]) for name in _ARRAYS[:2])
    none = frozen(np.zeros(len(mesh.V), dtype=np.uint8))
    arrays = {"labels": labels, "grip": initial, "member": none, "shape": mesh.V}
    found = session_json.document_from_json(fields, mesh, arrays, maps)
    return replace(found, **{name: getattr(state.document, name) for name in MEASURING_FIELDS})


def _step(fields: JsonFields, state: State, documents: list[Document], read: ArrayReader) -> TimelineStep:
    own = _state(fields, state, documents, read)
    is_solved = fields.has_value("wall")
    wall_result = _state(fields.nested_fields("wall"), state, documents, read) if is_solved else None
    return TimelineStep(own, fields.flag("begins_run"), wall_result)


def _state(fields: JsonFields, state: State, documents: list[Document], read: ArrayReader) -> State:
    document = documents[_checked_index(fields, "document", documents)]
    U = read(fields.text("shape"), _KINDS["shape"])
    there = replace(state, document=document)
    frame = session_json.frame_from_json(fields.nested_fields("frame"), there, U)
    return replace(there, frame=frame)


def _checked_index(fields: JsonFields, key: str, things: Any) -> int:
    k = fields.count(key)
    if k >= len(things):
        raise ValueError(tr("its “{name}” is damaged").format(name=key))
    return k
