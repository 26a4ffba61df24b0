"""Look for somebody at the address of a scheduler, before a study is begun by it."""

from __future__ import annotations

import json
from pathlib import Path
from urllib.parse import urlsplit

from PySide6.QtCore import QObject, QTimer, Signal
from PySide6.QtNetwork import QAbstractSocket, QNetworkProxy, QTcpSocket

from apd_viewer.errors import InputError
from apd_viewer.files.storage.regular_files import read_content
from apd_viewer.language import tr
from apd_viewer.ui.case_studies.study_files import path_from_text

SCHEDULER_FILE_SUFFIX = ".json"
_PATIENCE = 5000  # ms
_BY_TCP = ("tcp", "tls", "ws", "wss")


class SchedulerCheck(QObject):
    """Connects to an address, without waiting, and hangs up.

    Attributes
    ----------
    answered : Signal()
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
        # As Dask does: a proxy of the system is for the web.
        self._socket.setProxy(QNetworkProxy(QNetworkProxy.ProxyType.NoProxy))
        self._socket.connected.connect(self._answer)
        self._socket.errorOccurred.connect(lambda _: self._fail(self._socket.errorString()))
        self.timer = QTimer(self, singleShot=True, interval=_PATIENCE)
        self.timer.timeout.connect(lambda: self._fail(tr("no answer within 5 seconds")))

    @property
    def is_waiting(self) -> bool:
        """True while nobody has answered yet."""
        return self.timer.isActive()

    def begin(self, address: str) -> None:
        """Connect to an address, or to that in a file; raises InputError if it is none."""
        host, port = host_and_port(address)
        self.stop()
        self._address = address
        self.timer.start()
        self._socket.connectToHost(host, port)

    def stop(self) -> None:
        """Hang up, and say nothing."""
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
            tr("Nobody answers at {address} ({reason}); start the scheduler, or check the address.").format(
                address=self._address, reason=reason
            )
        )


def host_and_port(address: str) -> tuple[str, int]:
    """Host and port of an address such as tcp://host:8786, or of that in a file.

    Raises
    ------
    InputError
        If it is no address, or there is no such file.
    """
    try:
        said = _in_file(path_from_text(address)) if address.endswith(SCHEDULER_FILE_SUFFIX) else address
        parts = urlsplit(said if "://" in said else f"tcp://{said}")
        if parts.scheme not in _BY_TCP or not parts.hostname or not parts.port:
            raise ValueError
        return parts.hostname, parts.port
    except InputError:
        raise
    except ValueError:
        raise InputError(
            tr("“{address}” is no address of a scheduler; enter one such as tcp://host:8786.").format(
                address=address
            )
        ) from None


def _in_file(path: Path) -> str:
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
