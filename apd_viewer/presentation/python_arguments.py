"""Obstacles and settings of a document, as Python."""

from __future__ import annotations

from collections.abc import Iterator

from apd_viewer.geometry.solver.settings import DEFAULT_SETTINGS, SETTINGS
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
    settings, targets = document.settings, targets_of(document)
    # Contact keeps a distance only while it is on, and "local" keeps the total area only if told to.
    idle = {"hold_area", *(() if settings.uses_contact else ("thickness",))}
    if settings.convergence == DEFAULT_SETTINGS.convergence:
        idle.add("convergence")
    given = {**vars(settings), **targets._asdict()}
    words = [
        f"{name}={given[name]!r}"
        for name, setting in SETTINGS.items()
        if given[name] is not None and setting.applies(settings.traits) and name not in idle
    ]
    if document.staying_components:
        words.append(f"loose={list(document.staying_components)!r}")
    if document.has_active_obstacles:
        words.append("obstacles=obstacles")
    if document.mesh.has_welded_seams:
        words.append("weld=True")
    if targets.regions:
        words.append("regions=regions")
    return ", ".join(words).replace("convergence=", "convergence=apd_viewer.")
