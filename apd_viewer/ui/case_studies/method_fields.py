"""Fields for the methods of a study."""

from __future__ import annotations

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QHBoxLayout

from apd_viewer.errors import InputError
from apd_viewer.geometry.solver.methods import METHODS
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.ui.studies.run_dialog import widget_row
from apd_viewer.ui.widgets.fields import CheckBox


class MethodFields(QObject):
    """A box for each method; that of the document is ticked.

    Parameters
    ----------
    document : Document

    Attributes
    ----------
    changed : Signal()
    checks : dict of str to CheckBox
        By the names of methods.
    layout_ : QHBoxLayout
        The row of the boxes.
    """

    changed = Signal()

    def __init__(self, document: Document) -> None:
        super().__init__()
        self.checks = {name: CheckBox(method.short_title) for name, method in METHODS.items()}
        for name, check in self.checks.items():
            method = METHODS[name]
            slow = tr("Takes several times as long as the others")
            check.setToolTip(f"{method.description}\n{slow}" if method.is_slow else method.description)
            # Obstacles push by contact only.
            check.setEnabled(method.may_use_contact or not document.has_active_obstacles)
            check.setChecked(name == document.settings.method)
            check.toggled.connect(self.changed)
        self.layout_: QHBoxLayout = widget_row(*self.checks.values())

    @property
    def chosen_count(self) -> int:
        """Number of ticked methods."""
        return sum(check.isChecked() for check in self.checks.values())

    def chosen_methods(self) -> tuple[str, ...]:
        """Names of the ticked methods; raises InputError if there is none."""
        found = tuple(name for name, check in self.checks.items() if check.isChecked())
        if not found:
            raise InputError(tr("No method is ticked; tick one, or several to compare them."))
        return found
