"""ZIP archive of texts, arrays and files, never unpacked to disk."""

import io
import math
import re
import zipfile
import zlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import BinaryIO

import numpy as np

from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.language import tr

_KINDS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
# Errors raised by zipfile, depending on the damage.
ARCHIVE_ERRORS = (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError, ValueError, OverflowError, OSError)
# Limits on a member: it is malicious if larger and with a higher ratio to the archive,
# since meshes and shapes never compress that well.
_LARGE, _TIGHTEST = 1 << 26, 200  # in bytes, and as a ratio
_MAGIC = b"\x93NUMPY\x01\x00"
_HEADER = re.compile(
    rb"\{'descr': '([<|][a-z]\d)', 'fortran_order': False, 'shape': \((\d{1,15}(?:, ?\d{0,15})*)\), \} *\n"
)


def npy_content(array: np.ndarray) -> bytes:
    """Content of a .npy file for an array, little-endian on every machine."""
    stream = io.BytesIO()
    little = array.astype(array.dtype.newbyteorder("<"), order="C", copy=False)
    np.lib.format.write_array(stream, little, version=(1, 0), allow_pickle=False)
    return stream.getvalue()


def write_archive(
    path: Path,
    members: Mapping[str, bytes],
    at_once: bool = False,
    finish: Callable[[Path], object] = lambda _: None,
) -> None:
    """Write members to a ZIP archive; equal members give identical files.

    ``at_once`` is for an urgent file: uncompressed, and in place before it has been flushed to disk.
    ``finish`` is that of :func:`apd_viewer.files.storage.atomic_file.replacing_file`.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    kind = zipfile.ZIP_STORED if at_once else zipfile.ZIP_DEFLATED
    with replacing_file(path, at_once, finish) as scratch, zipfile.ZipFile(scratch, "w") as archive:
        for name, content in members.items():
            entry = zipfile.ZipInfo(name)
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, content, kind, compresslevel=1)


def largest_unpacked_size(packed: int) -> int:
    """Largest unpacked size accepted for an archive of ``packed`` bytes."""
    return max(_LARGE, _TIGHTEST * packed)


class Archive:
    """Archive open for reading; methods raise ValueError on damaged content.

    Parameters
    ----------
    content : bytes or binary file
        Of a file that stays open only what is asked for is read.
    """

    def __init__(self, content: bytes | BinaryIO) -> None:
        stream = io.BytesIO(content) if isinstance(content, bytes) else content
        self._most = largest_unpacked_size(stream.seek(0, io.SEEK_END))
        try:
            self._zip = zipfile.ZipFile(stream)
        except ARCHIVE_ERRORS:
            raise ValueError(tr("its archive is damaged")) from None

    def has_member(self, name: str) -> bool:
        """True if the archive has a member ``name``."""
        return name in self._zip.NameToInfo

    def content(self, name: str) -> bytes:
        """Content of a member."""
        try:
            entry = self._zip.getinfo(name)
        except KeyError:
            raise ValueError(tr("“{name}” is missing from it").format(name=name)) from None
        if entry.file_size > self._most:
            raise ValueError(tr("“{name}” in it is too large").format(name=name))
        try:
            if entry.compress_type not in _KINDS:
                raise zipfile.BadZipFile
            with self._zip.open(entry) as member:
                content = member.read(entry.file_size)
                if len(content) != entry.file_size:
                    raise EOFError
        except ARCHIVE_ERRORS:
            raise ValueError(tr("“{name}” in it is damaged").format(name=name)) from None
        return content

    def array(self, name: str, kind: str, shape: tuple[int, ...]) -> np.ndarray:
        """Read-only array in the member ``name`` plus ``.npy``.

        Parameters
        ----------
        kind : str
            Its type as .npy has it, such as "<f8".
        """
        content = self.content(f"{name}.npy")
        start = 10 + int.from_bytes(content[8:10], "little")
        header = _HEADER.fullmatch(content[10:start])
        if header is None or not content.startswith(_MAGIC):
            raise ValueError(tr("“{name}” in it is not an array").format(name=name))
        found = tuple(int(size) for size in header[2].split(b",") if size.strip())
        size = start + math.prod(shape) * np.dtype(kind).itemsize
        if (header[1].decode(), found, len(content)) != (kind, shape, size):
            raise ValueError(tr("“{name}” in it does not fit the mesh").format(name=name))
        return frozen(np.frombuffer(content, kind, offset=start).reshape(shape).astype(kind[1:]))
