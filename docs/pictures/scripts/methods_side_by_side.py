"""The bottle twisted by 120 degrees by every method, coloured by local area change, with readings below."""

from pathlib import Path

import numpy as np
from stage import Stage

from apd_viewer.figures.rendered_pictures import Picture, draw_shapes
from apd_viewer.files.samples import resource_path
from apd_viewer.files.selections.survey_formats import read_transform
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.geometry.pose.constraints import constraints
from apd_viewer.geometry.solver.deformation_result import deform
from apd_viewer.geometry.solver.methods import COMPARED_METHODS, METHODS
from apd_viewer.presentation.palette import label_colors

SIZE = (2000, 1000)


def draw(stage: Stage) -> Path:
    """Deform without a window, 400 iterations by each method."""
    mesh, labels = stage.sample("bottle")
    rest = face_areas(mesh.V, mesh.F)
    held = constraints(labels, mesh.V, [read_transform(resource_path("bottle-twist-120.def"))])
    shapes, words = [mesh.V], [["Rest"]]
    for method in COMPARED_METHODS:
        iterations = 3 if stage.quick else 400
        result = deform(mesh.V, mesh.F, held.fixed, held.targets, method, iterations, handle=held.handles)
        change = np.abs(face_areas(result.U, mesh.F) / rest - 1)
        total = f"{100 * result.area_error:+.3f}".replace("-0.000", "0.000").replace("+0.000", "0.000")
        shapes.append(result.U)
        words.append(
            [
                METHODS[method].short_title,
                f"total area {total} %",
                f"local change {100 * (change * rest).sum() / rest.sum():.2f} %",
                f"edge strain {100 * result.mean_edge_strain:.2f} %",
                f"handle drift {result.handle_drift:.2f} cm",
            ]
        )
    path = stage.folder / "methods.png"
    drawn = draw_shapes(mesh, [Picture(path, shapes, words, [label_colors(labels)])], SIZE)
    assert drawn or stage.quick
    return path
