"""A case walked from its beginning to its end, with its readings."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from apd_viewer.cases.case import Case, CaseStep, run
from apd_viewer.cases.case_document import CaseDocuments, MissingInputError, case_state, case_to_run
from apd_viewer.cases.case_file import DONE, FAILED, CaseResult
from apd_viewer.cases.study_case import StudyCase
from apd_viewer.errors import InputError
from apd_viewer.geometry.analysis.shape_check import check_shape
from apd_viewer.geometry.solver.methods import passing_walls_warning
from apd_viewer.language import tr
from apd_viewer.session.storage.session_json import frame_to_json

# Readings of a case beside those of its curves, in the order of the tables.
FINAL_READINGS = (
    "area",
    "area_rest",
    "volume_rest",
    "volume_error",
    "local_change",
    "handle_drift",
    "share_reached",
    "least_gap",
    "box_volume",
    "packed_volume",
    "hull_volume",
    "iterations",
    "unsettled_steps",
    "turned",
    "turned_held",
)
_OF_ITERATIONS = "iterations", "settled"  # readings of a step that are no curves


class _OutOfTimeError(Exception):
    """The case took longer than it may."""


def run_case(case: StudyCase, documents: CaseDocuments, limit: float | None = None) -> CaseResult:
    """Walk a case; whatever is wrong with it is a sentence of its result.

    Parameters
    ----------
    case : StudyCase
    documents : CaseDocuments
    limit : float, optional
        Seconds that it may take.

    Raises
    ------
    MissingSourceError
        If a file that it needs is not here.
    """
    started = time.perf_counter()

    def tick(*_: object) -> None:
        if limit is not None and time.perf_counter() - started > limit:
            raise _OutOfTimeError

    try:
        state, _, motion = case_state(case, documents)
        computed = case_to_run(case, state.document, motion)
        # A divergence is found in what it has done to the shape, and said in a sentence.
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
        # One case must not end a study: a defect of the program is named, and the others go on.
        return failed_result(case, tr("The program failed: {error!r}.").format(error=error)[:500])


def failed_result(case: StudyCase, sentence: str) -> CaseResult:
    """Result of a failed case."""
    return CaseResult(case.key, case.to_json, FAILED, sentence)


def _checked_steps(case: Case, tick: Callable[..., object]) -> Iterator[CaseStep]:
    for step in run(case, tick):
        if not np.isfinite(step.frame.U).all():
            raise InputError(tr("It diverged in step {number}.").format(number=step.number))
        # Shapes on the way need not be kept in memory.
        last = step.number == len(case.shares) - 1
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
        "packed_volume": room.packed,
        "hull_volume": room.hull.volume,
        "iterations": sum(step.frame.iteration for step in steps),
        "unsettled_steps": sum(not step.frame.settled for step in steps),
        "seconds": round(time.perf_counter() - started, 3),
    }
    told = _sentence(case, computed, steps), {name: _number(value) for name, value in readings.items()}
    return CaseResult(case.key, case.to_json, DONE, *told, curves, frame_to_json(frame), frame.U)


def _number(value: Any) -> float | None:
    """Number for JSON, a whole one as an integer; None if it is not finite."""
    if value is None or not np.isfinite(value):
        return None
    return value if isinstance(value, int) else float(value)


def _sentence(case: StudyCase, computed: Case, steps: list[CaseStep]) -> str:
    """Sentence for the user; empty without anything to say."""
    last = steps[-1]
    said = list(computed.warnings_of(last))
    unsettled = sum(not step.frame.settled for step in steps)
    if unsettled and not last.frame.unreached and last.frame.share_reached == 1.0:
        said.append(
            tr("{count} of {steps} shapes did not converge within {most} iterations.").format(
                count=unsettled, steps=len(steps), most=computed.iterations
            )
        )
    if case.contact_by_default:
        said.append(
            passing_walls_warning(last.method, len(computed.document.mesh.V), tr("“contact” in the plan"))
        )
    return " ".join(filter(None, said))
