"""A finished case as a session, to look at its shape in the window."""

from __future__ import annotations

from typing import TYPE_CHECKING

from apd_viewer.errors import InputError
from apd_viewer.files.storage.json_fields import Fields
from apd_viewer.files.storage.reading import bytes_of
from apd_viewer.language import tr
from apd_viewer.session.posing.motion_path import posed_along
from apd_viewer.session.storage.session_file import save_session
from apd_viewer.session.storage.session_json import frame_of
from apd_viewer.studies.case_document import OpenedMeshes, part_of_motion, state_of, sweep_of_case
from apd_viewer.studies.case_file import damaged_case, read_case
from apd_viewer.studies.plans.case import StudyCase
from apd_viewer.studies.plans.plan_row import value_of

if TYPE_CHECKING:
    from pathlib import Path

    from apd_viewer.session.model.state import State
    from apd_viewer.session.model.view import View

INPUTS = "inputs"


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
    result = read_case(folder, key, shape=True)
    if result.U is None:
        raise InputError(tr("This case has no shape: {sentence}").format(sentence=result.sentence))
    try:
        case = StudyCase.of(result.case, folder / INPUTS)
        value_of("steps", str(case.steps))
        state, view, motion = state_of(case, OpenedMeshes(lambda source: bytes_of(source.path)))
        if len(state.document.mesh.V) != len(result.U):
            raise ValueError
    except InputError:
        raise
    except (ValueError, TypeError, KeyError, AttributeError) as error:  # made by somebody else
        raise damaged_case(folder, key) from error
    except OSError as error:
        raise InputError(
            tr("The mesh of this case is gone from {folder}; run the study again.").format(
                folder=folder / INPUTS
            )
        ) from error
    document, part = state.document, part_of_motion(case)
    if motion or part != 1.0:
        sweep = sweep_of_case(case, document, motion)
        document = posed_along(sweep.document_at(part), sweep.paths, part)
    state = state.at(document)
    return state.at(frame=frame_of(Fields(result.frame, "frame"), state, result.U)), view


def write_case_session(folder: Path, key: str, path: Path) -> None:
    """Write the session of a finished case, with its mesh in it; raises InputError."""
    save_session(path, *case_session(folder, key), embed=True)
