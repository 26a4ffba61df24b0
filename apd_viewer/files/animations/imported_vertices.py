"""Vertices of a mesh file in the order of programs that import it.

A point cache names no vertices: its points are those of the mesh that it is put on, in their order. So it has
to follow what importers make of the file, and not the file alone.
"""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry.mesh.mesh import BakedOrigin, Mesh

# Formats of which vertices without a face are not imported.
_FACES_ALONE = (".obj", ".glb", ".gltf")


def imported_vertices(mesh: Mesh) -> np.ndarray:
    """Vertices in the order of Blender's import of the file, (k,) int array.

    STL has no vertices but corners: equal ones, in single precision, become one vertex, in the order in which
    they first come. Of OBJ and glTF only the vertices of faces are imported. Of all other formats, and of a
    mesh without a file, each vertex is.
    """
    read = mesh.origin.mesh if isinstance(mesh.origin, BakedOrigin) else mesh
    suffix = mesh.origin.suffix if mesh.origin else ""
    if suffix == ".stl":
        corners = read.V.astype(np.float32) + np.float32(0.0)  # one zero, and not two of either sign
        return np.sort(np.unique(corners, axis=0, return_index=True)[1])
    return np.unique(mesh.F) if suffix in _FACES_ALONE else np.arange(len(mesh.V))
