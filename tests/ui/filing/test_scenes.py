"""Scenes of glTF and 3MF in the window: their unit, their places, and what is exported from them."""

import zipfile

import numpy as np
import pytest
from driving import document, idle
from gltf_scenes import GltfScene
from meshes import box
from PySide6.QtCore import Qt

from apd_viewer.files.meshes import open_mesh
from apd_viewer.session.quantities.units import Unit

V, F = box(1, 2, 2)
CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"


@pytest.fixture
def window(kept_window):
    """The window of all tests of the file."""
    return kept_window


@pytest.fixture
def instanced(tmp_path):
    """A box and its mirror image, which are one mesh."""
    scene = GltfScene()
    mesh = scene.mesh(V, F)
    scene.node(mesh=mesh)
    scene.node(mesh=mesh, translation=[-3, 0, 0], scale=[-1, 1, 1])
    return scene.write(tmp_path / "two.glb")


@pytest.fixture
def of_inches(tmp_path):
    vertices = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in V.tolist())
    triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in F.tolist())
    mesh = f"<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>"
    model = f'<model unit="inch" xmlns="{CORE}"><resources><object id="1">{mesh}</object></resources>'
    with zipfile.ZipFile(tmp_path / "part.3mf", "w") as archive:
        archive.writestr("3D/3dmodel.model", model + '<build><item objectid="1"/></build></model>')
    return tmp_path / "part.3mf"


def opened(qtbot, window, path):
    window.files.open_path(path)
    idle(qtbot, window)


def test_unit_button_shows_the_stated_unit_until_another_is_chosen(qtbot, window, of_inches):
    opened(qtbot, window, of_inches)
    assert window.panel.area.unit.text() == "in"
    assert window.panel.area.area.text().endswith("\N{NO-BREAK SPACE}in²")
    window.panel.area.unit.chosen.emit(Unit.MILLIMETRE)
    opened(qtbot, window, of_inches)
    assert window.panel.area.unit.text() == "mm"


def test_export_turns_inches_into_meters_in_a_glb(qtbot, window, of_inches, tmp_path):
    opened(qtbot, window, of_inches)
    window.session.files.export(tmp_path / "out.glb")
    idle(qtbot, window)
    np.testing.assert_allclose(open_mesh(tmp_path / "out.glb").V, 0.0254 * V, rtol=1e-6)
    opened(qtbot, window, tmp_path / "out.glb")
    assert window.panel.area.unit.text() == "m"


def test_findings_controller_says_that_an_opened_mesh_is_in_several_places(
    qtbot, window, instanced, tmp_path
):
    opened(qtbot, window, instanced)
    assert document(window).mesh.unit == "m"
    qtbot.mouseClick(window.findings.badge, Qt.MouseButton.LeftButton)
    assert "one mesh in 2 places" in window.findings.list.rows[0].accessibleName()
    window.session.files.export(tmp_path / "same.glb")
    idle(qtbot, window)
    assert (tmp_path / "same.glb").read_bytes() == instanced.read_bytes()
