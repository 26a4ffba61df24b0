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
    kept = steps[-max(2, MOST_BYTES // (2 * mesh.V.nbytes)) :]  # two arrays of positions per step
    if len(kept) < 2:
        return NO_TIMELINE
    return Timeline(tuple(kept), timeline.dropped + len(timeline.steps) - len(kept))


def timeline_to_json(timeline: Timeline, state: State) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """JSON of a saved timeline and its arrays by name, for the session of a state."""
    own = {"labels": state.document.labels, "grip": state.document.initial_positions, "shape": state.frame.U}
    names = {id(array): name for name, array in ({"rest": state.document.mesh.V} | own).items()}
    arrays: dict[str, np.ndarray] = {}
    documents: dict[int, int] = {}
    said: list[dict[str, Any]] = []
    rows = []
    for step in timeline.steps:
        document, frame = step.state.document, step.state.frame
        found = dict(zip(_ARRAYS, (document.labels, document.initial_positions, frame.U), strict=True))
        for name, array in found.items():
            if id(array) not in names:
                names[id(array)] = f"timeline-{name}-{len(arrays)}"
                arrays[names[id(array)]] = array
        told = {name: names[id(array)] for name, array in found.items()}
        if id(document) not in documents:
            documents[id(document)] = len(said)
            said.append(_document_to_json(document) | {name: told[name] for name in _ARRAYS[:2]})
        rows.append(
            {
                "document": documents[id(document)],
                "shape": told["shape"],
                "begins_run": step.begins_run,
                "frame": session_json.frame_to_json(frame),
            }
        )
    shown = timeline.index_of(state)
    return {"dropped": timeline.dropped, "shown": shown, "documents": said, "steps": rows}, arrays


def _document_to_json(document: Document) -> dict[str, Any]:
    """JSON of the fields of a document that determine its shape."""
    bare = replace(document, regions=(), measurements=(), poses=())
    return session_json.document_to_json(bare)


def timeline_from_json(fields: JsonFields, state: State, read: ArrayReader) -> tuple[Timeline, State]:
    """Timeline from JSON, and the session's state, replaced by its step if it has one.

    Parameters
    ----------
    read : callable
        ``read(name, kind)``: an array of the session, (n,) or (n, 3), by its name and type.
    """
    documents = [_document(each, state, read) for each in fields.nested_list("documents", MOST_STEPS)]
    steps = tuple(_step(each, state, documents, read) for each in fields.nested_list("steps", MOST_STEPS))
    timeline = Timeline(steps, fields.count("dropped"))
    if not fields.has_value("shown"):
        return timeline, state
    return timeline, steps[_checked_index(fields, "shown", steps)].state


def _document(fields: JsonFields, state: State, read: ArrayReader) -> Document:
    mesh = state.document.mesh
    labels, initial = (read(fields.text(name), _KINDS[name]) for name in _ARRAYS[:2])
    none = frozen(np.zeros(len(mesh.V), dtype=np.uint8))
    arrays = {"labels": labels, "grip": initial, "member": none, "shape": mesh.V}
    found = session_json.document_from_json(fields, mesh, arrays)
    return replace(found, **{name: getattr(state.document, name) for name in MEASURING_FIELDS})


def _step(fields: JsonFields, state: State, documents: list[Document], read: ArrayReader) -> TimelineStep:
    document = documents[_checked_index(fields, "document", documents)]
    U = read(fields.text("shape"), _KINDS["shape"])
    there = replace(state, document=document)
    frame = session_json.frame_from_json(fields.nested_fields("frame"), there, U)
    return TimelineStep(replace(there, frame=frame), fields.flag("begins_run"))


def _checked_index(fields: JsonFields, key: str, things: Any) -> int:
    k = fields.count(key)
    if k >= len(things):
        raise ValueError(tr("its “{name}” is damaged").format(name=key))
    return k
