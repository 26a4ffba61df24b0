"""Construction of a deformation from a document."""

from __future__ import annotations

from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.linalg.linear_solver import Factorizer
from apd_viewer.geometry.pose.constraints import Constraints
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.targets import targets_of


def deformation_of(
    document: Document, held: Constraints, rest: RestMesh | None = None, factored: Factorizer | None = None
) -> Deformation:
    """Return the deformation of a document, not aimed yet."""
    return Deformation(
        document.mesh.V,
        document.mesh.F,
        held.fixed,
        method=document.method,
        handle=held.handles,
        tolerance=document.tolerance,
        stiffness=document.stiffness,
        area_stiffness=document.area_stiffness,
        shear_stiffness=document.shear_stiffness,
        **targets_of(document)._asdict(),
        rest=rest,
        factored=factored,
        soft=held.soft,
        loose=document.staying_components,
        calm=document.calm,
        contact=document.contact and document.method_traits.may_use_contact,
        thickness=document.thickness,
        obstacles=document.active_obstacles,
        convergence=document.convergence,
    )
