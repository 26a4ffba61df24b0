"""Painted meshes."""

from pathlib import Path

import numpy as np
import trimesh
from meshes import box, ends, sphere

from apd_viewer.files.selections.selection import Selection
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE

MESH = Mesh(*sphere(1))

N = len(MESH.V)


def painted(handles=("Arm", "Left leg"), regions=("Label", "Größe 👩‍🚀"), areas=(100.0, None)):
    labels, member = np.full(N, FREE, dtype=np.uint8), np.zeros(N, dtype=np.uint8)
    labels[:5], labels[7], labels[20:30], labels[[31, 33]] = BASE, BASE, HANDLE, HANDLE + 1
    member[3:9], member[40:] = 1, 2
    return Selection(labels, member, handles, regions, areas)


def write_bar(folder: Path) -> None:
    """Write a bar, ``bar.off``, with its ends painted by ``bar.sel``."""
    V, F = box(2, 2, 5)
    trimesh.Trimesh(V, F, process=False).export(folder / "bar.off")
    labels = np.ones(len(V), dtype=int)
    base, handle = ends(V)
    labels[base], labels[handle] = 0, 2
    np.savetxt(folder / "bar.sel", labels, fmt="%d")
