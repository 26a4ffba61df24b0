"""Text formats of the Botsch-Sorkine survey: selections (.sel), transforms (.def).

[Botsch & Sorkine 2008, On Linear Variational Surface Deformation Methods]
"""

from pathlib import Path

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.storage.regular_files import read_content
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.pose.constraints import BASE, HANDLE, MOST_HANDLES
from apd_viewer.language import tr

_SELECTION = tr(
    "{name} is not a selection with one integer (0 base, 1 free, 2 handle) per vertex; choose another file."
)
_REGION = tr("{name} is not a region with one number (0 outside, 1 inside) per vertex; choose another file.")
_TRANSFORM = tr("{name} is not a transform with four rows of four numbers; choose another file.")


def read_selection(path: str | Path, n: int) -> np.ndarray:
    """Labels of ``n`` vertices: 0 base, 1 free, 2 and above the handles.

    Returns
    -------
    (n,) uint8 array, read-only

    Raises
    ------
    InputError
        If the file does not fit the mesh or is no selection.
    """
    path = Path(path)
    labels = _vertex_numbers(path, n, _SELECTION)
    last = HANDLE + MOST_HANDLES - 1
    if not np.isin(labels, np.arange(BASE, last + 1)).all():
        raise InputError(
            tr(
                "{name} has a label other than 0 (base), 1 (free) and 2 to {last} (handles); correct it."
            ).format(name=path.name, last=last)
        )
    return frozen(labels.astype(np.uint8))


def labels_to_sel(labels: np.ndarray) -> bytes:
    """File content of labels (n,) in the format of :func:`read_selection`."""
    head = [f"# {len(labels)} vertices, one a line in the order of the mesh's file"]
    head += ["# 0 held (base), 1 free, 2 handle, 3 the next handle and so on"]
    return "\n".join([*head, *map(str, labels.tolist()), ""]).encode()


def read_region(path: str | Path, n: int) -> np.ndarray:
    """Ids of the vertices with a non-zero number in a .sel file.

    Raises
    ------
    InputError
        If the file does not fit the mesh of ``n`` vertices.
    """
    return np.flatnonzero(_vertex_numbers(Path(path), n, _REGION))


def read_transform(path: str | Path) -> np.ndarray:
    """Read a (4, 4) matrix acting on column vectors (x, y, z, 1).

    Raises
    ------
    InputError
        If the file does not hold an affine 4x4 matrix.
    """
    path = Path(path)
    numbers = _numbers(path, _TRANSFORM)
    if len(numbers) != 16 or not np.isfinite(numbers).all():
        raise InputError(
            tr("{name} is not a 4x4 matrix; write four rows of four numbers.").format(name=path.name)
        )
    M = numbers.reshape(4, 4)
    if not np.array_equal(M[3], [0, 0, 0, 1]):
        raise InputError(
            tr("{name} is not an affine transform; its last row must be 0 0 0 1.").format(name=path.name)
        )
    return M


def _vertex_numbers(path: Path, n: int, otherwise: str) -> np.ndarray:
    numbers = _numbers(path, otherwise)
    if len(numbers) != n:
        raise InputError(
            tr(
                "{name} is for a mesh of {found:,} vertices, but this mesh has {n:,}; choose the file "
                "made for this mesh."
            ).format(name=path.name, found=len(numbers), n=n)
        )
    return numbers


def _numbers(path: Path, otherwise: str) -> np.ndarray:
    content = read_content(path)
    try:
        lines = content.decode("utf-8-sig").splitlines()
        words = [word for line in lines for word in line.partition("#")[0].split()]
        return np.array([float(word) for word in words])
    except ValueError as error:
        raise InputError(otherwise.format(name=path.name)) from error
