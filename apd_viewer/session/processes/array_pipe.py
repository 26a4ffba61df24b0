"""Messages between processes, preserving the identity of arrays and meshes.

The solver reuses results for identical meshes and arrays. Each of them is therefore sent once, with a number,
and referred to by that number afterwards, until a message without it.
"""

import io
import itertools
import pickle
import struct
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.weld import Weld
from apd_viewer.session.processes.shared_memory import SharedArrays, SharedArraysReader

# Bytes; smaller arrays are sent in the message itself.
LEAST_SHARED_BYTES = 16_384
_LENGTH = struct.Struct("<Q")


def write_message(sink: BinaryIO, message: bytes | np.ndarray) -> None:
    """Write a message; raises OSError or ValueError if the other end is closed."""
    content = message.data.cast("B") if isinstance(message, np.ndarray) else message
    sink.write(_LENGTH.pack(len(content)))
    sink.write(content)
    sink.flush()


def read_message(source: BinaryIO) -> bytes | None:
    """Read a message; None at the end of the stream, also within a message."""
    head = source.read(_LENGTH.size)
    if len(head) < _LENGTH.size:
        return None
    (length,) = _LENGTH.unpack(head)
    message = source.read(length)
    return message if len(message) == length else None


class _Array(NamedTuple):
    """New array; ``place`` is its content or its offset in shared memory."""

    number: int
    dtype: str
    shape: tuple[int, ...]
    place: bytes | int


class _Mesh(NamedTuple):
    """New mesh, given by the numbers of its arrays."""

    number: int
    V: int
    F: int
    weld: tuple[int, int] | None
    path: Path | None


class ArrayPacker:
    """Serialise values for one :class:`ArrayUnpacker`.

    Attributes
    ----------
    shared_arrays : SharedArrays or None
        Has to be discarded by the caller once the last message has been unpacked.
    """

    def __init__(self) -> None:
        self.shared_arrays: SharedArrays | None = None
        self._numbers = itertools.count()
        # Keyed by id, which is unique while the objects are kept alive.
        self._known: dict[int, tuple[int, Any]] = {}
        self._mentioned: dict[int, tuple[int, Any]] = {}
        self._arrays: list[tuple[int, np.ndarray]] = []
        self._meshes: list[_Mesh] = []

    def packed_message(self, value: object) -> bytes:
        """Return the message for ``value``; raises MemoryError."""
        self._mentioned, self._arrays, self._meshes = {}, [], []
        content = pickled_value(value, self._number)
        forgotten = [number for key, (number, _) in self._known.items() if key not in self._mentioned]
        arrays = self._layout()
        self._known = self._mentioned
        name = self.shared_arrays.name if self.shared_arrays else None
        return pickle.dumps((arrays, self._meshes, forgotten, name, content))

    def _number(self, value: object) -> int | None:
        """Return the number of an array or a mesh; None for anything else."""
        if isinstance(value, np.ndarray):
            return self._array(value)
        return self._mesh(value) if isinstance(value, Mesh) else None

    def _array(self, array: np.ndarray) -> int:
        number, new = self._reference(array)
        if new:
            self._arrays.append((number, array))
        return number

    def _mesh(self, mesh: Mesh) -> int:
        V, F = self._array(mesh.V), self._array(mesh.F)
        number, new = self._reference(mesh)
        if new:
            weld: Weld | None = mesh.__dict__.get("weld")
            both = (self._array(weld.first), self._array(weld.inverse)) if weld else None
            self._meshes.append(_Mesh(number, V, F, both, mesh.path))
        return number

    def _reference(self, thing: object) -> tuple[int, bool]:
        entry = self._mentioned.get(id(thing)) or self._known.get(id(thing))
        new = entry is None
        if entry is None:
            entry = next(self._numbers), thing
        self._mentioned[id(thing)] = entry
        return entry[0], new

    def _layout(self) -> list[_Array]:
        large = [array for _, array in self._arrays if array.nbytes >= LEAST_SHARED_BYTES]
        try:
            self.shared_arrays = SharedArrays(large) if large else None
        except OSError:  # too little shared memory: all arrays are sent through the pipe
            self.shared_arrays, large = None, []
        offsets = iter(self.shared_arrays.offsets if self.shared_arrays else ())
        places = [
            next(offsets) if self.shared_arrays and array.nbytes >= LEAST_SHARED_BYTES else array.tobytes()
            for _, array in self._arrays
        ]
        return [
            _Array(number, array.dtype.str, array.shape, place)
            for (number, array), place in zip(self._arrays, places, strict=True)
        ]


class ArrayUnpacker:
    """Restore values from the messages of one :class:`ArrayPacker`."""

    def __init__(self) -> None:
        self._known: dict[int, Any] = {}

    def unpacked_value(self, message: bytes) -> Any:
        """Return the value, with read-only arrays of its own."""
        arrays, meshes, forgotten, name, content = pickle.loads(message)
        for number in forgotten:
            del self._known[number]
        envelope = SharedArraysReader(name) if name else None
        for number, dtype, shape, place in arrays:
            if isinstance(place, bytes):
                array = np.frombuffer(place, np.dtype(dtype)).reshape(shape)
            else:
                assert envelope is not None
                array = envelope.array(dtype, shape, place)
            self._known[number] = frozen(array)
        if envelope:
            envelope.close()
        for mesh in meshes:
            self._known[mesh.number] = self._mesh(mesh)
        return unpickled_value(content, self._known)

    def _mesh(self, description: _Mesh) -> Mesh:
        known = self._known
        weld = (known[description.weld[0]], known[description.weld[1]]) if description.weld else None
        return Mesh.from_checked_arrays(
            known[description.V], known[description.F], description.path, weld=weld
        )


def pickled_value(value: object, number_of: Callable[[object], int | None]) -> bytes:
    """Pickle ``value``, with numbers in place of the numbered objects."""

    class Pickler(pickle.Pickler):
        def persistent_id(self, thing: object) -> int | None:
            return number_of(thing)

    buffer = io.BytesIO()
    Pickler(buffer, pickle.HIGHEST_PROTOCOL).dump(value)
    return buffer.getvalue()


def unpickled_value(content: bytes, known: Mapping[int, Any]) -> Any:
    """Restore a pickled value, given the numbered objects."""

    class Unpickler(pickle.Unpickler):
        def persistent_load(self, number: int) -> Any:
            return known[number]

    return Unpickler(io.BytesIO(content)).load()
