"""Files opened, written as they are and with other coordinates, and opened again."""

import numpy as np

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.analysis.inspection import inspect


def opened(path, content):
    """Mesh of the content; written unchanged it is the same file, and deformed the same mesh."""
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    mesh, out = open_mesh(path), path.with_name(f"out{path.suffix}")
    save_mesh(mesh, mesh.V, out)
    assert out.read_bytes() == path.read_bytes()
    U = mesh.V * [2.0, 0.5, 4.0] + [1.0, -0.25, 8.0]  # exact in single precision, too
    save_mesh(mesh, U, out)
    again = open_mesh(out)
    assert np.array_equal(again.V, U)
    assert np.array_equal(again.F, mesh.F)
    assert again.remarks == mesh.remarks
    return mesh


def said_of(mesh):
    """Sentences of the mesh check about the file."""
    return [finding.sentence for finding in inspect(mesh).findings if finding.kind == "file"]
