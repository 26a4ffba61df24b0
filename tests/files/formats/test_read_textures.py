"""Textures of each format: every corner finds its colour, and what is missing is said."""

import numpy as np
import pytest
from PIL import Image
from textured_files import COLORS, FILES, image, obj

from apd_viewer.files.meshes import open_mesh


def colors_at(mesh, points):
    """Colours of a texture at the middle of triangles and towards their corners, (m, 3, 3)."""
    texture = mesh.texture[0]
    uv = texture.uv[texture.uv_of]
    inner = 0.7 * uv + 0.3 * uv.mean(axis=1, keepdims=True)
    inner = inner % 1.0
    height, width = texture.image.shape[:2]
    x, y = (inner * (width, height)).astype(int).transpose(2, 0, 1)
    corners = mesh.V[mesh.F]
    points[:] = 0.7 * corners + 0.3 * corners.mean(axis=1, keepdims=True)
    return texture.image[height - 1 - y, x]


def expected(points):
    return COLORS[(points[..., 1] < 1.0).astype(int), (points[..., 0] > 1.0).astype(int)]


@pytest.mark.parametrize("kind", FILES)
def test_texture_gives_each_corner_its_color(tmp_path, kind):
    mesh = open_mesh(FILES[kind](tmp_path))
    assert mesh.texture[1] is None
    points = np.empty((*mesh.F.shape, 3))
    np.testing.assert_array_equal(colors_at(mesh, points), expected(points))
    assert mesh.baked(mesh.V * 2.0).texture is mesh.texture


def test_texture_says_that_an_image_is_missing_and_the_mesh_opens(tmp_path):
    mesh = open_mesh(obj(tmp_path, with_image=False))
    texture, said = mesh.texture
    assert texture is None
    assert said.startswith("The texture four.png is missing or cannot be read; ")
    (tmp_path / "four.png").write_bytes(image()[:60])
    assert open_mesh(tmp_path / "square.obj").texture[1] == said


def test_make_texture_a_mesh_without_any_is_none(tmp_path):
    path = obj(tmp_path)
    (tmp_path / "square.mtl").unlink()
    assert open_mesh(path).texture == (None, None)


def test_texture_makes_one_image_of_several(tmp_path):
    obj(tmp_path)
    Image.new("RGB", (8, 4), (1, 2, 3)).save(tmp_path / "plain.png")
    (tmp_path / "square.mtl").write_text(
        "newmtl paint\nmap_Kd four.png\nnewmtl plain\nmap_Kd plain.png\nnewmtl none\n", encoding="utf-8"
    )
    text = (tmp_path / "square.obj").read_text(encoding="utf-8")
    text = text.replace("f 2/", "usemtl plain\nf 2/") + "usemtl none\nf 1/1 2/2 5/6\n"
    (tmp_path / "square.obj").write_text(text, encoding="utf-8")
    mesh = open_mesh(tmp_path / "square.obj")
    points = np.empty((*mesh.F.shape, 3))
    found = colors_at(mesh, points)
    np.testing.assert_array_equal(found[:2], expected(points)[:2])
    assert (found[2:4] == (1, 2, 3)).all()
    assert (found[4] == 255).all()


def test_texture_finds_the_libraries_that_one_line_lists(tmp_path):
    path = obj(tmp_path)
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace("mtllib square.mtl", "mtllib none.mtl square.mtl"), encoding="utf-8")
    assert open_mesh(path).texture[0] is not None


def test_texture_takes_no_part_of_a_name_for_an_option(tmp_path):
    path = obj(tmp_path)
    (tmp_path / "four.png").rename(tmp_path / "oak-light brown v2.png")
    library = tmp_path / "square.mtl"
    named = library.read_text(encoding="utf-8").replace("four.png", "-s 1 1 1 oak-light brown v2.png")
    library.write_text(named, encoding="utf-8")
    assert open_mesh(path).texture[0] is not None


def test_texture_scales_large_images_down(tmp_path):
    path = obj(tmp_path)
    Image.new("RGB", (16_384, 8)).save(tmp_path / "four.png")
    assert open_mesh(path).texture[0].image.shape == (4, 8192, 3)
