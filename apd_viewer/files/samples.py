"""Resources of the program: sample meshes and icons."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np

from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.selections.survey_formats import read_selection
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr

# Settings for fabric: triangles nearly keep their areas, and the total area is kept exactly.
_FABRIC = {"method": "local", "hold_area": True}


@dataclass(frozen=True)
class Sample:
    """Sample mesh with its initial settings.

    Attributes
    ----------
    settings : mapping
        Fields of the document that begin otherwise than those of any mesh.
    pivot : (3,) tuple of floats or None
        Centre of rotation of the handle, mesh units; None is the handle's centre.
    unit : str
        Symbol of the unit of length.
    material : str
        Name of the material of the wall; empty where it is not known.
    """

    title: str
    tip: str
    settings: Mapping[str, object] = field(default_factory=dict)
    pivot: tuple[float, float, float] | None = None
    unit: str = "cm"
    material: str = ""


SAMPLES = {
    "bottle": Sample(
        tr("PET bottle"),
        tr("Open the PET bottle, already painted: twist its neck"),
        material="pet-bottle",
    ),
    "cloth": Sample(
        tr("Cloth"),
        tr("Open the cloth, already painted: fold it over"),
        {**_FABRIC, "stiffness": 2e-4, "area_stiffness": 300.0},
        pivot=(0.0, 0.4, 0.0),
    ),
    "cushion": Sample(
        tr("Silk cushion"),
        tr("Open the silk cushion, already painted: press it down"),
        {**_FABRIC, "stiffness": 1e-3, "area_stiffness": 100.0},
    ),
    "duck": Sample(tr("Rubber duck"), tr("Open the rubber duck, already painted: bend its tail")),
}


@cache
def resource_path(name: str) -> Path:
    """Path of a resource file, in an installation or a source checkout."""
    package = Path(__file__).resolve().parents[1]
    inside = package / "resources"
    return (inside if inside.is_dir() else package.parent / "resources") / name


def open_sample(name: str) -> tuple[Mesh, np.ndarray]:
    """Open a sample; return its mesh and its painted labels (n,)."""
    read = open_mesh(resource_path(f"{name}.obj"))
    mesh = Mesh.from_checked_arrays(read.V, read.F, read.path, read.origin, unit=SAMPLES[name].unit)
    return mesh, read_selection(resource_path(f"{name}.sel"), len(mesh.V))


def sample_of(path: Path | None) -> Sample | None:
    """Sample stored in a file; None for any other file."""
    return next((each for name, each in SAMPLES.items() if resource_path(f"{name}.obj") == path), None)
