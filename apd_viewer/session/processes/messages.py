"""Messages between the window's process and the solver's."""

from __future__ import annotations

import io
import pickle
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from logging import LogRecord
from typing import BinaryIO, NamedTuple

from apd_viewer.geometry.mesh.decimation import Decimation
from apd_viewer.session.model.document import Document
from apd_viewer.session.processes.request_and_reply import Reply, Request


@dataclass(frozen=True, eq=False)
class RequestMessage:
    """A request on its way to the solver process.

    Attributes
    ----------
    number : int
        Later orders have higher ones.
    shape_buffer : str or None
        Name of the tray for the shapes; without one they travel in the messages.
    decimations : tuple of Decimation
        Of the mesh, where they are known and the process has not found them itself.
    """

    number: int
    request: Request
    shape_buffer: str | None
    decimations: tuple[Decimation, ...] = ()


class RequestStage(Enum):
    """Progress of an order."""

    RECEIVED = "received"
    TURNED_TO = "turned to"  # all earlier orders are answered or dropped
    UNDER_WAY = "under way"  # said every second in which something is done for it
    ANSWERED = "answered"  # or dropped; nothing more is said of it


@dataclass(frozen=True)
class CompilationProgress:
    """Kernels are being compiled for this computer; the ``share`` done, 1 in the end."""

    share: float


class SolverMessage(NamedTuple):
    """Progress of an order, the thinnings of its mesh once found, or a reply to it.

    Compiling belongs to no order: its number is 0.

    Attributes
    ----------
    number : int
        Of the order.
    content : RequestStage, tuple of Decimation, CompilationProgress or Reply
    shape_number : int or None
        Number of the reply's shape in the tray, where it lies there instead of in the frame.
    """

    number: int
    content: RequestStage | tuple[Decimation, ...] | CompilationProgress | Reply
    shape_number: int | None = None


def packed_message(message: SolverMessage | LogRecord) -> bytes:
    """Pickle a message; a reply's document is replaced by its order's number."""
    buffer = io.BytesIO()
    _Pickler(buffer, message.number if isinstance(message, SolverMessage) else None).dump(message)
    return buffer.getvalue()


def unpacked_message(content: bytes, requests: Mapping[int, Request]) -> SolverMessage | LogRecord:
    """Restore a message, given the requests by the numbers of their orders."""
    message: SolverMessage | LogRecord = _Unpickler(io.BytesIO(content), requests).load()
    return message


class _Pickler(pickle.Pickler):
    def __init__(self, sink: BinaryIO, number: int | None) -> None:
        super().__init__(sink, pickle.HIGHEST_PROTOCOL)
        self._number = number

    def persistent_id(self, thing: object) -> int | None:
        return self._number if isinstance(thing, Document) else None


class _Unpickler(pickle.Unpickler):
    def __init__(self, source: BinaryIO, requests: Mapping[int, Request]) -> None:
        super().__init__(source)
        self._requests = requests

    def persistent_load(self, number: int) -> Document:
        return self._requests[number].document
