"""Rows of the table of kernels."""

from numba import types
from numba.np.numpy_support import as_dtype

from apd_viewer import geometry

AXES = {"C": (":", "::1", -1), "F": (":", "::1", 0), "A": (":", ":", 0)}


def row(function, arguments):
    """Row for a kernel's function and the types of its arguments."""
    module = function.__module__.removeprefix(f"{geometry.__name__}.")
    return f"{module}.{function.__qualname__}({', '.join(map(spelled, arguments))})"


def spelled(kind):
    if isinstance(kind, types.Array):
        plain, marked, at = AXES[kind.layout]
        axes = [plain] * kind.ndim
        axes[at] = marked
        array = f"{spelled(kind.dtype)}[{','.join(axes)}]"
        return array if kind.mutable else f"const({array})"
    if isinstance(kind, types.BaseTuple):
        return f"Tuple(({', '.join(map(spelled, kind))},))"
    return as_dtype(kind).str[1:]
