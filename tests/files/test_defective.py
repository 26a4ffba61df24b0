"""Whatever is wrong with a mesh: it opens, is named, deforms, and goes back into its file."""

import numpy as np
import pytest
from defective import suite

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.analysis.inspection import inspect
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.solver.deformation_result import deform

SUITE = suite()


@pytest.mark.parametrize("suffix", [".obj", ".ply"])
@pytest.mark.parametrize("name", SUITE)
def test_defective_meshes_survive_all_the_way_from_open_mesh_to_save_mesh(name, suffix, tmp_path):
    case = SUITE[name]
    path = tmp_path / f"mesh{suffix}"
    if suffix == ".ply":  # in double precision, which no library writes
        head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(case.V)}\n"
        head += "".join(f"property double {axis}\n" for axis in "xyz")
        head += f"element face {len(case.F)}\nproperty list uchar int vertex_indices\nend_header\n"
        faces = np.zeros(len(case.F), np.dtype([("count", "u1"), ("corners", "<i4", 3)]))
        faces["count"], faces["corners"] = 3, case.F
        path.write_bytes(head.encode() + case.V.astype("<f8").tobytes() + faces.tobytes())
    else:
        save_mesh(Mesh(case.V, case.F), case.V, path)
    mesh = open_mesh(path)
    np.testing.assert_allclose(mesh.V, case.V, rtol=0, atol=1e-13 * np.abs(case.V).max())
    assert case.finding in [finding.kind for finding in inspect(mesh).findings]
    for method in ("arap", "exact"):
        targets = case.targets
        result = deform(mesh.V, mesh.F, case.fixed, targets, method, handle=case.handle, loose="stay")
        assert result.converged
        assert np.isfinite(result.U).all()
        assert np.array_equal(result.U[case.fixed], targets), "held vertices are exactly on target"
        assert np.array_equal(result.U[case.unheld], mesh.V[case.unheld]), "what nothing holds stays"
        if method == "exact":
            assert abs(result.area / result.area_rest - 1.0) <= 1e-10
        save_mesh(mesh, result.U, tmp_path / f"out{suffix}")
        again = open_mesh(tmp_path / f"out{suffix}")
        assert np.array_equal(again.V, result.U)
        assert np.array_equal(again.F, mesh.F)


@pytest.mark.parametrize("name", SUITE)
def test_finding_says_where_the_defect_is(name):
    case = SUITE[name]
    mesh = Mesh(case.V, case.F)
    (finding,) = [finding for finding in inspect(mesh).findings if finding.kind == case.finding]
    assert finding.sentence.endswith(".")
    whole = case.finding in ("tiny", "far away")
    assert len(finding.vertices) == 0 if whole else 0 < len(finding.vertices) <= len(case.V)
    assert (np.diff(finding.vertices) > 0).all()
    expected = {
        "unreferenced vertex": [len(case.V) - 1],
        "free island": len(case.V) - np.arange(3, 0, -1),
        "two pieces, one unheld": np.arange(len(case.V) // 2, len(case.V)),
    }
    if name in expected:
        assert np.array_equal(finding.vertices, expected[name])
