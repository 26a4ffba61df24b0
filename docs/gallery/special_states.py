"""States for sessions of the gallery that no single deformation says."""

from __future__ import annotations

import shlex
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import sample_files
from gallery_states import shaped, state_after

from apd_viewer.cases.plan import read_plan
from apd_viewer.cases.run_case import case_session
from apd_viewer.cases.study_case import InputFiles
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.selections.selection_files import read_selection_file
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.document_parts import with_selection
from apd_viewer.session.model.state import State, initial_state
from apd_viewer.session.model.view import View
from apd_viewer.session.shape_editor import baked_state
from apd_viewer.session.storage.session_file import save_session

Names = dict[str, Any]
_BOTTLE = "bottle.obj --selection bottle.sel"


def _pressed(folder: Path, mesh: str, written: str) -> State:
    state = initial_state(open_mesh(folder / mesh))
    return shaped(state, open_mesh(folder / written).V)


def pressed_bottle(folder: Path, _: Names) -> State:
    """The bottle with the shape of the last step."""
    return _pressed(folder, "bottle.obj", "pressed.obj")


def pressed_pillow(folder: Path, _: Names) -> State:
    """The pillow that is filled and pressed."""
    return _pressed(folder, "pillow.obj", "pressed.obj")


def creased_can(folder: Path, _: Names) -> State:
    """The can with what remains."""
    return _pressed(folder, "can.obj", "creased.obj")


def baked_bottle(folder: Path, names: Names) -> State:
    """The bent bottle, whose rest shape is the twisted one."""
    mesh = open_mesh(folder / "bottle.obj")
    first = _painted(mesh, folder / "bottle.sel")
    state = baked_state(shaped(first, names["first"].U))
    pose = np.eye(4)
    pose[:3, 3] = 5.0, -1.0, 0.0
    return shaped(state.updated(state.document.with_pose(0, pose)), names["result"].U)


def _painted(mesh: Mesh, selection: Path) -> State:
    """State of a mesh at rest with the paint of a file."""
    state = initial_state(mesh)
    return state.updated(with_selection(state.document, read_selection_file(selection, mesh)))


def falloff_session(folder: Path, count: int) -> None:
    """A session in which a single vertex is to be raised, with a falloff."""
    sample_files.sheet(folder, count)
    mesh = open_mesh(folder / "sheet.obj")
    state = _painted(mesh, folder / "sheet.sel")
    pose = np.eye(4)
    pose[1, 3] = 4.0
    document = state.document
    handle = replace(document.handles[0], falloff=7.0)
    state = state.updated(
        replace(document.with_settings(method="arap"), handles=(handle,)).with_pose(0, pose)
    ).as_unsettled()
    save_session(folder / "falloff.apd", state, View(unit="cm"), embed=True)


def falloff(folder: Path, _: Names) -> State:
    """The sheet with its bump."""
    from apd_viewer.session.storage.session_file import open_session

    state, _view = open_session(folder / "falloff.apd")
    return shaped(state, open_mesh(folder / "bump.obj").V)


def large_animal(folder: Path, _: Names) -> State:
    """The same deformation of the animal with few vertices, so that its session is small."""
    few = folder / "few"
    few.mkdir()
    sample_files.animal_head(few, max(300, len(open_mesh(folder / "animal.obj").V) // 24))
    return _deformed(few, 'animal.obj --selection animal.sel --turn "45deg about y" -o turned.obj')


def _deformed(folder: Path, words: str) -> State:
    """The state after a deformation that is made here."""
    # Here: it imports the list of entries' own parts.
    from entry import run_code, within

    run_code(f"apd-viewer deform {words}", "sh", folder)
    with within(folder):
        return state_after(shlex.split(words))


def swept_bottle(folder: Path, _: Names) -> State:
    """The last shape of the sweep, by a deformation of its own."""
    return _deformed(folder, f"{_BOTTLE} --twist 150deg -o swept.obj")


def filmed_bottle(folder: Path, _: Names) -> State:
    """The last shape of the film."""
    return _deformed(folder, f"{_BOTTLE} --twist 120deg --method local -o filmed.obj")


def studied_bottle(folder: Path, _: Names) -> State:
    """The case of the study with the least volume."""
    results = folder / "results"
    plan = read_plan(folder / "plan.csv", InputFiles(results / "inputs"))
    states = [case_session(results, key)[0] for key in plan.cases]
    return min(states, key=lambda state: float(state.frame.volume or 0.0))
