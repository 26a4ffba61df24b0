"""A finished case as a session, to look at its shape in the window."""

from __future__ import annotations

from pathlib import Path

from apd_viewer.cases.case_document import CaseDocuments, case_state, case_sweep, motion_share
from apd_viewer.cases.case_file import damaged_case_error, read_case
from apd_viewer.cases.plan_row import parse_cell
from apd_viewer.cases.study_case import StudyCase
from apd_viewer.errors import InputError
from apd_viewer.files.storage.json_fields import JsonFields
from apd_viewer.files.storage.regular_files import read_bytes
from apd_viewer.language import tr
from apd_viewer.session.model.state import State
from apd_viewer.session.model.view import View
from apd_viewer.session.posing.motion_path import document_along
from apd_viewer.session.storage.session_json import frame_from_json

INPUTS_FOLDER = "inputs"


def case_session(folder: Path, key: str) -> tuple[State, View]:
    """State of a finished case, its shape bit for bit, and the view.

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
    except (ValueError, TypeError, KeyError, AttributeError) as error:  # made by somebody else
        raise damaged_case_error(folder, key) from error
    except OSError as error:
        raise InputError(
            tr("The mesh of this case is gone from {folder}; run the study again.").format(
                folder=folder / INPUTS_FOLDER
            )
        ) from error
    document, part = state.document, motion_share(case)
    if motion or part != 1.0:
        sweep = case_sweep(case, document, motion)
        document = document_along(sweep.document_at(part), sweep.paths, part)
    state = state.updated(document)
    return state.updated(frame=frame_from_json(JsonFields(result.frame, "frame"), state, result.U)), view
