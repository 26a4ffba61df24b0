"""Study case: its document, its computation, and its result."""

import tempfile
import time
from collections import OrderedDict
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from apd_viewer.cases.case import Case, CaseStep, case_of, case_steps
from apd_viewer.cases.case_file import DONE, FAILED, CaseResult, damaged_case_error, read_case
from apd_viewer.cases.plan import parse_cell
from apd_viewer.cases.plan_columns import LENGTH_COLUMNS, YOUNG_COLUMN
from apd_viewer.cases.study_case import InputFile, StudyCase
from apd_viewer.errors import InputError
from apd_viewer.files.meshes import read_mesh
from apd_viewer.files.selections.selection_files import read_selection_file
from apd_viewer.files.storage.json_fields import JsonFields
from apd_viewer.files.storage.regular_files import read_bytes
from apd_viewer.geometry.analysis.shape_check import check_shape
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.solver.convergence import DISTURBANCE
from apd_viewer.geometry.solver.methods import no_contact_warning
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import with_selection
from apd_viewer.session.model.state import State, initial_state
from apd_viewer.session.model.view import SESSION_SUFFIX, View
from apd_viewer.session.posing.motion_path import MotionStep
from apd_viewer.session.posing.motion_text import motion_steps
from apd_viewer.session.quantities.expressions import parse_length
from apd_viewer.session.quantities.newton_conversion import settings_pascals, wall_pascals
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.volume_target import parse_volume_target
from apd_viewer.session.storage.session_file import open_session
from apd_viewer.session.storage.session_json import frame_from_json, frame_to_json

T = TypeVar("T")
# A worker caches the meshes used last, up to this total number of vertices.
_MOST_VERTICES = 1_000_000

Content = Callable[["InputFile"], bytes]
INPUTS_FOLDER = "inputs"
# Final readings of a case besides those of its curves, in table order.
FINAL_READINGS = (
    "area",
    "area_rest",
    "volume_rest",
    "volume_error",
    "local_change",
    "largest_edge_strain",
    "mean_edge_strain",
    "handle_drift",
    "share_reached",
    "least_gap",
    "box_volume",
    "packed_volume",
    "hull_volume",
    "iterations",
    "unsettled_steps",
    "saddle_escapes",
    "turned",
    "turned_held",
)
_OF_ITERATIONS = "iterations", "settled", "stable", "saddle_escapes"  # readings of a step without a curve


class MissingInputError(Exception):
    """Input file not readable from this machine."""


class CaseDocuments:
    """Cache of the undeformed meshes and sessions opened for cases.

    Parameters
    ----------
    content : callable
        Bytes of a source; raises MissingInputError where they cannot be had.
    """

    def __init__(self, content: Content) -> None:
        self._content = content
        self._kept: OrderedDict[tuple[str, str], tuple[State, View]] = OrderedDict()

    def painted_state(self, case: StudyCase) -> tuple[State, View]:
        """State of a case before its settings and motion apply; raises InputError."""
        key = case.mesh.digest, "" if case.selection is None else case.selection.digest
        if key not in self._kept:
            self._kept[key] = self._opened_state(case)
            while len(self._kept) > 1 and self._vertices > _MOST_VERTICES:
                self._kept.popitem(last=False)
        self._kept.move_to_end(key)
        return self._kept[key]

    @property
    def _vertices(self) -> int:
        return sum(len(state.document.mesh.V) for state, _ in self._kept.values())

    def _opened_state(self, case: StudyCase) -> tuple[State, View]:
        content = self._content(case.mesh)
        if case.mesh.suffix == SESSION_SUFFIX:
            return _read_file(case.mesh, content, open_session)
        mesh = read_mesh(case.mesh.path, content)
        state, selection = initial_state(mesh), case.selection
        assert selection is not None  # plans require a selection for a mesh
        read = _read_file(selection, self._content(selection), lambda path: read_selection_file(path, mesh))
        document = with_selection(state.document, read)
        # Cases without a contact setting date from when contact was off by default.
        document = document.with_settings(contact=False)
        return replace(state, document=document), View(unit=case.unit or mesh.unit)


def _read_file(source: InputFile, content: bytes, read: Callable[[Path], T]) -> T:
    """Read ``content`` through a temporary file with the source's name."""
    with tempfile.TemporaryDirectory(prefix="apd-viewer-") as folder:
        path = Path(folder) / source.path.name
        path.write_bytes(content)
        return read(path)


def case_state(case: StudyCase, documents: CaseDocuments) -> tuple[State, View, tuple[MotionStep, ...]]:
    """State of a case with its settings applied, its view, and its parsed motion.

    Raises
    ------
    InputError
        If something of it does not fit the mesh; a sentence says what.
    """
    state, view = documents.painted_state(case)
    said, unit = dict[str, Any](case.settings), Unit(view.unit)
    for name in ("iterations", "to"):  # settings of the computation, not of the document
        said.pop(name, None)
    if case.contact_by_default:
        said["contact"] = len(state.document.mesh.V) <= int(said["contact"])
    for name in LENGTH_COLUMNS & said.keys():
        said[name] = parse_length(str(said[name]), unit, state.document.mesh.named_lengths)
    wanted, pressure, young = (said.pop(name, None) for name in ("volume", "pressure", YOUNG_COLUMN))
    # In place of what a session keeps.
    said = dict.fromkeys(("volume", "filled_volume", "gas") if pressure is not None else ()) | said
    if wanted is not None:
        said["pressure"] = None
        in_percent = not isinstance(wanted, str)
        said |= parse_volume_target(f"{wanted}%" if in_percent else str(wanted), unit)._asdict()
    if wanted is not None and state.inspection.missing_volume_phrase:
        raise InputError(
            tr("There is no volume to keep: {why}; leave the volume free.").format(
                why=state.inspection.missing_volume_phrase
            )
        )
    criteria: dict[str, Any] = {name: said.pop(name) for name in DISTURBANCE if name in said}
    convergence = state.document.settings.convergence._replace(**criteria)
    document = state.document.with_settings(**said, convergence=convergence)
    if pressure is not None:
        settings, size = document.settings, diagonal(document.mesh.V)
        pascals = settings_pascals(settings, size, view.wall, unit)
        if young is not None:
            pascals = wall_pascals(float(young), size, settings.wall_thickness, settings.poisson)
        if pascals is None:
            raise InputError(tr("A pressure needs Young's modulus of the wall; fill in “young”."))
        document = document.with_settings(pressure=float(pressure) / pascals)
    state = state.updated(document)
    motion = motion_steps(state.document, "; ".join(case.motion), unit) if case.motion else ()
    return state, view, motion


def case_to_run(case: StudyCase, document: Document, motion: tuple[MotionStep, ...]) -> Case:
    """Case for the inputs of a study case; raises InputError if nothing moves."""
    iterations = dict(case.settings).get("iterations")
    most = None if iterations is None else int(iterations)
    return case_of(document, case.steps, _last_fraction(case), most, motion)


def _last_fraction(case: StudyCase) -> float:
    return float(dict(case.settings).get("to", 1.0))


def case_session(folder: Path, key: str) -> tuple[State, View]:
    """State of a finished case with its exact computed shape, and its view.

    Parameters
    ----------
    folder : Path
        Of the study.
    key : str
        Of the case.

    Raises
    ------
    InputError
        If it is not done, has failed, or what it needs is gone.
    """
    result = read_case(folder, key, with_shape=True)
    if result.U is None:
        raise InputError(tr("This case has no shape: {sentence}").format(sentence=result.sentence))
    try:
        case = StudyCase.from_json(result.case, folder / INPUTS_FOLDER)
        parse_cell("steps", str(case.steps))
        state, view, motion = case_state(case, CaseDocuments(lambda source: read_bytes(source.path)))
        if len(state.document.mesh.V) != len(result.U):
            raise ValueError
    except InputError:
        raise
    except (ValueError, TypeError, KeyError, AttributeError) as error:  # file not written by this program
        raise damaged_case_error(folder, key) from error
    except OSError as error:
        raise InputError(
            tr("The mesh of this case is gone from {folder}; run the study again.").format(
                folder=folder / INPUTS_FOLDER
            )
        ) from error
    if motion or _last_fraction(case) != 1.0:
        state = state.updated(case_to_run(case, state.document, motion).end_document)
    return state.updated(frame=frame_from_json(JsonFields(result.frame, "frame"), state, result.U)), view


class _OutOfTimeError(Exception):
    """Time limit of a case exceeded."""


def run_case(case: StudyCase, documents: CaseDocuments, limit: float | None = None) -> CaseResult:
    """Compute a case; any failure becomes a sentence in its result.

    Parameters
    ----------
    limit : float, optional
        Seconds that it may take.

    Raises
    ------
    MissingInputError
        If a file that it needs is not here.
    """
    started = time.perf_counter()

    def tick(*_: object) -> None:
        if limit is not None and time.perf_counter() - started > limit:
            raise _OutOfTimeError

    try:
        state, _, motion = case_state(case, documents)
        computed = case_to_run(case, state.document, motion)
        # Divergence is detected from the resulting shape and reported in a sentence.
        with np.errstate(all="ignore"):
            return _result(case, computed, list(_checked_steps(computed, tick)), started)
    except _OutOfTimeError:
        return failed_result(case, tr("It took longer than {limit:g} s.").format(limit=limit))
    except InputError as error:
        return failed_result(case, " ".join(str(error).split()))
    except MissingInputError:
        raise
    except MemoryError:
        return failed_result(case, tr("It does not fit into memory."))
    except Exception as error:
        # A program error fails this case only; the study continues with the others.
        return failed_result(case, tr("The program failed: {error!r}.").format(error=error)[:500])


def failed_result(case: StudyCase, sentence: str) -> CaseResult:
    """Result of a failed case."""
    return CaseResult(case.key, case.to_json, FAILED, sentence)


def _checked_steps(case: Case, tick: Callable[..., object]) -> Iterator[CaseStep]:
    for step in case_steps(case, tick):
        if not np.isfinite(step.frame.U).all():
            raise InputError(tr("It diverged in step {number}.").format(number=step.number))
        # Only the last shape is kept, to save memory.
        last = step.number == len(case.fractions) - 1
        yield step if last else step._replace(frame=replace(step.frame, U=case.document.mesh.V[:0]))


def _result(case: StudyCase, computed: Case, steps: list[CaseStep], started: float) -> CaseResult:
    last = steps[-1]
    frame = last.frame
    room = check_shape(frame.U, computed.document.mesh.joined_F)
    curves = {
        name: [_number(step.readings[name]) for step in steps]
        for name in last.readings
        if name not in _OF_ITERATIONS
    }
    readings = {
        **{name: values[-1] for name, values in curves.items()},
        "area_rest": frame.area / (1.0 + frame.area_error),
        "volume_rest": last.volume_rest,
        "least_gap": None if frame.contact is None else frame.contact.least_gap,
        "crossings": None if room.crossing is None else len(room.crossing),
        "box_volume": room.box,
        "packed_volume": room.packed_box,
        "hull_volume": room.hull.volume,
        "iterations": sum(step.frame.iteration for step in steps),
        "unsettled_steps": sum(not step.frame.settled for step in steps),
        "saddle_escapes": sum(step.frame.saddle_escapes for step in steps),
        "seconds": round(time.perf_counter() - started, 3),
    }
    told = (
        _warning_sentences(case, computed, steps),
        {name: _number(value) for name, value in readings.items()},
    )
    return CaseResult(
        case.key, case.to_json, DONE, *told, curves, frame_to_json(frame, len(frame.shifts)), frame.U
    )


def _number(value: Any) -> float | None:
    """Number for JSON, keeping integers; None if it is not finite."""
    if value is None or not np.isfinite(value):
        return None
    return value if isinstance(value, int) else float(value)


def _warning_sentences(case: StudyCase, computed: Case, steps: list[CaseStep]) -> str:
    """Warnings about a computed case; empty if there are none."""
    last = steps[-1]
    said = list(computed.step_warnings(last))
    unsettled = sum(not step.frame.settled for step in steps)
    if unsettled and not last.frame.unreached and last.frame.share_reached == 1.0:
        said.append(
            tr("{count} of {steps} shapes did not converge within {most} iterations.").format(
                count=unsettled, steps=len(steps), most=computed.iterations
            )
        )
    if case.contact_by_default:
        said.append(
            no_contact_warning(last.method, len(computed.document.mesh.V), tr("“contact” in the plan"))
        )
    return " ".join(filter(None, said))
