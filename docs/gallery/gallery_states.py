"""States of finished deformations, as their sessions keep them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from apd_viewer.commands.deform_command import deform_parser
from apd_viewer.commands.motion_options import motion_from
from apd_viewer.commands.terminal.setting_options import has_contact, setting_arguments
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.selections.selection_files import read_selection_file
from apd_viewer.files.selections.survey_formats import read_region, read_transform
from apd_viewer.geometry.analysis.inspection import inspect
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.solver.settings import Settings
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import with_selection
from apd_viewer.session.model.handles_and_regions import NamedRegion
from apd_viewer.session.model.state import State, initial_state
from apd_viewer.session.posing.motion_path import document_along_paths, motion_paths
from apd_viewer.session.storage.part_json import read_obstacles


def state_after(words: Sequence[str], U: np.ndarray | None = None) -> State:
    """The state of a finished ``apd-viewer deform``, by its arguments.

    ``U`` (n, 3) is the shape; without it, that of the mesh that was written.
    """
    options = deform_parser().parse_args(list(words))
    mesh = open_mesh(options.mesh)
    state = initial_state(mesh)
    if options.selection:
        selection = read_selection_file(options.selection, mesh)
        state = state.updated(with_selection(state.document, selection))
    settings = setting_arguments(options, mesh) | {
        "area": options.area or 100.0,
        "hold_area": options.method == "local" and options.area is not None,
        "contact": has_contact(options, len(mesh.V)),
    }
    obstacles = read_obstacles(Path(options.obstacles)) if options.obstacles else ()
    document = replace(state.document, settings=Settings(**settings), obstacles=obstacles)
    document = _with_regions(document, options.region)
    for number, path in enumerate(options.transform):
        document = document.with_pose(number, read_transform(path))
    state = state.updated(document)
    if options.motion:
        paths = motion_paths(document, motion_from(options, document))
        state = state.updated(document_along_paths(document, paths))
    return shaped(state, open_mesh(options.output).V if U is None else U)


def _with_regions(document: Document, regions: Sequence[Sequence[str]]) -> Document:
    member = document.member.copy()
    named = []
    for number, (name, path, *percent) in enumerate(regions, start=1):
        member[read_region(path, len(member))] = number
        named.append(NamedRegion(name, float(percent[0]) if percent else None))
    return replace(document, member=frozen(member), regions=tuple(named))


def shaped(state: State, U: np.ndarray) -> State:
    """The state with a shape (n, 3) and its readings."""
    now, rest = inspect(Mesh(U, state.document.mesh.F)), state.inspection
    frame = replace(
        state.frame,
        U=frozen(np.array(U)),
        area=now.area,
        area_error=now.area / rest.area - 1.0,
        volume=now.volume if rest.volume is not None else None,
        volume_capped=now.volume_capped,
        energy=None,
        shifts=frozen(np.array([each.shift for each in state.document.obstacles]).reshape(-1, 3)),
    )
    return state.updated(frame=frame)
