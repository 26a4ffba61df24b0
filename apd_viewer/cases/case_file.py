"""Files of finished cases: readings, curves and shape, written atomically."""

import json
import os
import struct
import sys
import zlib
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.storage.archive import npy_content
from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.files.storage.regular_files import read_bytes
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.language import tr

Curves: TypeAlias = dict[str, list[float | None]]

CASE_SUFFIX = ".case"
DONE, FAILED = "done", "failed"
_MAGIC = b"apd-case\x01"
_LARGEST = sys.float_info.max
_HEAD = struct.Struct("<IQQ")  # CRC-32 of text and array, and their lengths in bytes


@dataclass(frozen=True, eq=False)
class CaseResult:
    """Result of a study case: status, readings, curves and last shape.

    Attributes
    ----------
    case : dict
        Its inputs, as :attr:`StudyCase.said`.
    status : str
        DONE or FAILED.
    sentence : str
        Reason of a failure, or a remark for the user; empty if there is nothing to say.
    readings : dict
        Numbers by name; None where there is none.
    curves : dict
        Numbers by name, one for each step from 0.
    frame : dict
        Of the last step, as sessions write it.
    U : (n, 3) float array or None
        The last shape; None of a failed one.
    """

    key: str
    case: dict[str, Any]
    status: str
    sentence: str = ""
    readings: dict[str, float | None] = field(default_factory=dict)
    curves: Curves = field(default_factory=dict)
    frame: dict[str, Any] = field(default_factory=dict)
    U: np.ndarray | None = None


def case_to_bytes(result: CaseResult) -> bytes:
    """Serialised result; equal results give equal bytes."""
    said = {each.name: getattr(result, each.name) for each in fields(result) if each.name != "U"}
    text = json.dumps(said).encode()
    array = b"" if result.U is None else npy_content(result.U)
    sizes = len(text), len(array)
    crc = zlib.crc32(array, zlib.crc32(text))
    return b"".join([_MAGIC, _HEAD.pack(crc, *sizes), text, array])


def case_from_bytes(content: bytes, with_shape: bool = True) -> CaseResult:
    """Result parsed from its bytes, with or without its shape.

    Raises
    ------
    ValueError
        If they are damaged; a phrase says how.
    """
    start = len(_MAGIC) + _HEAD.size
    if not content.startswith(_MAGIC) or len(content) < start:
        raise ValueError(tr("it is not a case result"))
    crc, text, array = _HEAD.unpack_from(content, len(_MAGIC))
    body = memoryview(content)[start:]
    if len(body) != text + array or zlib.crc32(body) != crc:
        raise ValueError(tr("it is damaged"))
    try:
        said = json.loads(bytes(body[:text]))
        return _validated_result(CaseResult(**said, U=_shape(body[text:]) if with_shape and array else None))
    except (ValueError, TypeError, RecursionError) as error:  # file not written by this program
        raise ValueError(tr("it is damaged")) from error


def _shape(content: memoryview) -> np.ndarray:
    """Shape from the bytes of a .npy array; raises ValueError for any other content."""
    start = 10 + int.from_bytes(content[8:10], "little")
    U = np.frombuffer(content, "<f8", offset=start).reshape(-1, 3).astype(np.float64)
    if npy_content(U) != content:
        raise ValueError
    return frozen(U)


def _validated_result(result: CaseResult) -> CaseResult:
    """Result with validated field types; raises TypeError or ValueError."""
    texts, parts = (result.key, result.status, result.sentence), (result.case, result.frame)
    if not all(isinstance(each, str) for each in texts) or not all(isinstance(each, dict) for each in parts):
        raise TypeError
    rows = list(zip(*result.curves.values(), strict=True))
    if not all(is_reading(value) for row in (result.readings.values(), *rows) for value in row):
        raise ValueError
    return result


def is_reading(value: object) -> bool:
    """True for a finite number, or None."""
    return value is None or (isinstance(value, int | float) and -_LARGEST <= value <= _LARGEST)


def write_case(path: Path, content: bytes) -> None:
    """Write the bytes of a result to its file; raises InputError."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.is_symlink():  # a link could lead to a file outside the study
        path.unlink()
    with replacing_file(path) as scratch:
        scratch.write_bytes(content)


def case_path(folder: Path, key: str) -> Path:
    """File of a finished case in the folder of its study."""
    # Spread over subfolders: writing a file scans its folder for leftover scratch files.
    return folder / "cases" / key[:2] / f"{key}{CASE_SUFFIX}"


def read_case(folder: Path, key: str, with_shape: bool = False) -> CaseResult:
    """Read a finished case; raises InputError if it is missing or damaged."""
    try:
        return case_from_bytes(read_bytes(case_path(folder, key)), with_shape)
    except OSError as error:
        raise InputError(tr("This case is not done, or its study was moved; reopen the study.")) from error
    except ValueError as error:
        raise damaged_case_error(folder, key) from error


def damaged_case_error(folder: Path, key: str) -> InputError:
    """Error for a damaged result file."""
    name = case_path(folder, key).name
    return InputError(tr("{name} is damaged; run the study again.").format(name=name))


def case_sizes(folder: Path) -> dict[str, int]:
    """File size in bytes of each finished case, by case key."""
    sizes: dict[str, int] = {}
    if not (folder / "cases").is_dir():
        return sizes
    with os.scandir(folder / "cases") as groups:
        folders = [group.path for group in groups if group.is_dir()]
    for each in folders:
        with os.scandir(each) as entries:
            for entry in entries:
                is_case = entry.name.endswith(CASE_SUFFIX) and not entry.name.startswith(".")
                if is_case and entry.is_file(follow_symlinks=False):
                    sizes[entry.name.removesuffix(CASE_SUFFIX)] = entry.stat().st_size
    return sizes
