"""Compile the kernels before they are needed.

Numba compiles a kernel when it is first called with arrays of some types. ``kernels.txt`` has a row for each
kernel that is called, and for each types of its arguments, in the order in which a window needs them.
"""

from __future__ import annotations

import importlib
import re
import sys
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any

from numba import types
from numba.core import event

# Sections of the table that a first drag needs, and other processes can compile beside the window.
PARTS = ("drag", "contact", "factor")
_TABLE = Path(__file__).with_name("kernels.txt")
_PACKAGE = __name__.rpartition(".")[0]
_ROW = re.compile(r"([\w.]+)\.(\w+)\((.*)\)")


def warm_up(*sections: str, enough: Callable[[], bool] = lambda: False) -> None:
    """Compile the kernels of some sections of the table, of all if none is named.

    All take about 100 s, or 0.5 s from the cache. Between two of them ``enough()`` may end it.
    """
    for section in sections or kernel_table():
        for row in kernel_table()[section]:
            if enough():
                return
            kernel, arguments = _read(row)
            kernel.compile(arguments)


def tell_of_compiling(tell: Callable[[float], object]) -> Callable[[], object]:
    """Call ``tell(share)`` at the end of each compilation, until the result is called.

    The ``share`` is the part of the table compiled so far in this process, or loaded.
    """
    ends = _Ends(lambda: tell(_share_ready()))
    event.register("numba:compile", ends)
    return partial(event.unregister, "numba:compile", ends)


@cache
def kernel_table() -> dict[str, list[str]]:
    """Rows of each section."""
    found: dict[str, list[str]] = {}
    for line in _TABLE.read_text(encoding="utf-8").splitlines():
        if line.startswith("["):
            rows = found.setdefault(line.strip("[]"), [])
        elif line and not line.startswith("#"):
            rows.append(line)
    return found


@cache
def _read(row: str) -> tuple[Any, tuple[types.Type, ...]]:
    """Kernel of a row, and the types of its arguments."""
    found = _ROW.fullmatch(row)
    assert found is not None, row
    kernel = getattr(importlib.import_module(f"{_PACKAGE}.{found[1]}"), found[2])
    arguments = eval(f"({found[3]},)", {**vars(types), "const": _const})
    return getattr(kernel, "dispatcher", kernel), arguments


def _const(array: types.Array) -> types.Array:
    """Type of an array that may not be written to."""
    return array.copy(readonly=True)


def _share_ready() -> float:
    rows = [row for rows in kernel_table().values() for row in rows]
    return sum(map(_is_ready, rows)) / len(rows)


def _is_ready(row: str) -> bool:
    """True if the kernel of a row is compiled; imports nothing, as another thread may be importing it."""
    module, _, _ = row.partition("(")[0].rpartition(".")
    if f"{_PACKAGE}.{module}" not in sys.modules:
        return False
    kernel, arguments = _read(row)
    return arguments in kernel.overloads


class _Ends(event.Listener):
    """Calls back at the end of each compilation."""

    def __init__(self, call: Callable[[], object]) -> None:
        self._call = call

    def on_start(self, _: event.Event) -> None:
        """Wait for the end."""

    def on_end(self, _: event.Event) -> None:
        """Tell of a kernel."""
        self._call()
