"""Samples come ready to be dragged, and what is made of fabric behaves as fabric."""

import numpy as np
import pytest

from apd_viewer.files.samples import SAMPLES, resource
from apd_viewer.files.selections.survey_formats import read_transform
from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.geometry.pose.screw_motion import path_of
from apd_viewer.session.file_jobs import opened_sample
from apd_viewer.session.processes.deforming import deformation_of


@pytest.mark.parametrize("name", SAMPLES)
def test_opened_sample_needs_nothing_but_a_drag(name):
    document = opened_sample(name).document
    assert document.problem is None
    assert document.contact
    assert not document.posed
    rest = deformation_of(document, document.constraints()).frame()
    np.testing.assert_array_equal(rest.U, document.mesh.V)


def test_opened_sample_cloth_folds_about_the_pivot_of_its_handle():
    document = opened_sample("cloth").document
    V, labels = document.mesh.V, document.labels
    fold, pivot = read_transform(resource("cloth-fold.def")), document.pivot(0)
    np.testing.assert_allclose(fold @ [*pivot, 1.0], [*pivot, 1.0], atol=1e-9)
    folded = V[labels == 2] @ fold[:3, :3].T + fold[:3, 3]
    assert np.ptp(folded[:, 2]) == pytest.approx(np.ptp(V[labels == 0][:, 2]), abs=0.5)
    assert folded[:, 2].min() > 0.0
    assert folded[:, 1].min() > V[:, 1].max()


@pytest.mark.parametrize(
    ("name", "motion", "share"),
    [("cloth", "fold", 0.1), pytest.param("cushion", "press", 0.2, marks=pytest.mark.night)],
)
def test_opened_sample_of_fabric_keeps_its_areas_and_never_crosses_itself(name, motion, share):
    document = opened_sample(name).document
    V, F = document.mesh.V, document.mesh.F
    rest, solver = face_areas(V, F), deformation_of(document, document.constraints())
    path = path_of(read_transform(resource(f"{name}-{motion}.def")), document.pivot(0), either_way=True)
    for part in np.linspace(0.0, share, 7)[1:]:
        solver.aim(document.with_pose(0, path.at(part)).constraints().targets)
        for _ in range(2):
            solver.iterate()
            U = solver.frame().U
            now = face_areas(U, F)
            assert abs(now.sum() / rest.sum() - 1.0) < 1e-9
            assert np.abs(now - rest).sum() < 3e-3 * rest.sum()
            assert not len(crossings(U, F))
    assert np.abs(U - V).max() > 0.9
