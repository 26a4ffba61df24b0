"""Nothing of a library reaches the terminal while a file is read or written."""

import io
import subprocess
import sys
import zipfile

import numpy as np
from PIL import Image

from apd_viewer.files.formats.texture_images import read_image
from apd_viewer.files.meshes import MESH_FORMATS

SAYS = """
import logging, sys, warnings
import numpy as np
from pathlib import Path
import apd_viewer
from apd_viewer.files import meshes
from apd_viewer.files.formats.polygon_mesh import ParsedMesh

def chatty(content, path, *_):
    warnings.warn("a warning of a library")
    logging.getLogger("trimesh").warning("a message of trimesh")
    logging.getLogger("PIL.Image").error("a message of Pillow")
    np.zeros(3) / np.zeros(3)
    return ParsedMesh(np.eye(3), np.array([[0, 1, 2]]), None)

meshes.parsed_mesh = chatty
print([len(apd_viewer.open_mesh(path).F) for path in sys.argv[1:]])
"""


def test_open_mesh_says_nothing_whatever_a_reader_calls(tmp_path):
    paths = [tmp_path / f"a{suffix}" for suffix in MESH_FORMATS]
    for path in paths:
        path.write_text("anything")
    call = [sys.executable, "-c", SAYS, *map(str, paths)]
    done = subprocess.run(call, capture_output=True, text=True, check=True)
    assert (done.stdout.strip(), done.stderr) == (str([1] * len(MESH_FORMATS)), "")


def test_info_says_one_sentence_of_a_package_that_refers_to_what_is_not_there(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.3mf", "w") as archive:
        space = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
        model = f'<model xmlns="{space}"><resources/><build><item objectid="9"/></build></model>'
        archive.writestr("3D/3dmodel.model", model)
    call = [sys.executable, "-m", "apd_viewer", "info", str(tmp_path / "a.3mf")]
    done = subprocess.run(call, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) == 1


def test_read_image_reads_a_texture_that_pillow_warns_of_in_silence(tmp_path, recwarn):
    picture = io.BytesIO()
    Image.new("P", (4, 4)).save(picture, "PNG", transparency=bytes(3))
    before = Image.MAX_IMAGE_PIXELS
    Image.MAX_IMAGE_PIXELS = 10  # from here on it warns of a bomb
    try:
        assert read_image(picture.getvalue(), "a.png").shape == (4, 4, 3)
    finally:
        Image.MAX_IMAGE_PIXELS = before
    assert not recwarn.list
    np.testing.assert_array_equal(read_image(picture.getvalue(), "a.png"), np.zeros((4, 4, 3)))
