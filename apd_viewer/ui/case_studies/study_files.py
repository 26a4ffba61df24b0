"""Plan and session of a new study, and the document at the ends of its ranges."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from apd_viewer.errors import InputError
from apd_viewer.files.tables import write_table
from apd_viewer.language import tr
from apd_viewer.session.model.handle_paths import document_at, paths_of
from apd_viewer.session.posing.motion_path import motion_paths, posed_along
from apd_viewer.session.posing.motion_step import motion_of
from apd_viewer.session.posing.motion_text import parsed_motion
from apd_viewer.session.posing.typed_motion import names_of
from apd_viewer.session.storage.session_file import save_session
from apd_viewer.studies.plans.design import Varied, designed
from apd_viewer.studies.plans.plan_columns import SETTINGS
from apd_viewer.ui.case_studies.quantities import TO

if TYPE_CHECKING:
    from collections.abc import Mapping

    from apd_viewer.session.model.document import Document
    from apd_viewer.session.model.state import State
    from apd_viewer.session.model.view import View
    from apd_viewer.session.quantities.units import Unit
    from apd_viewer.ui.case_studies.quantities import Span

PLAN, SESSION = "plan.csv", "session.apd"
Rows = tuple[list[str], list[list[str]]]


class Design(NamedTuple):
    """Choice of the cases within the ranges.

    Attributes
    ----------
    spans : tuple of Span
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

    spans: tuple[Span, ...]
    methods: tuple[str, ...]
    method: str
    samples: int
    steps: int
    handle: int

    @property
    def moves(self) -> bool:
        """True if a motion is typed, instead of that of the session."""
        return any(span.quantity.is_motion for span in self.spans)

    def rows(self, usual: str) -> Rows:
        """Columns and rows of the plan, each row once.

        Parameters
        ----------
        usual : str
            Method of the session, for which no column is needed.

        Raises
        ------
        InputError
            If nothing varies.
        """
        vary = [span.varied for span in self.spans if span.high is not None]
        vary += [Varied("method", self.methods)] if len(self.methods) > 1 else []
        if not vary:
            raise InputError(tr("Nothing varies; give both ends of a range, or tick several methods."))
        columns, rows = designed(self._given(usual), vary, self.method, self.samples, 0)
        # With choices alone there are fewer different cases than samples.
        return columns, [list(row) for row in dict.fromkeys(map(tuple, rows))]

    def _given(self, usual: str) -> dict[str, str]:
        """Cells common to all rows, by column."""
        fixed = {s.quantity.name: s.low for s in self.spans if s.high is None and not s.quantity.is_motion}
        fixed |= {"method": self.methods[0]} if len(self.methods) == 1 and self.methods[0] != usual else {}
        given = {"session": SESSION, "steps": str(self.steps), **fixed}
        if self.moves:
            words = [
                f"{s.quantity.name} {s.low}" for s in self.spans if s.high is None and s.quantity.is_motion
            ]
            whose = f"handle {self.handle + 1}: " if self.handle else ""
            given |= {"motion": whose + "; ".join(words)} if whose or words else {}
        return given


def typed_path(text: str) -> Path:
    """Absolute path from a field, where ~ is the folder of a user.

    That of a user who is not there stays as it is, instead of raising RuntimeError.
    """
    return Path(os.path.expanduser(text.strip())).absolute()  # noqa: PTH111


def write_study(folder: Path, rows: Rows, state: State, view: View) -> None:
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
    save_session(folder / SESSION, state, view, embed=True)
    write_table(folder / PLAN, *rows)


def document_of(state: State, unit: Unit, handle: int, said: Mapping[str, str]) -> Document:
    """The document with its handles and settings at some values of quantities.

    Parameters
    ----------
    state : State
    unit : Unit
    handle : int
        That typed motions move.
    said : mapping of str to str
        Values by the names of quantities, as a plan has them.

    Raises
    ------
    InputError
        If there is no such value or no such motion.
    """
    settings = {name: SETTINGS[name].read(text) for name, text in said.items() if name in SETTINGS}
    part = float(settings.pop(TO, 1.0))
    document = replace(state.document.from_rest, **settings)  # type: ignore[arg-type]
    words = [f"{name} {text}" for name, text in said.items() if name not in SETTINGS]
    if words:
        typed = parsed_motion(f"handle {handle + 1}: " + "; ".join(words))
        steps = motion_of(document, typed, names_of(state), unit)
        return posed_along(document, motion_paths(document, steps))
    paths = paths_of(document)
    return posed_along(document_at(document, paths, part), paths, part)
