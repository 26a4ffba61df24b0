"""Scenes of glTF and 3MF on the command line: what they are, and what cannot be kept, before the work."""

import json

import numpy as np
import pytest
from gltf_scenes import GltfScene
from meshes import box

from apd_viewer.__main__ import main
from apd_viewer.files.meshes import open_mesh

V, F = box(1, 2, 2)


def two_places(path):
    """Two boxes of one mesh, the second one mirrored."""
    scene = GltfScene()
    mesh = scene.mesh(V, F)
    scene.node(mesh=mesh)
    scene.node(mesh=mesh, translation=[-3, 0, 0], scale=[-1, 1, 1])
    return scene.write(path)


def quantized(path):
    scene = GltfScene(extensionsRequired=["KHR_mesh_quantization"])
    scene.node(mesh=scene.mesh(scene.accessor(V, "u2"), F))
    return scene.write(path)


def test_info_tells_unit_places_and_what_another_format_loses(tmp_path, capsys):
    path = two_places(tmp_path / "a.glb")
    document_of_it = ["info", str(path)]
    assert main(document_of_it) == 0
    said = capsys.readouterr().out
    assert "5 x 2 x 2\N{NO-BREAK SPACE}m\n" in said
    assert "volume  8\N{NO-BREAK SPACE}m³\n" in said
    assert "also    instances; exporting to any format but GLB loses them\n" in said
    assert "one mesh in 2 places" in said
    main([*document_of_it, "--json"])
    found = json.loads(capsys.readouterr().out)
    assert found["unit"] == "m"
    assert found["volume"] == pytest.approx(8.0)
    assert found["findings"][0]["kind"] == "file"


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
@pytest.mark.parametrize(
    ("build", "words"),
    [(two_places, "several places that now differ"), (quantized, "stores rounded positions")],
)
def test_deform_refuses_a_file_that_cannot_take_the_shape_before_the_work(
    build, words, suffix, tmp_path, capsys, monkeypatch
):
    path = build(tmp_path / f"a{suffix}")
    mesh = open_mesh(path)
    labels = np.where(mesh.V[:, 2] == 0, 0, np.where(mesh.V[:, 2] == 2, 2, 1))
    (tmp_path / "a.sel").write_text(" ".join(map(str, labels)))
    call = ["deform", str(path), "--selection", str(tmp_path / "a.sel"), "--move=0 0 0.1m"]
    with monkeypatch.context() as patch:
        patch.setattr("apd_viewer.commands.deform_command.deform", lambda *_, **__: pytest.fail("it began"))
        assert main([*call, "-o", str(tmp_path / f"b{suffix}")]) == 2
    said = capsys.readouterr()
    assert words in said.err
    assert not (tmp_path / f"b{suffix}").exists()
    assert main([*call, "--iterations=1", "-o", str(tmp_path / "b.obj")]) == 0
    assert np.abs(open_mesh(tmp_path / "b.obj").V[mesh.V[:, 2] == 2, 2] - 2.1).max() < 1e-9


def test_deform_takes_the_unit_of_an_option_before_that_of_the_file(tmp_path, capsys):
    scene = GltfScene()
    scene.node(mesh=scene.mesh(V, F))
    path = scene.write(tmp_path / "a.glb")
    labels = np.where(V[:, 2] == 0, 0, np.where(V[:, 2] == 2, 2, 1))
    (tmp_path / "a.sel").write_text(" ".join(map(str, labels)))
    call = ["deform", str(path), "--selection", str(tmp_path / "a.sel"), "--iterations=1"]
    call += ["--report", str(tmp_path / "r.json"), "-o", str(tmp_path / "b.glb")]
    for unit, moved in (([], 0.01), (["--unit=cm"], 1.0)):
        assert main([*call, "--move=0 0 1cm", *unit]) == 0
        top = open_mesh(tmp_path / "b.glb").V[V[:, 2] == 2, 2]
        assert np.abs(top - 2 - moved).max() < 1e-6
        assert json.loads((tmp_path / "r.json").read_text())["unit"] == ("cm" if unit else "m")
    capsys.readouterr()
