"""Construction of a deformation from a document."""

from __future__ import annotations

from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.linalg.linear_solver import Factorizer
from apd_viewer.geometry.pose.constraints import Constraints
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.settings import SETTINGS
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.targets import targets_of


def deformation_of(
    document: Document, held: Constraints, rest: RestMesh | None = None, factored: Factorizer | None = None
) -> Deformation:
    """Return the deformation of a document, not aimed yet."""
    settings = {name: getattr(document.settings, name) for name in SETTINGS if name != "hold_area"}
    settings |= {**targets_of(document)._asdict(), "contact": document.settings.uses_contact}
    return Deformation(
        document.mesh.V,
        document.mesh.F,
        held.fixed,
        handle=held.handles,
        rest=rest,
        factored=factored,
        soft=held.soft,
        loose=document.staying_components,
        obstacles=document.active_obstacles,
        **settings,
    )
