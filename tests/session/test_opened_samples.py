"""Samples come ready to be dragged, and what is made of fabric behaves as fabric."""

import numpy as np
import pytest

from apd_viewer.files.samples import SAMPLES, resource_path
from apd_viewer.files.selections.survey_formats import read_transform
from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.geometry.pose.screw_motion import screw_path
from apd_viewer.session.file_jobs import sample_state
from apd_viewer.session.processes.document_deformation import deformation_of


@pytest.mark.parametrize("name", SAMPLES)
def test_sample_state_needs_nothing_but_a_drag(name):
    document = sample_state(name).document
    assert document.paint_problem is None
    assert document.settings.contact
    assert not document.is_posed
    rest = deformation_of(document, document.constraints()).frame()
    np.testing.assert_array_equal(rest.U, document.mesh.V)


def test_sample_state_cloth_folds_about_the_pivot_of_its_handle():
    document = sample_state("cloth").document
    V, labels = document.mesh.V, document.labels
    fold, pivot = read_transform(resource_path("cloth-fold.def")), document.pivot(0)
    np.testing.assert_allclose(fold @ [*pivot, 1.0], [*pivot, 1.0], atol=1e-9)
    folded = V[labels == 2] @ fold[:3, :3].T + fold[:3, 3]
    assert np.ptp(folded[:, 2]) == pytest.approx(np.ptp(V[labels == 0][:, 2]), abs=0.5)
    assert folded[:, 2].min() > 0.0
    assert folded[:, 1].min() > V[:, 1].max()


@pytest.mark.parametrize(
    ("name", "motion", "share"),
    [("cloth", "fold", 0.1), pytest.param("cushion", "press", 0.2, marks=pytest.mark.night)],
)
def test_sample_state_of_fabric_keeps_its_areas_and_never_crosses_itself(name, motion, share):
    document = sample_state(name).document
    V, F = document.mesh.V, document.mesh.F
    rest, solver = face_areas(V, F), deformation_of(document, document.constraints())
    path = screw_path(
        read_transform(resource_path(f"{name}-{motion}.def")), document.pivot(0), allows_half_turn=True
    )
    for part in np.linspace(0.0, share, 7)[1:]:
        solver.aim(document.with_pose(0, path.pose_at(part)).constraints().targets)
        for _ in range(2):
            solver.iterate()
            U = solver.frame().U
            now = face_areas(U, F)
            assert abs(now.sum() / rest.sum() - 1.0) < 1e-9
            assert np.abs(now - rest).sum() < 3e-3 * rest.sum()
            assert not len(crossings(U, F))
    assert np.abs(U - V).max() > 0.9
