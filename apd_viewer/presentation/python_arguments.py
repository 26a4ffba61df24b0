"""Obstacles and settings of a document, as Python."""

from __future__ import annotations

from collections.abc import Iterator

from apd_viewer.geometry.solver.convergence import DEFAULT_CONVERGENCE
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.named_obstacle import ObstacleKind, stopping_extent
from apd_viewer.session.model.targets import targets_of


def obstacle_lines(document: Document) -> Iterator[str]:
    """Lines that make the obstacles; none where none push."""
    if not document.has_active_obstacles:
        return
    yield "obstacles = ["
    for obstacle, solid in zip(document.obstacles, document.active_obstacles, strict=True):
        yield f"    # {' '.join(obstacle.name.split())}"
        if obstacle.kind is ObstacleKind.PLATE:
            size = stopping_extent(obstacle, document.mesh.V)
            given = f"plate({obstacle.place.tolist()!r}, {obstacle.axis.tolist()!r}, {size!r})"
        else:
            kind = "sphere" if obstacle.kind is ObstacleKind.SPHERE else "capsule"
            given = f"{kind}({', '.join(map(repr, solid.points.tolist()))}, {solid.radius!r})"
        yield f"    apd_viewer.{given},"
    yield "]"


def settings_arguments(document: Document) -> str:
    """Arguments for method, settings and targets."""
    method, targets = document.method_traits, targets_of(document)
    said: dict[str, object] = {"method": document.method, "stiffness": document.stiffness}
    if method.has_tolerance:
        said["tolerance"] = document.tolerance
    if method.has_moduli:
        said |= {"area_stiffness": document.area_stiffness, "shear_stiffness": document.shear_stiffness}
    said |= {
        "area": targets.area,
        "volume": targets.volume,
        "loose": list(document.staying_components) or None,
    }
    words = [f"{name}={value!r}" for name, value in said.items() if value is not None]
    if method.keeps_calm_parts and not document.calm:
        words.append("calm=False")
    if method.may_use_contact:
        words.append(f"contact={bool(document.contact)}")
    if document.contact and method.may_use_contact and document.thickness is not None:
        words.append(f"thickness={document.thickness!r}")
    if document.has_active_obstacles:
        words.append("obstacles=obstacles")
    if document.mesh.has_welded_seams:
        words.append("weld=True")
    if document.convergence != DEFAULT_CONVERGENCE:
        words.append(f"convergence=apd_viewer.{document.convergence!r}")
    return ", ".join([*words, "regions=regions"] if targets.regions else words)
