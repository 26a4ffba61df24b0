"""Signals during a kernel or its compilation: handlers run at its end.

Handlers run as soon as any Python does, in the main thread. Numba is not made for what they raise, such as
KeyboardInterrupt:

* it asks a Python function for the class of every array that a kernel returns, and goes on without it. The
  exception became a SystemError, was lost, or ended the process;
* broken off while it compiles, it is lost in a callback of LLVM, or nothing can be compiled any more.
"""

import functools
from typing import Any

from numba.core import types
from numba.core.boxing import box_array
from numba.core.dispatcher import Dispatcher
from numba.core.pythonapi import _boxers

from apd_viewer.geometry.signals.deferred_signals import DEFERRED_SIGNALS


def _box_with_class(kind: Any, value: Any, compiler: Any) -> Any:
    """Numba's boxing, with the class among the constants of the kernel."""
    constants = compiler.env_manager
    array_class = constants.read_const(constants.add_const(kind.box_type))
    compiler.pyapi.unserialize = lambda _: array_class
    try:
        return box_array(kind, value, compiler)
    finally:
        del compiler.pyapi.unserialize


def _with_deferred_signals(compile_: Any) -> Any:
    @functools.wraps(compile_)
    def compiled(*args: Any) -> Any:
        with DEFERRED_SIGNALS:
            return compile_(*args)

    return compiled


_boxers.functions[types.Array] = _box_with_class
Dispatcher.compile = _with_deferred_signals(Dispatcher.compile)  # type: ignore[method-assign]
