"""A painted mesh."""

import numpy as np
from meshes import sphere

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
