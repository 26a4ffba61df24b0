"""The document of a case: its mesh, paint and settings, and its motion as a sweep."""

from __future__ import annotations

import tempfile
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from apd_viewer.errors import InputError
from apd_viewer.files.meshes import read_mesh
from apd_viewer.files.selections.selection_files import read_selection_file
from apd_viewer.language import tr
from apd_viewer.session.model.document_selection import with_selection
from apd_viewer.session.model.state import State, opened
from apd_viewer.session.model.view import SUFFIX, View
from apd_viewer.session.posing.motion_step import MotionStep, motion_of
from apd_viewer.session.posing.motion_text import parsed_motion
from apd_viewer.session.posing.typed_motion import names_of
from apd_viewer.session.quantities.expressions import length
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.storage.session_file import open_session
from apd_viewer.session.studies.sweep_setup import sweep_of

if TYPE_CHECKING:
    from apd_viewer.session.model.document import Document
    from apd_viewer.session.studies.sweep import Sweep
    from apd_viewer.studies.plans.case import Source, StudyCase

T = TypeVar("T")
# Opened meshes that a worker keeps, the last used ones, have at most so many vertices together.
_MOST_VERTICES = 1_000_000

Content = Callable[["Source"], bytes]


class MissingSourceError(Exception):
    """A source is not to be seen from this machine."""


class OpenedMeshes:
    """Meshes and sessions at rest, opened once each and kept for the next case.

    Parameters
    ----------
    content : callable
        Bytes of a source; raises MissingSourceError where they cannot be had.
    """

    def __init__(self, content: Content) -> None:
        self._content = content
        self._kept: OrderedDict[tuple[str, str], tuple[State, View]] = OrderedDict()

    def painted(self, case: StudyCase) -> tuple[State, View]:
        """The state of a case before its settings and its motion; raises InputError."""
        key = case.mesh.digest, "" if case.selection is None else case.selection.digest
        if key not in self._kept:
            self._kept[key] = self._opened(case)
            while len(self._kept) > 1 and self._vertices > _MOST_VERTICES:
                self._kept.popitem(last=False)
        self._kept.move_to_end(key)
        return self._kept[key]

    @property
    def _vertices(self) -> int:
        return sum(len(state.document.mesh.V) for state, _ in self._kept.values())

    def _opened(self, case: StudyCase) -> tuple[State, View]:
        content = self._content(case.mesh)
        if case.mesh.suffix == SUFFIX:
            return _in_a_file(case.mesh, content, open_session)
        mesh = read_mesh(case.mesh.path, content)
        state, selection = opened(mesh), case.selection
        assert selection is not None  # plans have one for each mesh
        read = _in_a_file(selection, self._content(selection), lambda path: read_selection_file(path, mesh))
        document = with_selection(state.document, read)
        # Cases that do not say it are from a time when walls passed through each other by default.
        document = replace(document, contact=False)
        return replace(state, document=document), View(unit=case.unit or mesh.unit)


def _in_a_file(source: Source, content: bytes, read: Callable[[Path], T]) -> T:
    """Read a file of this content, wherever the original is."""
    with tempfile.TemporaryDirectory(prefix="apd-viewer-") as folder:
        path = Path(folder) / source.path.name
        path.write_bytes(content)
        return read(path)


def state_of(case: StudyCase, meshes: OpenedMeshes) -> tuple[State, View, tuple[MotionStep, ...]]:
    """State of a case with its settings, the view, and its typed motion.

    Raises
    ------
    InputError
        If something of it does not fit the mesh; a sentence says what.
    """
    state, view = meshes.painted(case)
    said, unit = dict(case.settings), Unit(view.unit)
    for name in ("iterations", "to"):  # of the walk, not of the document
        said.pop(name, None)
    if case.contact_by_default:
        said["contact"] = len(state.document.mesh.V) <= int(said["contact"])
    if "thickness" in said:
        said["thickness"] = length(str(said["thickness"]), unit, names_of(state))
    if said.get("volume") is not None and state.inspection.nothing_to_keep:
        raise InputError(
            tr("There is no volume to keep: {why}; leave the volume free.").format(
                why=state.inspection.nothing_to_keep
            )
        )
    state = state.at(replace(state.document, **said))  # type: ignore[arg-type]
    typed = parsed_motion("; ".join(case.motion)) if case.motion else ()
    return state, view, motion_of(state.document, typed, names_of(state), unit)


def sweep_of_case(case: StudyCase, document: Document, motion: tuple[MotionStep, ...]) -> Sweep:
    """Sweep of a case; raises InputError if nothing moves."""
    iterations = dict(case.settings).get("iterations")
    most = None if iterations is None else int(iterations)
    return sweep_of(document, case.steps, part_of_motion(case), (document.method,), most, motion)


def part_of_motion(case: StudyCase) -> float:
    """Part of the motion at the last step of a case."""
    return float(dict(case.settings).get("to", 1.0))
