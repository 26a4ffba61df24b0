"""Solver that answers the messages of another program, newest first.

A thread reads, so that a newer motion replaces one that has not begun, and iterations end for it. Shapes are
sent when they are asked for: a slow reader gets fewer of them, and none that are old.
"""

import inspect
import logging
import math
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import Any, BinaryIO

import numpy as np

from apd_viewer.commands.message_stream import Message, MessageError, read_message, write_message
from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import checked_floats, checked_integers
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.methods import DEFAULT_METHOD, METHODS, contact_by_default
from apd_viewer.geometry.solver.path_iteration import PathIteration, PathStop
from apd_viewer.geometry.warmup import report_compilations
from apd_viewer.installation import program_version
from apd_viewer.language import tr

PROTOCOL = 1
BEAT = 1.0  # seconds between reports of progress
# Of these only the newest is answered.
_REPLACED = ("move", "keep", "frame")
_MOST_WAITING = 16  # messages; further ones wait in the pipe
_NOT_IN_JSON = ("self", "V", "F", "fixed", "handle", "rest", "factored", "soft", "regions", "convergence")
# Arguments of a deformation that a message can give.
SETTINGS = tuple(
    name
    for name in inspect.signature(Deformation.__init__).parameters
    if name not in (*_NOT_IN_JSON, "obstacles")
)
_KEPT = ("area", "volume", "calm")
_READINGS = (
    *("iteration", "total", "area", "area_error", "volume", "volume_capped", "handle_drift", "energy"),
    *("local_change", "largest_edge_strain", "mean_edge_strain", "share_reached"),
    *("settled", "converged", "stable", "unreached"),
)

_log = logging.getLogger(__name__)


class SolverService:
    """Answers of a solver to the messages from ``source``, written to ``sink``.

    Parameters
    ----------
    source, sink : binary file
    on_source_end : callable
        Called on the reading thread when ``source`` has ended; may end the process.
    """

    def __init__(
        self, source: BinaryIO, sink: BinaryIO, on_source_end: Callable[[], object] = lambda: None
    ) -> None:
        self._source, self._sink, self._on_source_end = source, sink, on_source_end
        self._writing = threading.Lock()
        self._arrived = threading.Condition()
        self._messages: list[Message] = []
        self._has_ended = False
        self._solver: Deformation | None = None
        self._walk: PathIteration | None = None
        self._dtype = "<f8"
        self._most = self._count = 0
        self._motion: object = None
        self._asked: Message | None = None
        self._is_iterating = self._has_news = False
        self._ended, self._sent, self._compiled = threading.Event(), 0.0, 0.0
        self._stage: tuple[object, str] | None = None

    def run(self) -> None:
        """Answer until ``source`` ends; raises InputError after what is no message."""
        problems: list[str] = []
        for work, name in ((lambda: self._read(problems), "messages"), (self._report, "progress")):
            threading.Thread(target=work, name=name, daemon=True).start()
        stop_counting = report_compilations(self._count_compilation)
        try:
            while (messages := self._taken_messages()) is not None:
                for message in messages:
                    with self._told_errors(message.head.get("id")):
                        self._answer(message)
                with self._told_errors(self._motion, is_motion=True):
                    self._iterate()
                    self._take_frame_request()
                    self._send_frame()
            if problems:
                self._send({"op": "error", "id": None, "message": problems[0], "kind": "protocol"})
                raise InputError(problems[0])
        finally:
            stop_counting()
            self._ended.set()

    def _read(self, problems: list[str]) -> None:
        """Read messages until the end, on a thread of its own."""
        try:
            while (message := read_message(self._source)) is not None:
                with self._arrived:
                    self._arrived.wait_for(lambda: len(self._messages) < _MOST_WAITING)
                    op = message.head.get("op")
                    if op in _REPLACED:
                        self._messages = [each for each in self._messages if each.head.get("op") != op]
                    self._messages.append(message)
                    self._arrived.notify()
        except MessageError as error:
            problems.append(str(error))
        else:
            self._on_source_end()
        finally:
            with self._arrived:
                self._has_ended = True
                self._arrived.notify()

    def _taken_messages(self) -> list[Message] | None:
        """Messages that have arrived, once there is anything to do; None after the last."""
        with self._arrived:
            self._arrived.wait_for(lambda: self._messages or self._is_iterating or self._has_ended)
            if self._has_ended and not self._messages:
                return None
            taken, self._messages = self._messages, []
            self._arrived.notify()
        return taken

    def _take_frame_request(self) -> None:
        """Take a request that came during an iteration, before a new motion."""
        with self._arrived:
            for number, message in enumerate(self._messages if self._walk else ()):
                if (op := message.head.get("op")) == "frame":
                    self._ask_for_frame(self._messages.pop(number))
                    self._arrived.notify()
                    return
                if op not in _REPLACED:
                    return

    def _answer(self, message: Message) -> None:
        answers = {
            "hello": self._hello,
            "open": self._open,
            "move": self._move,
            "keep": self._keep,
            "frame": self._ask_for_frame,
            "cancel": self._cancel,
            "close": self._close,
        }
        op = message.head.get("op")
        if not isinstance(op, str) or op not in answers:
            raise InputError(tr("op must be one of {names}.").format(names=", ".join(answers)))
        answers[op](message)

    def _hello(self, message: Message) -> None:
        """Tell the versions; raises InputError for another protocol."""
        if message.head.get("protocol") != PROTOCOL:
            said = tr(
                "This apd-viewer {version} speaks protocol {own}; install one that fits the other program."
            )
            raise InputError(said.format(version=program_version(), own=PROTOCOL))
        told = {"protocol": PROTOCOL, "version": program_version(), "methods": list(METHODS)}
        self._send({"op": "hello", "id": message.head.get("id"), **told, "settings": list(SETTINGS)})

    def _open(self, message: Message) -> None:
        """Prepare a deformation of V and F with ``fixed`` vertices, and tell the progress."""
        self._forget()
        head, arrays = message
        settings = _checked_settings(head.get("settings", {}), SETTINGS)
        dtype = head.get("dtype", self._dtype)
        if dtype not in ("<f4", "<f8"):
            raise InputError(tr("dtype must be <f4 or <f8."))
        missing = [name for name in ("V", "F", "fixed", "handle") if name not in arrays]
        if missing:
            raise InputError(tr("The array {name} is missing.").format(name=missing[0]))
        fixed, number = (checked_integers(arrays[name], name) for name in ("fixed", "handle"))
        if fixed.ndim != 1 or number.shape != fixed.shape or not _are_consecutive(number):
            raise InputError(
                tr("handle must have a number for each of fixed: 0 for the base, 1 for the first handle, …")
            )
        handles = [fixed[number == each] for each in range(1, number.max(initial=0) + 1)]
        V, F = (np.array(arrays[name]) for name in ("V", "F"))
        method = settings.get("method", DEFAULT_METHOD)
        if settings.get("contact") is None:
            settings["contact"] = method in METHODS and contact_by_default(method, len(V))
        with self._work(head.get("id"), "opening"):
            solver = Deformation(V, F, fixed, handle=handles or None, **settings)
        self._solver, self._dtype = solver, dtype
        told = {"seconds": solver.factor_seconds, "area": solver.rest.area, "warnings": list(solver.warnings)}
        self._send({"op": "open", "id": head.get("id"), **told})

    def _move(self, message: Message) -> None:
        """Aim at ``targets`` (k, 3) of the fixed vertices, or at a path (s, k, 3) of them."""
        solver = self._opened()
        if "targets" not in message.arrays:
            raise InputError(tr("The array {name} is missing.").format(name="targets"))
        most = message.head.get("iterations", solver.convergence.most_iterations)
        if type(most) is not int or most < 1:
            raise InputError(tr("iterations must be a whole number of at least 1."))
        targets = checked_floats(message.arrays["targets"], tr("Targets"))
        path = targets if targets.ndim == 3 and len(targets) else targets[None]
        self._walk = PathIteration(solver, [PathStop(each) for each in path])
        self._motion = message.head.get("id")  # not that of targets that are refused
        self._begin(most)

    def _keep(self, message: Message) -> None:
        """Set new targets of area and volume, and go on to the last motion."""
        solver = self._opened()
        solver.keep(**_checked_settings(message.head.get("settings", {}), _KEPT))
        if self._walk is not None:
            self._motion = message.head.get("id")
            self._begin(self._most)

    def _ask_for_frame(self, message: Message) -> None:
        if self._walk is None:
            raise InputError(tr("Send “{op}” first.").format(op="move"))
        self._asked = message
        self._has_news = self._has_news or not self._is_iterating

    def _cancel(self, message: Message) -> None:
        """End the iterations; the shape stays as it is."""
        self._is_iterating, self._has_news = False, self._walk is not None
        self._send({"op": "cancel", "id": message.head.get("id")})

    def _close(self, message: Message) -> None:
        self._forget()
        self._send({"op": "close", "id": message.head.get("id")})

    def _opened(self) -> Deformation:
        if self._solver is None:
            raise InputError(tr("Send “{op}” first.").format(op="open"))
        return self._solver

    def _begin(self, most: int) -> None:
        self._most, self._count, self._is_iterating, self._has_news = most, 0, True, False

    def _forget(self) -> None:
        self._solver = self._walk = self._asked = None
        self._is_iterating = self._has_news = False

    def _iterate(self) -> None:
        walk, solver = self._walk, self._solver
        if not self._is_iterating or walk is None or solver is None:
            return
        had_arrived = walk.has_arrived
        with self._work(self._motion, "iterating"):
            walk.iterate()
        self._count += had_arrived
        self._has_news = True
        may_go_on = self._count < self._most and not solver.settled
        self._is_iterating = may_go_on or not walk.has_arrived

    def _send_frame(self) -> None:
        """Send the shape if it was asked for and is a new one, or the last."""
        if self._asked is None or self._walk is None or not self._has_news:
            return
        frame = self._walk.frame()
        told = {"op": "frame", "id": self._asked.head.get("id"), "motion": self._motion}
        with self._arrived:
            is_replaced = any(message.head.get("op") in ("move", "keep") for message in self._messages)
        told["finished"] = not (self._is_iterating or is_replaced)
        self._send(told | _readings(frame), {"U": frame.U.astype(self._dtype)})
        self._asked, self._has_news = None, False

    def _send(self, head: dict[str, Any], arrays: Mapping[str, np.ndarray] = {}) -> None:
        with self._writing:
            write_message(self._sink, head, arrays)
            self._sent = time.monotonic()

    @contextmanager
    def _told_errors(self, number: object, is_motion: bool = False) -> Iterator[None]:
        """Tell an error as the answer to message ``number``; that of a motion ends it."""
        try:
            yield
        except OSError:  # the other program has gone
            raise
        except (InputError, MemoryError) as error:
            sentence, kind = str(error) or tr("Not enough memory for this mesh."), "input"
        except Exception as error:
            _log.exception("The solver stopped")
            said = tr("The solver stopped ({said}); the log says more.")
            sentence, kind = said.format(said=str(error) or type(error).__name__), "internal"
            self._forget()
        else:
            return
        if is_motion:
            self._is_iterating, self._asked = False, None
        self._send({"op": "error", "id": number, "message": sentence, "kind": kind})

    # Progress, told by a thread of its own

    @contextmanager
    def _work(self, number: object, stage: str) -> Iterator[None]:
        """Tell every second that there is work on message ``number``."""
        self._sent, self._stage = max(self._sent, time.monotonic()), (number, stage)
        try:
            yield
        finally:
            self._stage = None

    def _report(self) -> None:
        while not self._ended.wait(BEAT / 4):
            stage = self._stage
            if stage is not None and time.monotonic() - self._sent >= BEAT:
                told = {"op": "progress", "id": stage[0], "stage": stage[1], "compiled": self._compiled}
                with suppress(OSError, ValueError):  # the other program has gone
                    self._send(told)

    def _count_compilation(self, fraction: float) -> None:
        self._compiled = fraction


def _checked_settings(given: object, names: tuple[str, ...]) -> dict[str, Any]:
    """Settings of a head; raises InputError for unknown ones."""
    if not isinstance(given, dict):
        raise InputError(tr("settings must be an object of names and values."))
    for name in given:
        if name not in names:
            raise InputError(
                tr("“{name}” is no setting; known are {names}.").format(name=name, names=", ".join(names))
            )
    return dict(given)


def _are_consecutive(numbers: np.ndarray) -> bool:
    """True for 0, where it occurs, and each number from 1 to the largest."""
    found = np.unique(numbers[numbers != 0])
    return np.array_equal(found, np.arange(1, len(found) + 1))


def _readings(frame: Frame) -> dict[str, Any]:
    """Readings of a frame for JSON, null where a number is not finite."""
    told = {name: getattr(frame, name) for name in _READINGS}
    plain = {name: value.item() if isinstance(value, np.generic) else value for name, value in told.items()}
    return {
        name: None if isinstance(value, float) and not math.isfinite(value) else value
        for name, value in plain.items()
    }
