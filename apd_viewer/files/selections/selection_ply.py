"""Selections as integer properties of PLY vertices: labels and regions.

``apd_label`` is 0 base, 1 free, 2 handle, 3 the next handle and so on; ``apd_region``, which may be left
out, is 0 in no region, 1 in the first one and so on. Any program that keeps the properties of vertices may
have written the file; positions and faces are not looked at.
"""

from __future__ import annotations

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.formats.ply import PlyFile, read_ply
from apd_viewer.files.selections.selection import (
    Selection,
    check_vertex_count,
    checked_labels,
    checked_member,
)
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr

_LABEL, _REGION = "apd_label", "apd_region"
_HEAD = f"""ply
format binary_little_endian 1.0
comment {_LABEL}: 0 base, 1 free, 2 handle, 3 the next handle; {_REGION}: 0 none
element vertex {{}}
property double x
property double y
property double z
property uchar {_LABEL}
property uchar {_REGION}
element face {{}}
property list uchar int vertex_indices
end_header
"""


def selection_to_ply(mesh: Mesh, selection: Selection) -> bytes:
    """The triangles of ``mesh``, with the labels and the regions at its vertices."""
    rows = np.empty(len(mesh.V), dtype=[("V", "<f8", (3,)), (_LABEL, "u1"), (_REGION, "u1")])
    rows["V"], rows[_LABEL], rows[_REGION] = mesh.V, selection.labels, selection.member
    faces = np.empty(len(mesh.F), dtype=[("count", "u1"), ("corners", "<i4", (3,))])
    faces["count"], faces["corners"] = 3, mesh.F
    return _HEAD.format(len(rows), len(faces)).encode() + rows.tobytes() + faces.tobytes()


def selection_from_ply(content: bytes, mesh: Mesh) -> Selection:
    """Selection in a file; raises ValueError or InputError if not for ``mesh``."""
    file = read_ply(content).origin
    if not isinstance(file, PlyFile):
        raise ValueError(tr("it has no vertices"))
    at = next(k for k, element in enumerate(file.elements) if element.name == "vertex")
    there = {name for name, length, kind in file.elements[at].properties if not length and kind[0] in "iu"}
    if _LABEL not in there:
        raise InputError(
            tr("Its vertices have no integer property “{name}”; choose a file with a selection.").format(
                name=_LABEL
            )
        )
    n = len(mesh.V)
    check_vertex_count(file.elements[at].rows, n)
    labels = checked_labels(file.columns(at, (_LABEL,))[:, 0], n)
    member = checked_member(file.columns(at, (_REGION,))[:, 0], n) if _REGION in there else None
    return Selection.with_default_names(labels, member)
