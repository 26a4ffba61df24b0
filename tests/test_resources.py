"""The samples are what their README says, the script reproduces them, and the icons are one family."""

import re
import runpy
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import trimesh

ROOT = Path(__file__).parents[1]
RESOURCES = ROOT / "resources"
CLOSED = ["bottle", "duck", "cushion"]
SAMPLES = [*CLOSED, "cloth"]
TRANSFORMS = [
    *("bottle-twist-60", "bottle-twist-120", "bottle-twist-180", "duck-bend-015", "duck-bend-030"),
    *("cloth-fold", "cushion-press"),
]
ICONS = sorted(path.stem for path in (RESOURCES / "icons").glob("*.svg") if path.stem != "apd-viewer")


def read_mesh(path):
    return trimesh.load(path, process=False, maintain_order=True, force="mesh")


def read_transform(name):
    return np.loadtxt(RESOURCES / f"{name}.def")


@pytest.fixture(scope="module", params=SAMPLES)
def sample(request):
    mesh = read_mesh(RESOURCES / f"{request.param}.obj")
    return mesh, np.loadtxt(RESOURCES / f"{request.param}.sel", dtype=int)


@pytest.mark.parametrize("name", CLOSED)
def test_resources_have_samples_that_are_closed_and_outward(name):
    mesh = read_mesh(RESOURCES / f"{name}.obj")
    assert mesh.is_watertight
    assert mesh.euler_number == 2
    assert mesh.volume > 0


def test_resources_have_a_cloth_that_is_a_disc_and_looks_upwards():
    mesh = read_mesh(RESOURCES / "cloth.obj")
    assert mesh.euler_number == 1
    assert len(mesh.outline().entities) == 1
    flat = mesh.vertices[mesh.faces][:, :, 1].min(axis=1) > 0.1
    assert flat.sum() > len(mesh.faces) / 2
    assert (mesh.face_normals[flat, 1] > 0).all()


def test_resources_have_samples_that_are_single_and_oriented(sample):
    mesh, _ = sample
    assert mesh.is_winding_consistent
    assert (
        len(trimesh.graph.connected_components(mesh.edges_unique, nodes=np.arange(len(mesh.vertices)))) == 1
    )


@pytest.mark.parametrize("name", ["cloth", "cushion"])
def test_resources_have_fabric_whose_triangles_have_no_preferred_direction(name):
    mesh = read_mesh(RESOURCES / f"{name}.obj")
    ends = mesh.vertices[mesh.edges_unique][:, :, [2, 0]]
    inner = np.hypot(*ends.mean(axis=1).T) < 8.0  # nearly flat, and away from hem and piping
    angle = np.arctan2(*np.diff(ends, axis=1)[inner, 0].T)
    # Moduli are tensors of order 4 at most: six directions that are alike, as of a lattice, are none to them.
    assert max(abs(np.exp(1j * k * angle).mean()) for k in (2, 4)) < 0.05


def test_resources_have_samples_of_a_handy_size_that_stand_on_the_ground(sample):
    mesh, _ = sample
    assert 8_000 <= len(mesh.vertices) <= 15_000
    assert len(np.unique(mesh.vertices, axis=0)) == len(mesh.vertices)
    assert mesh.vertices[:, 1].min() == pytest.approx(0, abs=1e-3)


def test_resources_have_samples_whose_triangles_are_well_shaped(sample):
    mesh, _ = sample
    smallest = np.degrees(mesh.face_angles.min(axis=1))
    assert np.percentile(smallest, 1) > 30
    assert smallest.min() > 20


def test_resources_have_selections_of_one_base_and_one_handle(sample):
    mesh, labels = sample
    assert len(labels) == len(mesh.vertices)
    assert set(labels) == {0, 1, 2}
    for label in (0, 2):
        edges = mesh.edges_unique[(labels[mesh.edges_unique] == label).all(axis=1)]
        assert len(trimesh.graph.connected_components(edges, nodes=np.flatnonzero(labels == label))) == 1


def test_resources_have_a_bottle_that_holds_half_a_liter():
    assert read_mesh(RESOURCES / "bottle.obj").volume == pytest.approx(500, rel=1e-6)


@pytest.mark.parametrize("name", TRANSFORMS)
def test_resources_have_transforms_that_are_rigid(name):
    M = read_transform(name)
    np.testing.assert_allclose(M[:3, :3] @ M[:3, :3].T, np.eye(3), atol=1e-12)
    assert np.linalg.det(M[:3, :3]) > 0
    assert M[3].tolist() == [0, 0, 0, 1]


@pytest.mark.parametrize("degrees", [60, 120, 180])
def test_resources_have_a_twist_that_turns_about_the_bottle_s_axis(degrees):
    M = read_transform(f"bottle-twist-{degrees}")
    assert np.degrees(np.arccos((np.trace(M) - 2) / 2)) == pytest.approx(degrees)
    assert (M @ [0, 5, 0, 1]).tolist() == [0, 5, 0, 1]


def test_resources_have_a_second_bend_that_is_twice_the_first():
    first, second = (read_transform(f"duck-bend-{share}")[:3, 3] for share in ("015", "030"))
    np.testing.assert_allclose(second, 2 * first, rtol=1e-12)


@pytest.mark.night
def test_resources_have_a_script_that_reproduces_the_samples(tmp_path):
    runpy.run_path(str(RESOURCES / "make_samples.py"))["main"](tmp_path)
    for name in SAMPLES:
        made, kept = read_mesh(tmp_path / f"{name}.obj"), read_mesh(RESOURCES / f"{name}.obj")
        np.testing.assert_array_equal(made.faces, kept.faces)
        np.testing.assert_allclose(made.vertices, kept.vertices, atol=1e-6)
        assert (tmp_path / f"{name}.sel").read_text() == (RESOURCES / f"{name}.sel").read_text()
    for name in TRANSFORMS:
        np.testing.assert_allclose(np.loadtxt(tmp_path / f"{name}.def"), read_transform(name), atol=1e-6)


def test_resources_have_every_icon_that_is_used_and_no_other():
    sources = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "apd_viewer" / "ui").rglob("*.py"))
    families = tuple(re.findall(r'f"([a-z]+-)\{', sources))  # named after axes, overlays, panels and others
    assert [name for name in ICONS if f'"{name}"' not in sources and not name.startswith(families)] == []
    assert set(re.findall(r'icon\("([a-z-]+)"', sources)) <= set(ICONS)


def test_resources_have_no_two_equal_icons():
    drawings = [(RESOURCES / "icons" / f"{name}.svg").read_bytes() for name in ICONS]
    assert len(set(drawings)) == len(ICONS)


@pytest.mark.parametrize("name", ICONS)
def test_resources_have_icons_of_one_family(name):
    root = ElementTree.parse(RESOURCES / "icons" / f"{name}.svg").getroot()
    assert root.get("viewBox") == "0 0 20 20"
    assert root.get("stroke") == "currentColor"
    assert root.get("stroke-width") == "1.5"
    colours = {element.get(key, "none") for element in root.iter() for key in ("fill", "stroke")}
    assert colours <= {"none", "currentColor", "baseColor", "handleColor", "regionColor"}


def test_resources_have_an_application_icon_in_the_colors_of_base_and_handle():
    path = RESOURCES / "icons" / "apd-viewer.svg"
    assert ElementTree.parse(path).getroot().get("viewBox") == "0 0 64 64"
    assert {"#0072B2", "#D55E00"} <= set(path.read_text().split('"'))
