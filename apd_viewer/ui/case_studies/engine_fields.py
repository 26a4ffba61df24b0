"""Fields for where the cases of a study run, and how long one may take."""

from __future__ import annotations

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel

from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.session.quantities.expressions import parse_number
from apd_viewer.studies.local_pool import core_count
from apd_viewer.ui.case_studies.scheduler_check import SCHEDULER_FILE_SUFFIX, SchedulerCheck
from apd_viewer.ui.case_studies.study_files import path_from_text
from apd_viewer.ui.studies.run_dialog import count_field, widget_row
from apd_viewer.ui.widgets.fields import ComboBox, TextField

_HERE, _SCHEDULER = "here", "scheduler"
_MOST = 1000


class EngineFields(QObject):
    """Processes of this machine, or workers behind a scheduler.

    Attributes
    ----------
    layout_, limit_layout : QHBoxLayout
        The rows of the fields.
    check : SchedulerCheck
    engine_ready : Signal()
        There is somebody to run the cases.
    """

    engine_ready = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.where = ComboBox(accessibleName=tr("Where the cases run"))
        self.where.addItem(tr("on this machine"), _HERE)
        self.where.addItem(tr("on a cluster (Dask)"), _SCHEDULER)
        self.processes = count_field(tr("Cases at a time"), 1, _MOST, min(_MOST, core_count()))
        self._at_a_time = QLabel(tr("cases at a time"))
        self.address = TextField(
            toolTip=tr("Address of the scheduler, or the file that it has written (scheduler.json)"),
            placeholderText="tcp://host:8786",
        )
        self.address.setAccessibleName(tr("Address of the scheduler"))
        self.address.setMinimumWidth(220)
        self.where.currentIndexChanged.connect(self._show_fields)
        self.layout_: QHBoxLayout = widget_row(
            self.where, self.processes, self._at_a_time, self.address, spacing=8
        )
        self.address.hide()
        self.limit_layout = self._make_limit()
        self.check = SchedulerCheck()
        self.check.answered.connect(self.engine_ready)

    def _make_limit(self) -> QHBoxLayout:
        tip = tr("A case that takes longer has failed, and the others go on")
        self.limit = TextField(placeholderText=tr("no limit"), toolTip=tip, maximumWidth=104)
        self.limit.setAccessibleName(tr("Seconds that a case may take"))
        return widget_row(self.limit, QLabel(tr("seconds a case")), spacing=8)

    def _show_fields(self) -> None:
        here = self.where.currentData() == _HERE
        for field in (self.processes, self._at_a_time):
            field.setVisible(here)
        self.address.setVisible(not here)

    def options(self) -> list[str]:
        """Options of the command; raises InputError for no address or an odd limit."""
        if self.where.currentData() == _HERE:
            return ["--processes", str(round(self.processes.value())), *self._limit()]
        address = self.address.text().strip()
        if not address:
            raise InputError(tr("Enter the address of the scheduler, such as tcp://host:8786."))
        if address.endswith(SCHEDULER_FILE_SUFFIX):
            return ["--scheduler-file", str(path_from_text(address)), *self._limit()]
        return ["--scheduler", address, *self._limit()]

    def _limit(self) -> list[str]:
        text = self.limit.text().strip()
        if not text:
            return []
        seconds = parse_number(text, {})
        if not seconds > 0.0:
            raise InputError(tr("The limit of a case must be greater than 0 seconds."))
        return ["--limit", f"{seconds:.6g}"]

    def check_engine(self) -> None:
        """Announce that the cases can be run, at once or as soon as the scheduler answers.

        Raises
        ------
        InputError
            If its address is none.
        """
        if self.where.currentData() == _HERE:
            self.engine_ready.emit()
        else:
            self.check.begin(self.address.text().strip())
