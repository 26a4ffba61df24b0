"""Plan and session of a new study, and the document at the ends of its ranges."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from apd_viewer.cases.design import DesignVariable, design_table
from apd_viewer.cases.plan_columns import SETTING_COLUMNS
from apd_viewer.errors import InputError
from apd_viewer.files.tables import write_table
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.handle_paths import document_at, handle_paths
from apd_viewer.session.model.state import State
from apd_viewer.session.model.view import View
from apd_viewer.session.posing.motion_path import document_along, motion_paths
from apd_viewer.session.posing.motion_text import motion_steps
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.storage.session_file import save_session
from apd_viewer.ui.studies.varied_fields import SHARE_COLUMN, QuantityRange

PLAN_FILE, SESSION_FILE = "plan.csv", "session.apd"
PlanRows = tuple[list[str], list[list[str]]]


class StudyDesign(NamedTuple):
    """Choice of the cases within the ranges.

    Attributes
    ----------
    spans : tuple of QuantityRange
    methods : tuple of str
        Of deformation; at least one.
    method : str
        One of ``DESIGNS``.
    samples : int
        Cases; of a grid, levels of a range.
    steps : int
        Of each case.
    handle : int
        That typed motions move.
    """

    spans: tuple[QuantityRange, ...]
    methods: tuple[str, ...]
    method: str
    samples: int
    steps: int
    handle: int

    @property
    def has_motion(self) -> bool:
        """True if a motion is typed, instead of that of the session."""
        return any(span.quantity.is_motion for span in self.spans)

    def plan_rows(self, default_method: str) -> PlanRows:
        """Columns and rows of the plan, each row once.

        Parameters
        ----------
        default_method : str
            Method of the session, for which no column is needed.

        Raises
        ------
        InputError
            If nothing varies.
        """
        vary = [span.varied for span in self.spans if span.high is not None]
        vary += [DesignVariable("method", self.methods)] if len(self.methods) > 1 else []
        if not vary:
            raise InputError(tr("Nothing varies; give both ends of a range, or tick several methods."))
        columns, rows = design_table(self._given(default_method), vary, self.method, self.samples, 0)
        # With choices alone there are fewer different cases than samples.
        return columns, [list(row) for row in dict.fromkeys(map(tuple, rows))]

    def _given(self, usual: str) -> dict[str, str]:
        """Cells common to all rows, by column."""
        fixed = {s.quantity.name: s.low for s in self.spans if s.high is None and not s.quantity.is_motion}
        fixed |= {"method": self.methods[0]} if len(self.methods) == 1 and self.methods[0] != usual else {}
        given = {"session": SESSION_FILE, "steps": str(self.steps), **fixed}
        if self.has_motion:
            words = [
                f"{s.quantity.name} {s.low}" for s in self.spans if s.high is None and s.quantity.is_motion
            ]
            whose = f"handle {self.handle + 1}: " if self.handle else ""
            given |= {"motion": whose + "; ".join(words)} if whose or words else {}
        return given


def path_from_text(text: str) -> Path:
    """Absolute path from a field, where ~ is the folder of a user.

    That of a user who is not there stays as it is, instead of raising RuntimeError.
    """
    return Path(os.path.expanduser(text.strip())).absolute()  # noqa: PTH111


def write_study(folder: Path, rows: PlanRows, state: State, view: View) -> None:
    """Write plan and session of a new study.

    Parameters
    ----------
    folder : Path
        Made where it is not there.
    rows : tuple
        Columns and rows of the plan.
    state, view
        What is open; its mesh goes along.

    Raises
    ------
    InputError
        If they cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            tr("The folder {folder} cannot be made ({reason}); choose another location.").format(
                folder=folder, reason=error.strerror or error
            )
        ) from error
    save_session(folder / SESSION_FILE, state, view, embed=True)
    write_table(folder / PLAN_FILE, *rows)


def document_with_values(state: State, unit: Unit, handle: int, values: Mapping[str, str]) -> Document:
    """The document with its handles and settings at some values of quantities.

    Parameters
    ----------
    state : State
    unit : Unit
    handle : int
        That typed motions move.
    values : mapping of str to str
        Values by the names of quantities, as a plan has them.

    Raises
    ------
    InputError
        If there is no such value or no such motion.
    """
    settings = {
        name: SETTING_COLUMNS[name].parse(text) for name, text in values.items() if name in SETTING_COLUMNS
    }
    part = float(settings.pop(SHARE_COLUMN, 1.0))
    document = state.document.relative_to_rest.with_settings(**settings)
    words = [f"{name} {text}" for name, text in values.items() if name not in SETTING_COLUMNS]
    if words:
        steps = motion_steps(document, f"handle {handle + 1}: " + "; ".join(words), unit)
        return document_along(document, motion_paths(document, steps))
    paths = handle_paths(document)
    return document_along(document_at(document, paths, part), paths, part)
