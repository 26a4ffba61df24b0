"""FE decks: what is in them is the mesh, its paint and its poses, whoever reads them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from decks import ReadDeck
from meshes import box, ends, rotation

from apd_viewer.errors import InputError
from apd_viewer.files.fe_deck import SIX_NODES, THREE_NODES, write_deck
from apd_viewer.files.selections.selection import Selection
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import transform
from apd_viewer.session.deck_setup import deck_of, deck_wall
from apd_viewer.session.model.document_parts import with_selection
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.posing.motion_text import motion_steps
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import WallText
from apd_viewer.session.quantities.wall_material import wall_material

V, F = box(2, 2, 6)
BASE, TOP = ends(V)
BARE = deck_wall(WallText(), Unit.NONE, 1.0)


def painted(V=V, F=F, second=None, name="a\n*STEP.obj"):
    """State of a mesh held at both ends, the lower half a region."""
    labels, member = np.ones(len(V), dtype=np.uint8), (V[:, 2] <= 3).astype(np.uint8)
    base, top = ends(V)
    labels[base], labels[top] = 0, 2
    if second is not None:
        labels[second] = 3
    state = initial_state(Mesh(V, F, Path(name)))
    selection = Selection.with_default_names(labels, member, regions=["half, “lower”, *STEP"])
    return state.updated(with_selection(state.document, selection))


@pytest.fixture
def written(tmp_path):
    def write(document, wall=BARE, steps=None, motion=(), element=THREE_NODES):
        path = tmp_path / "out.inp"
        write_deck(path, deck_of(document, wall, steps, motion)._replace(element=element))
        return ReadDeck(path.read_text(encoding="ascii"))

    return write


def test_write_deck_makes_no_card_of_the_name_of_the_mesh(written):
    deck = written(painted(name="*STEP.obj").document)
    assert deck.keywords.count("STEP") == 1
    assert "STEP.OBJ" not in deck.keywords
    assert "*STEP.obj" in deck.text


def posed(document, angle=0.4, shift=(0.1, 0.2, 0.3)):
    M = np.eye(4)
    M[:3, :3], M[:3, 3] = rotation((1, 2, 0), angle), shift
    return document.with_pose(0, M), M


def test_deck_of_has_the_mesh_and_its_paint_as_nodes_elements_and_sets(written):
    deck = written(painted().document)
    assert np.array_equal([deck.nodes[k + 1] for k in range(len(V))], V)
    assert np.array_equal([deck.elements[k + 1] for k in range(len(F))], F + 1)
    assert deck.sets["BASE"] == (np.sort(BASE) + 1).tolist()
    assert deck.sets["HANDLE"] == (np.sort(TOP) + 1).tolist()
    lower = np.flatnonzero((V[F][:, :, 2] <= 3).all(axis=1))
    assert deck.sets["REGION_1"] == (lower + 1).tolist()
    assert set(deck.sets) == {"BASE", "HANDLE", "REGION_1"}, "names are no cards"
    assert deck.keywords.count("STEP") == 1


def test_deck_of_ends_held_nodes_where_the_pose_has_them(written):
    second = np.flatnonzero(V[:, 2] == 3)
    document, M = posed(painted(second=second).document)
    ends = written(document, steps=1).ends()
    assert np.abs([ends[k + 1] - V[k] for k in BASE]).max() == 0
    assert np.abs([ends[k + 1] for k in TOP] - transform(M, V[TOP])).max() < 1e-10
    assert np.abs([ends[k + 1] - V[k] for k in second]).max() == 0, "the handle that stays is held"
    assert set(ends) == {k + 1 for k in (*BASE, *TOP, *second)}


def test_deck_of_has_a_node_on_every_edge_that_is_held_with_both_its_ends(written):
    """Base and handle meet at one side: an edge from one to the other is free."""
    second = np.flatnonzero(V[:, 2] == 1)
    document = posed(painted(second=second).document)[0].with_pose(1, np.diag([1.0, 1.0, 2.0, 1.0]))
    coarse, fine = (written(document, element=element) for element in (THREE_NODES, SIX_NODES))
    middles = {}
    for number, (*corners, ab, bc, ca) in fine.elements.items():
        assert tuple(corners) == coarse.elements[number]
        for node, edge in zip((ab, bc, ca), zip(corners, np.roll(corners, -1), strict=True), strict=True):
            assert middles.setdefault(node, set(edge)) == set(edge)
    assert len(middles) == len(V) + len(F) - 2, "of each edge one node [Euler]"
    assert min(middles) > max(coarse.nodes)
    assert set(fine.nodes) == set(middles) | set(coarse.nodes)
    ends = {node: coarse.nodes[node] for node in coarse.nodes} | coarse.ends()
    for name in ("BASE", "HANDLE", "HANDLE_2"):
        own = set(coarse.sets[name])
        assert set(fine.sets[name]) == own | {node for node, edge in middles.items() if edge <= own}
    for node, where in fine.ends().items():
        edge = middles.get(node, {node})
        np.testing.assert_allclose(where, np.mean([ends[end] for end in edge], axis=0), atol=1e-10)
        np.testing.assert_allclose(fine.nodes[node], np.mean([fine.nodes[end] for end in edge], axis=0))
    assert set(fine.ends()) == {node for name in ("BASE", "HANDLE", "HANDLE_2") for node in fine.sets[name]}


def test_deck_of_walks_a_turn_in_steps_on_its_arc(written):
    state = painted()
    motion = motion_steps(state.document, "twist 100deg", Unit.NONE)
    deck = written(state.document, motion=motion)
    assert len(deck.steps) == 4
    centre = np.append(V[TOP].mean(axis=0)[:2], 0.0)
    for step, part in enumerate((0.25, 0.5, 0.75, 1.0)):
        R = rotation((0, 0, 1), part * np.radians(100))
        there = (V[TOP] - centre) @ R.T + centre
        ends = deck.ends(step)
        assert np.abs([ends[k + 1] for k in TOP] - there).max() < 1e-10
    assert len(written(state.document, steps=2, motion=motion).steps) == 2


def test_deck_of_keeps_in_its_steps_what_is_held_and_no_more():
    """A thousand steps of all vertices of a large mesh would not fit into memory."""
    deck = deck_of(posed(painted().document)[0], BARE, 1000)
    assert len(deck.steps) == 1000
    assert all([x.shape for x in step] == [BASE.shape + (3,), TOP.shape + (3,)] for step in deck.steps)
    assert all(x.base is None for step in deck.steps for x in step), "no view of a larger array"


def test_deck_of_leads_a_base_to_where_it_was_gripped(written):
    state = painted()
    U = V + [0.0, 0.25, 0.0]
    ends = written(replace(state.document, initial_positions=U)).ends()
    assert np.abs([ends[k + 1] - U[k] for k in BASE]).max() < 1e-12


def test_deck_of_joins_seams_and_leaves_out_what_cannot_be_computed(written):
    corners = V[F].reshape(-1, 3)  # each triangle with corners of its own
    away = np.concatenate([corners, V + 100.0])  # a part that nothing holds
    triangles = np.concatenate([np.arange(F.size).reshape(-1, 3), F + F.size, [[0, 0, 1]]])
    base, top = ends(V)
    state = initial_state(Mesh(away, triangles))
    labels = np.ones(len(away), dtype=np.uint8)
    labels[: F.size][np.isin(F.ravel(), base)] = 0
    labels[: F.size][np.isin(F.ravel(), top)] = 2
    document = with_selection(state.document, Selection.with_default_names(labels))
    deck = written(document)
    assert len(deck.elements) == len(F)
    assert len(deck.nodes) == len(V), "of each position one node"
    assert len(deck.sets["BASE"]) == len(base)
    assert f"Left out: {len(F)} triangles of connected parts without base or handle." in deck.text
    assert "Left out: 1 triangles without area." in deck.text


MM_PET = {"thickness": 0.3, "young": 3400.0, "density": 1.36e-9, "poisson": 0.38}


@pytest.mark.parametrize(
    ("unit", "factor", "says"),
    [
        (Unit.MILLIMETRE, 1.0, "density tonne/mm3"),
        (Unit.METRE, 1e-3, "mass kg"),
        (Unit.CENTIMETRE, 0.1, "N/cm2"),
        (Unit.INCH, 1 / 25.4, "N/in2"),
    ],
)
def test_deck_wall_is_in_consistent_units(unit, factor, says, written):
    """Of one material: N/mm² times mm² and N s²/mm⁴ times mm⁴ in every other unit of length."""
    wall = deck_wall(WallText(material=wall_material("pet-bottle")), unit, 1.0)
    deck = written(painted().document, wall)
    assert deck.values["SHELL SECTION"] == pytest.approx([0.3 * factor])
    assert deck.values["ELASTIC"] == pytest.approx([3400.0 / factor**2, 0.38])
    assert deck.values["DENSITY"] == pytest.approx([1.36e-9 / factor**4])
    assert says in deck.text
    assert "No " not in deck.text


def test_deck_wall_takes_what_is_typed_before_the_material(written):
    words = WallText("0.5mm", "1 g/cm3", "2GPa", "0.3", material=wall_material("pet-bottle"))
    deck = written(painted().document, deck_wall(words, Unit.METRE, 1.0))
    assert deck.values["SHELL SECTION"] == pytest.approx([0.5e-3])
    assert deck.values["ELASTIC"] == pytest.approx([2e9, 0.3])
    assert deck.values["DENSITY"] == pytest.approx([1000.0])


def test_deck_wall_says_of_defaults_that_they_are_defaults(written):
    deck = written(painted().document, deck_wall(WallText(), Unit.NONE, 7.0))
    assert deck.values["SHELL SECTION"] == [0.007]
    assert deck.values["ELASTIC"] == [1.0, 0.4]
    assert "DENSITY" not in deck.values
    for quantity in ("thickness", "Young's modulus", "Poisson's ratio", "density"):
        assert f"No {quantity} was given" in deck.text
    assert "which is not known" in deck.text


def test_write_deck_fits_numbers_into_the_twenty_characters_that_are_read(written):
    tiny = V * 1.2345678901234567e-30
    deck = written(painted(tiny - tiny.mean(axis=0), F).document)
    words = [
        word.strip() for line in deck.text.splitlines() if line[:1].isdigit() for word in line.split(",")
    ]
    assert max(map(len, words)) <= 20
    assert max(len(line) for line in deck.text.splitlines()) < 132


def test_write_deck_keeps_the_digits_of_a_mesh_far_from_the_origin(written):
    far = V / 7.0 + np.array([8.1e6, -4.3e6, 8.2e6])
    deck = written(painted(far, F).document)
    assert np.abs(np.array([deck.nodes[k + 1] for k in range(len(V))]) - far).max() < 2e-8
    words = [
        word.strip() for line in deck.text.splitlines() if line[:1].isdigit() for word in line.split(",")
    ]
    assert max(map(len, words)) <= 20


def test_write_deck_writes_the_same_deck_twice_as_the_same_file(written):
    assert written(painted().document).text == written(painted().document).text


def test_deck_of_refuses_in_a_sentence_what_cannot_be_a_deck(tmp_path):
    state = painted()
    deck = deck_of(state.document, BARE)
    with pytest.raises(InputError, match=r"use the ending \.inp"):
        write_deck(tmp_path / "out.txt", deck)
    with pytest.raises(InputError, match="There is no base"):
        deck_of(initial_state(Mesh(V, F)).document, BARE)
    with pytest.raises(InputError, match="1 to 1000 steps"):
        deck_of(state.document, BARE, 0)
    for words in (
        WallText(young="2GPa"),
        WallText("1", "1.3"),
        WallText(material=wall_material("hdpe")),
    ):
        with pytest.raises(InputError, match="needs the unit of the mesh"):
            deck_wall(words, Unit.NONE, 1.0)
