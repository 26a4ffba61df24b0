"""Resources of the program: sample meshes and icons."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.selections.survey_formats import read_selection
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr

SAMPLES = {"bottle": tr("PET bottle"), "duck": tr("Rubber duck")}


def resource(name: str) -> Path:
    """Path of a file in ``resources``, installed or in a checkout."""
    package = Path(__file__).resolve().parents[1]
    inside = package / "resources"
    return (inside if inside.is_dir() else package.parent / "resources") / name


def open_sample(name: str) -> tuple[Mesh, np.ndarray]:
    """The sample's mesh and its painted labels (n,)."""
    mesh = open_mesh(resource(f"{name}.obj"))
    return mesh, read_selection(resource(f"{name}.sel"), len(mesh.V))
