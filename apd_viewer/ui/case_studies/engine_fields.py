"""Fields for where the cases of a study run."""

from __future__ import annotations

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QHBoxLayout, QLabel

from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.studies.local_pool import cores
from apd_viewer.ui.studies.study_dialog import count_field, row_of
from apd_viewer.ui.widgets.fields import Choice, Entry

_HERE, _SCHEDULER = "here", "scheduler"
_MOST = 1000
_FILE = ".json"


class EngineFields(QObject):
    """Processes of this machine, or workers behind a scheduler.

    Attributes
    ----------
    layout_ : QHBoxLayout
        The row of the fields.
    """

    def __init__(self) -> None:
        super().__init__()
        self.where = Choice(accessibleName=tr("Where the cases run"))
        self.where.addItem(tr("on this machine"), _HERE)
        self.where.addItem(tr("on a cluster (Dask)"), _SCHEDULER)
        self.processes = count_field(tr("Cases at a time"), 1, _MOST, min(_MOST, cores()))
        self._at_a_time = QLabel(tr("cases at a time"))
        self.address = Entry(
            toolTip=tr("Address of the scheduler, or the file that it has written (scheduler.json)"),
            placeholderText="tcp://host:8786",
        )
        self.address.setAccessibleName(tr("Address of the scheduler"))
        self.address.setMinimumWidth(220)
        self.where.currentIndexChanged.connect(self._show_fields)
        self.layout_: QHBoxLayout = row_of(
            self.where, self.processes, self._at_a_time, self.address, spacing=8
        )
        self.address.hide()

    def _show_fields(self) -> None:
        here = self.where.currentData() == _HERE
        for field in (self.processes, self._at_a_time):
            field.setVisible(here)
        self.address.setVisible(not here)

    def options(self) -> list[str]:
        """Options of the command; raises InputError without an address."""
        if self.where.currentData() == _HERE:
            return ["--processes", str(round(self.processes.value()))]
        address = self.address.text().strip()
        if not address:
            raise InputError(tr("Enter the address of the scheduler, such as tcp://host:8786."))
        return ["--scheduler-file" if address.endswith(_FILE) else "--scheduler", address]
