"""Acquire loads and release stores of counters shared by processes."""

from typing import Any

from numba import types
from numba.extending import intrinsic

from apd_viewer.geometry.linalg.kernels import njit


@intrinsic
def _load(_: Any, _address: Any) -> Any:
    def code(context: Any, builder: Any, _: Any, arguments: Any) -> Any:
        place = builder.inttoptr(arguments[0], context.get_value_type(types.int64).as_pointer())
        return builder.load_atomic(place, "acquire", 8)

    return types.int64(types.int64), code


@intrinsic
def _store(_: Any, _address: Any, _value: Any) -> Any:
    def code(context: Any, builder: Any, _: Any, arguments: Any) -> Any:
        place = builder.inttoptr(arguments[0], context.get_value_type(types.int64).as_pointer())
        builder.store_atomic(arguments[1], place, "release", 8)
        return context.get_dummy_value()

    return types.void(types.int64, types.int64), code


@njit(cache=True)
def load_acquire(address: int) -> int:
    """Load the int64 at an address with acquire ordering."""
    return _load(address)


@njit(cache=True)
def store_release(address: int, value: int) -> None:
    """Store an int64 at an address with release ordering."""
    _store(address, value)
