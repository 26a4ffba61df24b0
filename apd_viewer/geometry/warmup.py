"""Compilation of the kernels before they are needed.

Numba compiles a kernel when it is first called with arrays of some types. ``kernels.txt`` has a row for each
kernel that is called, and for each types of its arguments, in the order in which a window needs them.
"""

import re
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any

from numba import types
from numba.core import event

from apd_viewer.geometry.analysis import area_change, defects, deviation, double_wall
from apd_viewer.geometry.linalg import atomic_access
from apd_viewer.geometry.linalg.kernels import KERNELS
from apd_viewer.geometry.measuring import sections
from apd_viewer.geometry.mesh import operators
from apd_viewer.geometry.picking import surface_index, vertex_sets
from apd_viewer.geometry.solver import deformation

# Importing these modules imports all modules with kernels.
_IMPORTERS = (
    *(area_change, atomic_access, defects, deformation, deviation, double_wall),
    *(operators, sections, surface_index, vertex_sets),
)
# Table sections needed by a first drag, suitable for compilation in other processes.
SECTIONS = ("drag", "contact", "factor")
_TABLE = Path(__file__).with_name("kernels.txt")
_ROOM = __name__.rpartition(".")[0]
_ROW = re.compile(r"([\w.]+)\((.*)\)")


def warm_up(*names: str, is_cancelled: Callable[[], bool] = lambda: False) -> None:
    """Compile the kernels of the named sections of the table, or of all.

    All take about two minutes, or 1.5 s from the cache. Between two of them ``is_cancelled()`` may end it.
    """
    for section in names or kernel_table():
        for row in kernel_table()[section]:
            if is_cancelled():
                return
            kernel, arguments = kernel_of(row)
            kernel.compile(arguments)


def report_compilations(on_progress: Callable[[float], object]) -> Callable[[], object]:
    """Call ``on_progress(fraction)`` per compilation, until the result is called.

    The ``fraction`` is the part of the table compiled so far in this process, or loaded.
    """
    ends = _EndListener(lambda: on_progress(_compiled_fraction()))
    event.register("numba:compile", ends)
    return partial(event.unregister, "numba:compile", ends)


@cache
def kernel_table() -> dict[str, list[str]]:
    """Signatures of the kernels to compile in advance, by section of kernels.txt."""
    found: dict[str, list[str]] = {}
    for line in _TABLE.read_text(encoding="utf-8").splitlines():
        if line.startswith("["):
            rows = found.setdefault(line.strip("[]"), [])
        elif line and not line.startswith("#"):
            rows.append(line)
    return found


@cache
def kernel_of(row: str) -> tuple[Any, tuple[types.Type, ...]]:
    """Kernel named by a table row, and its argument types."""
    found = _ROW.fullmatch(row)
    assert found is not None, row
    return KERNELS[f"{_ROOM}.{found[1]}"], eval(f"({found[2]},)", {**vars(types), "const": _const})


def _const(array: types.Array) -> types.Array:
    """Read-only version of an array type."""
    return array.copy(readonly=True)


def _compiled_fraction() -> float:
    read = [kernel_of(row) for rows in kernel_table().values() for row in rows]
    return sum(arguments in kernel.overloads for kernel, arguments in read) / len(read)


class _EndListener(event.Listener):
    """Listener with a callback for the end of each compilation."""

    def __init__(self, call: Callable[[], object]) -> None:
        self._call = call

    def on_start(self, _: event.Event) -> None:
        """Do nothing; only the end of a compilation is reported."""

    def on_end(self, _: event.Event) -> None:
        """Report the end of a compilation."""
        self._call()
