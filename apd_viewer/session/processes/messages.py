"""What worker and solver process tell each other."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from logging import LogRecord
from typing import TypeAlias

from apd_viewer.geometry.mesh.decimation import Thinning
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.session.processes.requests import Account, Request


@dataclass(frozen=True, eq=False)
class Order:
    """A request on its way to the solver process.

    Attributes
    ----------
    number : int
        Later orders have higher ones.
    tray : str or None
        Name of the tray to put shapes into; without one they travel in the answers.
    thinnings : tuple of Thinning
        Of the mesh, as far as they are known and not found by the process itself.
    """

    number: int
    request: Request
    tray: str | None
    thinnings: tuple[Thinning, ...] = ()


class Step(Enum):
    """How far an order has come."""

    RECEIVED = "received"
    TURNED_TO = "turned to"  # whatever was ordered before is answered or dropped


@dataclass(frozen=True, eq=False)
class Progress:
    """An order has come a step further."""

    number: int
    step: Step


@dataclass(frozen=True, eq=False)
class Found:
    """The thinnings of the mesh of an order, which another process would take long to find."""

    number: int
    thinnings: tuple[Thinning, ...]


@dataclass(frozen=True, eq=False)
class Answer:
    """What came of an order.

    Attributes
    ----------
    frame : Frame or None
        Without its shape, if that lies in the tray.
    put : int or None
        The number under which it lies there.
    finished, seconds, failure, warning, account
        See :class:`apd_viewer.session.processes.requests.Reply`.
    """

    number: int
    frame: Frame | None
    put: int | None = None
    finished: bool = True
    seconds: float = 0.0
    failure: str | None = None
    warning: str | None = None
    account: Account | None = None


Message: TypeAlias = Progress | Found | Answer | LogRecord
