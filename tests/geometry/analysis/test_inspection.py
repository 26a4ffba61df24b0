"""What is said about a mesh before it is deformed."""

import numpy as np
import pytest
from meshes import box, grid, rotation, soup, tube

from apd_viewer.geometry.analysis.inspection import inspect
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.mesh import Mesh


def test_inspect_has_nothing_to_say_of_a_clean_mesh():
    found = inspect(Mesh(*box(2, 1, 3)))
    assert (found.vertices, found.faces, found.components) == (24, 44, 1)
    assert found.area == pytest.approx(22)
    assert found.volume == pytest.approx(6)
    assert found.missing_volume_reason is None
    assert found.size == (2.0, 1.0, 3.0)
    assert found.findings == ()


def test_inspect_takes_a_mesh_without_any_extent_all_the_same():
    found = inspect(Mesh(np.ones((3, 3)), np.array([[0, 1, 2]])))
    assert found.area == 0.0
    assert "faces without area" in [finding.kind for finding in found.findings]


def test_inspect_takes_a_soup_for_one_closed_piece_of_repeated_vertices():
    found = inspect(Mesh(*soup(*box(1, 1, 1))))
    assert (found.vertices, found.components) == (36, 1)
    assert found.volume == pytest.approx(1)
    (finding,) = found.findings
    assert finding.sentence == "28 vertices have the same position as another; they move together."
    assert len(finding.vertices) == 36


def test_inspect_counts_what_is_unusual():
    (V, F), n = grid(2, 2), 9
    V = np.vstack([V, V + [0.0, 0.0, 5.0], [[9.0, 9.0, 9.0]]])
    found = inspect(Mesh(V, np.vstack([F, F + n, [[0, 0, 1]]])))
    assert found.components == 2
    assert found.volume is None
    assert found.missing_volume_reason == "the surface is open (16 boundary edges)"
    unused, flat, border, separate = found.findings
    assert unused.sentence.startswith("1 loose vertex")
    assert unused.vertices.tolist() == [18]
    assert flat.sentence.startswith("1 degenerate face")
    assert flat.vertices.tolist() == [0, 1]
    assert border.sentence == "The surface is open: it has 16 boundary edges."
    assert separate.sentence.startswith("2 connected parts")
    assert separate.vertices.tolist() == list(range(9, 18))


@pytest.mark.parametrize("openings", [0, 1])
def test_inspect_says_that_a_surface_is_inside_out(openings):
    V, F = tube(12, 16) if openings else box(2, 1, 3)
    kinds = [finding.kind for finding in inspect(Mesh(V, F[:, ::-1])).findings]
    assert "inside out" in kinds
    assert "inside out" not in [finding.kind for finding in inspect(Mesh(V, F)).findings]


def test_inspect_says_first_what_the_file_is_remarked_for_and_it_stays_with_the_mesh():
    V, F = box(1, 1, 1)
    mesh = Mesh(V, F[:-1], remarks=("Beams were not read.",))
    for same in (mesh, mesh.baked(2 * mesh.V), mesh.without_path()):
        first, border = inspect(same).findings
        assert (first.kind, first.sentence, len(first.vertices)) == ("file", "Beams were not read.", 0)
        assert border.kind == "open borders"


def boxes(*parts):
    """Boxes by their length, corner and whether they face inwards, as one mesh."""
    meshes, count = [], 0
    for length, corner, inwards in parts:
        V, F = box(2, 2, 2)
        meshes.append((0.5 * length * V + corner, (F[:, ::-1] if inwards else F) + count))
        count += len(V)
    return tuple(map(np.vstack, zip(*meshes, strict=True)))


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize(
    ("parts", "volume", "kind"),
    [
        ([(2, 0, False), (1, 5, False)], 9, None),
        ([(2, 0, False), (1, 5, True)], 7, "parts inside out"),
        ([(2, 0, False), (1, 0.5, True)], 7, None),
        ([(2, 0, False), (1, 0.5, False)], 9, "parts counted twice"),
        ([(4, 0, False), (2, 1, True), (1, 1.5, False)], 57, None),
        ([(4, 0, False), (2, 1, True), (1, 1.5, True)], 55, "parts inside out"),
    ],
)
def test_inspect_tells_of_parts_whose_volumes_are_added_with_the_wrong_sign(parts, volume, kind, mirrored):
    V, F = boxes(*parts)
    found = inspect(Mesh(V, F[:, ::-1] if mirrored else F))
    assert found.volume == pytest.approx(-volume if mirrored else volume)
    told = {finding.kind for finding in found.findings} & {"parts inside out", "parts counted twice"}
    assert told == ({kind} if kind else set())


@pytest.mark.parametrize("seed", range(3))
def test_inspect_finds_no_volume_in_an_envelope_however_it_lies(seed):
    rng = np.random.default_rng(seed)
    V = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]) @ rotation(rng.normal(size=3), 1.0).T
    F = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    mesh = Mesh(V + rng.normal(size=3), F)
    assert inspect(mesh).volume == 0.0
    assert RestMesh(mesh.V, mesh.F).volume == 0.0


def test_inspect_says_why_a_surface_has_no_volume():
    """Half of its faces are flipped, so that neither half is the smaller one."""
    V = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    found = inspect(Mesh(V, np.array([[0, 2, 1], [0, 1, 3], [0, 2, 3], [1, 3, 2]])))
    assert found.missing_volume_reason == "the faces are not consistently oriented"
    assert [finding.kind for finding in found.findings] == ["flipped faces"]


def test_inspect_measures_what_has_faces():
    V, F = box(1, 1, 1)
    mesh = Mesh(np.vstack([V, [[1000.0, 0.0, 0.0]]]), F)
    assert inspect(mesh).size == (1.0, 1.0, 1.0)
    assert mesh.named_lengths["L"] == 1.0
