"""Selections as libigl's dense matrices (.dmat): a column of groups.

As in libigl's tutorial -1 is free. Of the other groups the lowest is the base, and the others are the
handles in order. We write 0 for the base and 1, 2 and so on for the handles. The first line has the numbers
of columns and rows; where both are 0, another such line and the numbers in binary follow.
"""

from __future__ import annotations

import re

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.formats.text import parse_numbers
from apd_viewer.files.selections.selection import Selection, check_vertex_count
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE, MOST_HANDLES
from apd_viewer.language import tr

_HEAD = re.compile(rb"\s*(\d{1,18})[ \t]+(\d{1,18})[ \t]*(?:\r\n|\n|\r)")
_FREE = -1
_LARGEST = 2.0**31  # more groups than this are an error


def labels_to_dmat(labels: np.ndarray) -> bytes:
    """The file of the labels (n,), as text."""
    groups = np.arange(256) - 1
    groups[FREE], groups[BASE] = _FREE, 0
    return "\n".join([f"1 {len(labels)}", *map(str, groups[labels].tolist()), ""]).encode()


def selection_from_dmat(content: bytes, mesh: Mesh) -> Selection:
    """Selection in a file; raises ValueError or InputError if not for ``mesh``."""
    columns, rows, start = _head(content, 0)
    binary = columns == rows == 0 and len(content) > start
    if binary:
        columns, rows, start = _head(content, start)
    if columns != 1:
        raise ValueError(tr("it has {columns:,} columns instead of one").format(columns=columns))
    check_vertex_count(rows, len(mesh.V))
    if binary:
        groups = np.frombuffer(content[start:], "<f8", (len(content) - start) // 8)
    else:
        groups = parse_numbers(content[start:].split())
    if len(groups) != rows:
        raise ValueError(tr("it has {n:,} numbers, but declares {rows:,}").format(n=len(groups), rows=rows))
    return Selection.with_default_names(_labels(groups))


def _head(content: bytes, start: int) -> tuple[int, int, int]:
    """Column and row counts, and the offset of the following line."""
    head = _HEAD.match(content, start)
    if head is None:
        raise ValueError(tr("it does not start with the numbers of columns and rows"))
    return int(head[1]), int(head[2]), head.end()


def _labels(groups: np.ndarray) -> np.ndarray:
    """Labels (n,) for the group of each vertex, (n,) floats."""
    whole = np.isfinite(groups) & (groups == np.rint(groups))
    if not (whole & (groups >= _FREE) & (groups < _LARGEST)).all():
        raise InputError(tr("It has a number other than -1 (free), 0, 1, 2 and so on; correct it."))
    held = groups != _FREE
    present, order = np.unique(groups[held], return_inverse=True)
    if len(present) > 1 + MOST_HANDLES:
        raise InputError(
            tr("It has {n:,} groups, but the limit is a base and {most} handles; merge some.").format(
                n=len(present), most=MOST_HANDLES
            )
        )
    labels = np.full(len(groups), FREE, dtype=np.uint8)
    labels[held] = np.array([BASE, *range(HANDLE, HANDLE + MOST_HANDLES)])[order]
    return labels
