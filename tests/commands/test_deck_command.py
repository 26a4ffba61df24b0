"""The command deck: of meshes and sessions, and computed by CalculiX."""

import numpy as np
import pytest
import trimesh
from decks import ReadDeck, computed, needs_ccx
from meshes import box, ends, rotation, tube

from apd_viewer.__main__ import main
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.samples import resource_path
from apd_viewer.files.selections.selection_files import read_selection_file
from apd_viewer.session.model.document_parts import with_selection
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.view import View
from apd_viewer.session.quantities.wall import WallText
from apd_viewer.session.storage.session_file import open_session, save_session

_SIX_DIGITS = 1e-5  # of the largest number in a result of CalculiX


@pytest.fixture
def deck(tmp_path, capsys):
    """Run the command; its status, what it said, and the path of the deck."""

    def run(*words):
        out = tmp_path / "out.inp"
        status = main([str(word) for word in ("deck", *words, "-o", out)])
        said = capsys.readouterr()
        return status, said.out + said.err, out

    return run


def bar(folder, V, F):
    trimesh.Trimesh(V, F, process=False).export(folder / "bar.off")
    labels = np.ones(len(V), dtype=int)
    base, top = ends(V)
    labels[base], labels[top] = 0, 2
    np.savetxt(folder / "bar.sel", labels, fmt="%d")
    return folder / "bar.off", "--selection", folder / "bar.sel"


def where_ours_are(path):
    """The held nodes of a computed deck against those in its text."""
    _, moved = computed(path)
    ends = ReadDeck(path.read_text()).ends()
    assert ends
    there, here = np.array([moved[node] for node in ends]), np.array(list(ends.values()))
    assert np.abs(there - here).max() <= _SIX_DIGITS * np.abs(here).max()
    return moved, ends


@needs_ccx
@pytest.mark.parametrize(
    ("element", "size"), [pytest.param("S3", (24, 26), marks=pytest.mark.night), ("S6", (10, 4))]
)
def test_deck_of_a_tube_twisted_in_two_steps_is_computed_by_calculix(deck, tmp_path, element, size):
    V, F = tube(*size)
    mesh = bar(tmp_path, V, F)
    words = "--twist", "40deg", "--unit", "mm", "--thickness", "0.1", "--elements", element
    status, said, out = deck(*mesh, *words)
    assert status == 0, said
    assert len(ReadDeck(out.read_text()).steps) == 2
    moved, ends = where_ours_are(out)
    assert set(moved) == set(ReadDeck(out.read_text()).nodes)
    moved = {node: moved[node] for node in range(1, len(V) + 1)}
    free = [node for node in moved if node not in ends]
    assert np.abs([moved[node] - V[node - 1] for node in free]).max() > 0.5, "the free ones follow"


@needs_ccx
def test_deck_of_a_wall_distribution_stretches_by_its_integral_in_calculix(deck, tmp_path):
    """A tube pulled along its axis, of a thickness that grows along it, stretches most where it is thin."""
    V, F = tube(16, 12, height=3.0)
    mesh, pull = bar(tmp_path, V, F), np.eye(4)
    pull[2, 3] = 3e-3
    np.savetxt(tmp_path / "pull.def", pull)
    (tmp_path / "walls.csv").write_text("z,thickness\n0,0.02\n3,0.06\n")
    words = "--transform", tmp_path / "pull.def", "--thickness", tmp_path / "walls.csv", "--poisson", "0"
    status, said, out = deck(*mesh, *words)
    assert status == 0, said
    assert "*NODAL THICKNESS" in out.read_text()
    moved = where_ours_are(out)[0]
    base, top = ends(V)
    low, high = V[base, 2].max(), V[top, 2].min()
    z = V[:, 2]
    free = np.flatnonzero((z > low + 1e-9) & (z < high - 1e-9))
    found = np.array([moved[node + 1][2] for node in free]) - z[free]
    share = np.log((0.02 + z[free] / 75.0) / (0.02 + low / 75.0))
    expected = 3e-3 * share / np.log((0.02 + high / 75.0) / (0.02 + low / 75.0))
    assert np.abs(found - expected).max() < 0.01 * 3e-3


@needs_ccx
@pytest.mark.parametrize("kinds", [2, 200])
def test_deck_of_a_modulus_from_place_to_place_stretches_by_its_integral_in_calculix(deck, tmp_path, kinds):
    """A tube pulled along its axis stretches in inverse proportion to its modulus, of few or many kinds."""
    V, F = tube(16, 12, height=3.0)
    mesh, pull = bar(tmp_path, V, F), np.eye(4)
    pull[2, 3] = 3e-3
    np.savetxt(tmp_path / "pull.def", pull)
    height = V[F][:, :, 2].mean(axis=1)
    moduli = np.where(height < 1.5, 1.0, 3.0) * np.linspace(1.0, 1.0 + 1e-4 * (kinds > 2), len(F))
    rows = (f"{k},0.05,{young!r}" for k, young in enumerate(moduli.tolist()))
    (tmp_path / "walls.csv").write_text("\n".join(["triangle,thickness,young", *rows]))
    words = "--transform", tmp_path / "pull.def", "--thickness", tmp_path / "walls.csv", "--poisson", "0"
    status, said, out = deck(*mesh, *words, "--unit", "mm")
    assert status == 0, said
    assert 2 <= out.read_text().count("*MATERIAL") <= 50
    moved = where_ours_are(out)[0]
    base, top = ends(V)
    low, high = V[base, 2].max(), V[top, 2].min()
    middle = np.flatnonzero(np.abs(V[:, 2] - 1.5) < 1e-9)
    found = np.array([moved[node + 1][2] for node in middle]) - 1.5
    share = 3.0 * (1.5 - low) / (3.0 * (1.5 - low) + high - 1.5)
    assert found == pytest.approx(3e-3 * share, rel=0.02)


@pytest.mark.night
@needs_ccx
def test_deck_of_the_bottle_is_computed_by_calculix(deck):
    words = (
        "--selection",
        resource_path("bottle.sel"),
        "--twist",
        "1deg",
        "--unit",
        "cm",
        "--material",
        "pet-bottle",
        "--elements",
        "S3",
    )
    status, said, out = deck(resource_path("bottle.obj"), "--selection", resource_path("bottle.sel"), *words)
    assert status == 0, said
    moved, _ = where_ours_are(out)
    assert np.isfinite(np.array(list(moved.values()))).all()


def test_deck_command_writes_a_session_with_its_wall_and_its_pose(deck, tmp_path):
    V, F = box(2, 2, 6)
    mesh = bar(tmp_path, V, F)
    matrix = np.eye(4)
    matrix[:3, :3] = rotation((0, 0, 1), 0.3)
    np.savetxt(tmp_path / "turn.def", matrix)
    assert deck(*mesh, "--transform", tmp_path / "turn.def", "--thickness", "0.3")[0] == 0
    of_mesh = ReadDeck((tmp_path / "out.inp").read_text())
    read = open_mesh(mesh[0])
    state = initial_state(read)
    document = with_selection(state.document, read_selection_file(mesh[2], read))
    state = state.updated(document.with_pose(0, matrix))
    session = tmp_path / "bar.apd"
    save_session(session, state, View(unit="mm", wall=WallText("0.3", "1.2")))
    status, said, out = deck(session)
    assert status == 0, said
    assert "out.inp" in said
    found = ReadDeck(out.read_text())
    assert found.nodes == of_mesh.nodes
    assert found.steps == of_mesh.steps
    assert found.values["SHELL SECTION"] == [0.3]
    assert found.values["DENSITY"] == pytest.approx([1.2e-9])
    assert open_session(session)[0].document.is_posed
    assert deck(session, "--twist", "9deg", "--thickness", "0.4")[0] == 0
    assert ReadDeck(out.read_text()).values["SHELL SECTION"] == [0.4]


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ((), "is not a session"),
        (("--selection", "bar.sel"), "is not a session"),
        (("--selection", "bar.sel", "--twist", "9deg", "--young", "2GPa"), "add --unit mm"),
        (("--selection", "bar.sel", "--twist", "9deg", "--steps", "0"), "1 to 1000 steps"),
        (("--selection", "bar.sel", "--twist", "9deg", "--transform", "a.def"), "Give either --transform"),
        (("--selection", "bar.sel", "--twist", "9deg", "--thickness=-1"), "thickness greater than 0"),
        (("--selection", "bar.sel", "--twist", "9deg", "--material", "gold"), "no material"),
    ],
)
def test_deck_command_says_in_one_line_what_makes_none(words, says, deck, tmp_path, monkeypatch):
    mesh = bar(tmp_path, *box(2, 2, 6))
    monkeypatch.chdir(tmp_path)
    status, said, out = deck(mesh[0], *words)
    assert status == 2
    assert says in said
    assert said.count("\n") == 1
    assert not out.exists()
