"""Files that the code of the gallery opens: the samples with fewer vertices, and meshes made in code."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import meshes_by_code as made
import numpy as np
from coarse import coarser

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.samples import resource_path
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.file_jobs import sample_state
from apd_viewer.verification.case_meshes import grid, sewn_sheets

STUDY = Path(__file__).resolve().parents[1] / "studies" / "crushed-bottle"
_DIGITS = 4  # of coordinates in centimetres


def written(folder: Path, name: str, V: np.ndarray, F: np.ndarray, labels: np.ndarray | None = None) -> None:
    """Write a mesh as OBJ, and its labels beside it."""
    V = np.round(V, _DIGITS)
    save_mesh(Mesh(V, F), V, folder / f"{name}.obj")
    if labels is not None:
        (folder / f"{name}.sel").write_text("\n".join(map(str, labels.tolist())) + "\n", encoding="utf-8")


def _sample(folder: Path, count: int, name: str, *transforms: str) -> None:
    state = coarser(sample_state(name), min(count, 2800))  # those of fabric would make large sessions
    document = state.document
    written(folder, name, document.mesh.V, document.mesh.F, document.labels)
    for transform in transforms:
        shutil.copy(resource_path(f"{transform}.def"), folder)


def bottle(folder: Path, count: int) -> None:
    """The sample bottle; with about 3,300 vertices that of the study, whose triangles are even."""
    if count >= 3000:
        for suffix in ("obj", "sel"):
            shutil.copy(STUDY / f"bottle.{suffix}", folder)
    else:
        _sample(folder, count, "bottle")


def turned_bottle(folder: Path, count: int) -> None:
    """The bottle, and a third of a turn of its neck."""
    bottle(folder, count)
    shutil.copy(resource_path("bottle-twist-120.def"), folder)


def labelled_bottle(folder: Path, count: int) -> None:
    """The bottle, and which of its vertices are under the label."""
    turned_bottle(folder, count)
    heights = _heights(folder / "bottle.obj")
    marked = (np.abs(heights - 11.0) < 2.6).astype(int)
    (folder / "label.sel").write_text("\n".join(map(str, marked.tolist())) + "\n", encoding="utf-8")


def _heights(path: Path) -> np.ndarray:
    lines = [line.split() for line in path.read_text(encoding="utf-8").splitlines()]
    return np.array([float(words[2]) for words in lines if words[:1] == ["v"]])


def two_bottles(folder: Path, count: int) -> None:
    """The bottle, and one that is half as wide again."""
    bottle(folder, count)
    lines = (folder / "bottle.obj").read_text(encoding="utf-8").splitlines()
    wide = [
        f"v {1.5 * float(words[1]):.4f} {words[2]} {1.5 * float(words[3]):.4f}"
        if words[:1] == ["v"]
        else line
        for line in lines
        for words in [line.split()]
    ]
    (folder / "bottle-wide.obj").write_text("\n".join(wide) + "\n", encoding="utf-8")


def bottle_and_finger(folder: Path, count: int) -> None:
    """The bottle, and a finger that pushes into its side."""
    bottle(folder, count)
    finger = {
        "name": "Finger",
        "kind": "cylinder",
        "place": [6.2, 11.8, 0.0],
        "axis": [1.0, 0.0, 0.0],
        "radius": 0.9,
        "length": 4.0,
        "shift": [-2.2, 0.0, 0.0],
    }
    (folder / "finger.json").write_text(json.dumps([finger]), encoding="utf-8")


def cushion(folder: Path, count: int) -> None:
    """The silk cushion."""
    _sample(folder, count, "cushion")


def pillow(folder: Path, count: int) -> None:
    """Two squares of cloth, sewn at their rims: an empty pillow 40 cm wide."""
    n = 2 * round(min(count / 8, 196) ** 0.5)  # with an odd number both sheets would share triangles
    uv, F = grid(n, n)
    V, F = sewn_sheets(40.0 * uv, F, 0.01)
    written(folder, "pillow", V[:, [0, 2, 1]] * [1.0, 1.0, -1.0], F)


def cloth(folder: Path, count: int) -> None:
    """The cloth, and the half turn that folds it."""
    _sample(folder, count, "cloth", "cloth-fold")


def duck(folder: Path, count: int) -> None:
    """The rubber duck, and the bends of the paper."""
    _sample(folder, count, "duck", "duck-bend-015", "duck-bend-030")


def _body(count: int) -> made.Arrays:
    """The animal; with fewer vertices than these its tail would be gone."""
    return made.animal(0.55 * np.sqrt(8500 / max(count, 1400)))


def _animal(folder: Path, count: int, *handles: tuple[tuple[float, ...], tuple[float, ...]]) -> None:
    V, F = _body(count)
    boxes = [made.within(V, *box) for box in handles]
    written(folder, "animal", V, F, made.animal_labels(V, *boxes))


_HEAD = (14.0, 23.5, -9.0), (30.0, 40.0, 9.0)
_TAIL = (-30.0, 21.0, -9.0), (-15.5, 40.0, 9.0)


def animal(folder: Path, count: int) -> None:
    """The animal: its feet are the base, its head and its tail the handles."""
    _animal(folder, count, _HEAD, _TAIL)


def animal_head(folder: Path, count: int) -> None:
    """The animal with its head as the only handle."""
    _animal(folder, count, _HEAD)


def animal_paws(folder: Path, count: int) -> None:
    """The animal standing on its hind legs: both fore paws are handles."""
    V, F = _body(count)
    labels = np.ones(len(V), dtype=np.uint8)
    labels[(V[:, 1] < 2.2) & (V[:, 0] < 0)] = 0
    for number, side in ((2, -1), (3, 1)):
        labels[(V[:, 1] < 3.0) & (V[:, 0] > 0) & (side * V[:, 2] > 0)] = number
    written(folder, "animal", V, F, labels)


def animal_with_eyes(folder: Path, count: int) -> None:
    """The animal with two loose eyes."""
    V, F = _body(count)
    labels = made.animal_labels(V, made.within(V, *_HEAD))
    for side in (-1, 1):
        X, G = made.ball(160, 0.62)
        V, F = np.vstack([V, X + [17.6, 28.6, 2.35 * side]]), np.vstack([F, G + len(V)])
        labels = np.concatenate([labels, np.ones(len(X), dtype=np.uint8)])
    written(folder, "animal", V, F, labels)


def scan(folder: Path, count: int) -> None:
    """The scanned stone: its lower rim is the base, its top the handle."""
    V, F = made.scan(count)
    labels = np.ones(len(V), dtype=np.uint8)
    labels[V[:, 1] < 1.6] = 0
    labels[V[:, 1] > V[:, 1].max() - 3.2] = 2
    written(folder, "scan", V, F, labels)


def unclean(folder: Path, count: int) -> None:
    """The mesh that is not clean."""
    V, F = made.unclean(count)
    labels = np.ones(len(V), dtype=np.uint8)
    labels[V[:, 1] < 2.2] = 0
    labels[V[:, 1] > 12.4] = 2
    written(folder, "unclean", V, F, labels)


def can(folder: Path, count: int) -> None:
    """The can."""
    around = max(16, 2 * round(np.sqrt(count / 2.2) / 2))
    V, F = made.can(around, max(8, round(0.65 * around)))
    written(folder, "can", V, F)


def sheet(folder: Path, count: int) -> None:
    """A sheet held at its border, and gripped at a single vertex."""
    V, F = made.sheet(round(np.sqrt(count / 1.15)))
    labels = np.where((np.abs(V[:, [0, 2]]) > 9.6).any(axis=1), 0, 1).astype(np.uint8)
    labels[int((V**2).sum(axis=1).argmin())] = 2
    written(folder, "sheet", V, F, labels)


def large(folder: Path, count: int) -> None:
    """A large animal: ten times as many vertices as others."""
    _animal(folder, 10 * count, _HEAD)
