"""Fields for the engine of a study and the time limit of its cases."""

import json
from pathlib import Path
from urllib.parse import urlsplit

from PySide6.QtCore import QObject, QTimer, Signal
from PySide6.QtNetwork import QAbstractSocket, QNetworkProxy, QTcpSocket
from PySide6.QtWidgets import QHBoxLayout, QLabel

from apd_viewer.cases.local_pool import core_count
from apd_viewer.errors import InputError
from apd_viewer.files.storage.regular_files import read_content
from apd_viewer.language import tr
from apd_viewer.session.quantities.expressions import parse_number
from apd_viewer.ui.studies.run_dialog import count_field
from apd_viewer.ui.studies.study_run import path_from_text
from apd_viewer.ui.widgets.box_layouts import STRETCH, row_layout
from apd_viewer.ui.widgets.fields import ComboBox, TextField

_HERE, _SCHEDULER = "here", "scheduler"
_MOST = 1000


class EngineFields(QObject):
    """Fields to choose local processes or the workers of a scheduler.

    Attributes
    ----------
    layout_, limit_layout : QHBoxLayout
        The rows of the fields.
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
            toolTip=tr("Address of the scheduler, or its scheduler file (scheduler.json)"),
            placeholderText="tcp://host:8786",
        )
        self.address.setAccessibleName(tr("Address of the scheduler"))
        self.address.setMinimumWidth(220)
        self.where.currentIndexChanged.connect(self._show_fields)
        self.layout_: QHBoxLayout = row_layout(
            self.where, self.processes, self._at_a_time, self.address, STRETCH
        )
        self.address.hide()
        self.limit_layout = self._make_limit()
        self.check = SchedulerCheck()
        self.check.answered.connect(self.engine_ready)

    def _make_limit(self) -> QHBoxLayout:
        tip = tr("A case that takes longer fails, and the others continue")
        self.limit = TextField(placeholderText=tr("no limit"), toolTip=tip, maximumWidth=104)
        self.limit.setAccessibleName(tr("Time limit of a case in seconds"))
        return row_layout(self.limit, QLabel(tr("seconds per case")), STRETCH)

    def _show_fields(self) -> None:
        here = self.where.currentData() == _HERE
        for field in (self.processes, self._at_a_time):
            field.setVisible(here)
        self.address.setVisible(not here)

    @property
    def local_processes(self) -> float:
        """Number of local processes; 0 for the workers of a scheduler."""
        return self.processes.value() if self.where.currentData() == _HERE else 0.0

    def options(self) -> list[str]:
        """Options of the command; raises InputError on a missing address or bad limit."""
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
        """Emit ``engine_ready`` at once, or once the scheduler answers.

        Raises
        ------
        InputError
            If its address is none.
        """
        if self.where.currentData() == _HERE:
            self.engine_ready.emit()
        else:
            self.check.begin(self.address.text().strip())


SCHEDULER_FILE_SUFFIX = ".json"
_PATIENCE = 5000  # ms to wait for an answer of the scheduler
_BY_TCP = ("tcp", "tls", "ws", "wss")


class SchedulerCheck(QObject):
    """Tests an address by an asynchronous connection.

    Attributes
    ----------
    failed : Signal(str)
        A sentence.
    timer : QTimer
        Gives an address up that is silent.
    """

    answered = Signal()
    failed = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self._address = ""
        self._socket = QTcpSocket(self)
        # Connect directly, as Dask does; a system proxy is meant for web traffic.
        self._socket.setProxy(QNetworkProxy(QNetworkProxy.ProxyType.NoProxy))
        self._socket.connected.connect(self._answer)
        self._socket.errorOccurred.connect(lambda _: self._fail(self._socket.errorString()))
        self.timer = QTimer(self, singleShot=True, interval=_PATIENCE)
        self.timer.timeout.connect(lambda: self._fail(tr("no answer within 5 seconds")))

    @property
    def is_waiting(self) -> bool:
        """True while the connection is pending."""
        return self.timer.isActive()

    def begin(self, address: str) -> None:
        """Connect to an address, or to one read from a file; raises InputError."""
        host, port = host_and_port(address)
        self.stop()
        self._address = address
        self.timer.start()
        self._socket.connectToHost(host, port)

    def stop(self) -> None:
        """Abort the connection without emitting a signal."""
        self.timer.stop()
        if self._socket.state() is not QAbstractSocket.SocketState.UnconnectedState:
            self._socket.abort()

    def _answer(self) -> None:
        self.stop()
        self.answered.emit()

    def _fail(self, reason: str) -> None:
        if not self.is_waiting:
            return
        self.stop()
        self.failed.emit(
            tr("No scheduler answers at {address} ({reason}); start it, or check the address.").format(
                address=self._address, reason=reason
            )
        )


def host_and_port(address: str) -> tuple[str, int]:
    """Host and port of an address such as tcp://host:8786, or of one in a file.

    Raises
    ------
    InputError
        If it is no address, or there is no such file.
    """
    try:
        said = (
            _scheduler_address(path_from_text(address))
            if address.endswith(SCHEDULER_FILE_SUFFIX)
            else address
        )
        parts = urlsplit(said if "://" in said else f"tcp://{said}")
        if parts.scheme not in _BY_TCP or not parts.hostname or not parts.port:
            raise ValueError
        return parts.hostname, parts.port
    except InputError:
        raise
    except ValueError:
        raise InputError(
            tr("“{address}” is not a scheduler address; enter one such as tcp://host:8786.").format(
                address=address
            )
        ) from None


def _scheduler_address(path: Path) -> str:
    """Address in the file of a scheduler.

    Raises
    ------
    InputError
        If there is no such file.
    ValueError
        If there is no address in it.
    """
    try:
        return str(json.loads(read_content(path))["address"])
    except (KeyError, TypeError) as error:
        raise ValueError from error
