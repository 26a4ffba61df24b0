"""What a mesh file names: opened beside it and below, refused anywhere else, before anything is read."""

import base64
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from symbolic_links import needs_links
from textured_files import glb, gltf, image, obj, ply

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.storage import regular_files

pytestmark = needs_links
DEVICE = Path("/dev/zero")

# Opens each file twice: first the good ones, so that no import is left to be made, then with the hook.
CHILD = """
import json, os, sys, warnings
from apd_viewer.errors import InputError
from apd_viewer.files.meshes import open_mesh
warnings.simplefilter("error")

def said(path):
    try:
        return open_mesh(path).texture[1]
    except InputError as error:
        return str(error)

good, asked, control = json.load(sys.stdin)
for path in good:
    assert said(path) is None, said(path)
opened = []
sys.addaudithook(lambda event, args: event == "open" and opened.append(args[0]))
found = {}
for path in [*asked, control]:
    opened.clear()
    words = said(path)
    found[path] = words, [os.path.realpath(os.fsdecode(o)) for o in opened if not isinstance(o, int)]
print(json.dumps(found))
"""

UP = "../outside"
BUFFERS = {
    "above": UP + "/four.bin",
    "a system file": "../" * 20 + "etc/passwd",
    "percent signs": "%2e%2e/outside/four.bin",
    "percent signs for slashes": "..%2Foutside%2Ffour.bin",
    "backslashes": "..\\outside\\four.bin",
    "percent signs for backslashes": "..%5Coutside%5Cfour.bin",
    "absolute": "{outside}/four.bin",
    "a scheme": "file://{outside}/four.bin",
    "a scheme of another computer": "https://example.org/four.bin",
    "down and up again": "sub/../../outside/four.bin",
    "a link": "link.bin",
    "below a link": "linked/four.bin",
    "a link to a device": "zero.bin",
    "a drive": "C:\\Windows\\win.ini",
    "a drive without a folder": "C:four.bin",
    "another computer": "\\\\server\\share\\four.bin",
    "another computer with slashes": "//server/share/four.bin",
}
IMAGES = {"above": UP + "/four.png", "absolute": "{outside}/four.png", "a link": "linked/four.png"}
IMAGES |= {"backslashes": "..\\outside\\four.png"}


def with_buffer(folder, uri, name="square.gltf"):
    """The square with its buffer in another file; returns the path and the bytes of that file."""
    path = gltf(folder)
    document = json.loads(path.read_text(encoding="utf-8"))
    content = base64.b64decode(document["buffers"][0]["uri"].partition(",")[2])
    document["buffers"][0]["uri"] = uri
    path.unlink()
    path = folder / name
    path.write_text(json.dumps(document), encoding="utf-8")
    return path, content


def with_image(folder, uri, name):
    path = gltf(folder)
    document = json.loads(path.read_text(encoding="utf-8"))
    document["images"] = [{"uri": uri}]
    path.unlink()
    path = folder / name
    path.write_text(json.dumps(document), encoding="utf-8")
    return path


def replaced(path, name, *words):
    """The file under another name, with words replaced."""
    new = path.with_name(name)
    text = path.read_text(encoding="utf-8")
    assert words[0] in text
    path.unlink()
    new.write_text(text.replace(*words), encoding="utf-8")
    return new


@pytest.fixture
def folder(tmp_path):
    """Folder of meshes beside one whose files they must not reach, with links to that."""
    inside, outside = tmp_path / "inside", tmp_path / "outside"
    for each in (inside, inside / "sub", outside):
        each.mkdir()
    obj(outside)
    _, content = with_buffer(outside, "four.bin")
    (outside / "four.bin").write_bytes(content)
    (inside / "linked").symlink_to(outside)
    (inside / "link.bin").symlink_to(outside / "four.bin")
    (inside / "zero.bin").symlink_to(DEVICE)
    return inside


def outsiders(folder):
    """Files that name something outside the folder, by what they are."""
    outside, made = folder.parent / "outside", {}
    for name, uri in BUFFERS.items():
        uri = uri.format(outside=outside)
        made[f"buffer, {name}"] = with_buffer(folder, uri, f"buffer {name}.gltf")[0]
    for name, uri in IMAGES.items():
        uri = uri.format(outside=outside)
        made[f"glTF, {name}"] = with_image(folder, uri, f"image {name}.gltf")
        made[f"PLY, {name}"] = replaced(ply(folder), f"image {name}.ply", "four.png", uri)
        library = f"image {name}.mtl"
        path = replaced(obj(folder), f"image {name}.obj", "square.mtl", library)
        replaced(folder / "square.mtl", library, "four.png", uri)
        made[f"MTL, {name}"] = path
        library = uri.replace("four.png", "square.mtl")
        made[f"OBJ, {name}"] = replaced(obj(folder), f"library {name}.obj", "square.mtl", library)
    path = replaced(obj(folder), "deep.obj", "square.mtl", "sub/deep.mtl")
    text = (folder / "square.mtl").read_text(encoding="utf-8")
    (folder / "sub" / "deep.mtl").write_text(text.replace("four.png", "../../outside/four.png"))
    made["MTL in a subfolder"] = path
    return made


def opened_in_a_child(good, asked, control):
    said = json.dumps([list(map(str, good)), list(map(str, asked)), str(control)])
    done = subprocess.run(
        [sys.executable, "-c", CHILD], input=said, capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.skipif(not DEVICE.exists(), reason="reads a link to /dev/zero, a device that never ends")
def test_content_beside_opens_nothing_outside(folder):
    good = folder.parent / "good"
    good.mkdir()
    asked, control = outsiders(folder), with_buffer(folder.parent / "outside", "four.bin")[0]
    assert len(asked) > 30
    found = opened_in_a_child([make(good) for make in (obj, ply, gltf, glb)], asked.values(), control)
    for what, path in asked.items():
        words, opened = found[str(path)]
        assert str(path) in opened, what
        assert all(place.startswith(f"{folder}{os.sep}") for place in opened), (what, opened)
        assert words, what
        assert words.startswith(f"{path.name} refers to a file outside its folder ("), what
        assert words.endswith("copy it into the folder and correct its name in the mesh."), what
        assert len(words.splitlines()) == 1
    # The same hook sees what is read of the folder itself.
    assert found[str(control)] == [None, [str(control), str(control.with_name("four.bin"))]]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
def test_content_beside_misses_what_is_no_file_at_once(folder):
    os.mkfifo(folder / "pipe")
    good = gltf(folder.parent)
    paths = [
        with_buffer(folder, "pipe", "buffer.gltf")[0],
        with_buffer(folder, "sub", "folder.gltf")[0],
        with_image(folder, "pipe", "image.gltf"),
        replaced(ply(folder), "image.ply", "four.png", "pipe"),
        replaced(obj(folder), "library.obj", "square.mtl", "pipe"),
    ]
    found = opened_in_a_child([good], paths, good)
    words = [found[str(path)][0] for path in paths]
    assert ["missing from its folder" in said for said in words[:2]] == [True, True]
    assert [said.startswith("The texture pipe is missing") for said in words[2:4]] == [True, True]
    assert words[4] is None
    assert not any(str(folder / "pipe") in found[str(path)][1] for path in paths)


@pytest.mark.parametrize("uri", ["sub/four.bin", "./sub/four.bin", "s%75b/four.bin", "sub/../sub/four.bin"])
def test_content_beside_opens_what_lies_below_and_that_comes_back_byte_for_byte(folder, uri):
    path, content = with_buffer(folder, uri)
    (folder / "sub" / "four.bin").write_bytes(content)
    mesh = open_mesh(path)
    assert mesh.texture[0] is not None
    assert mesh.texture[1] is None
    save_mesh(mesh, mesh.V, folder / "again.gltf")
    assert (folder / "again.gltf").read_bytes() == path.read_bytes()


@pytest.mark.parametrize("name", ["../four.png", "..\\four.png", "./four.png"])
def test_images_of_names_an_image_from_the_folder_of_its_materials(folder, name):
    path = replaced(obj(folder), "mesh.obj", "square.mtl", "sub\\square.mtl")
    text = (folder / "square.mtl").read_text(encoding="utf-8").replace("four.png", name)
    (folder / "sub" / "square.mtl").write_text(text, encoding="utf-8")
    (folder / "sub" / "four.png").write_bytes(image())
    mesh = open_mesh(path)
    assert mesh.texture[1] is None
    assert mesh.texture[0].image.shape == (64, 64, 3)
    save_mesh(mesh, mesh.V, folder / "again.obj")
    assert (folder / "again.obj").read_bytes() == path.read_bytes()


def test_content_beside_follows_a_link_within_the_folder_and_a_folder_that_is_one(folder):
    path, content = with_buffer(folder, "here.bin")
    (folder / "sub" / "four.bin").write_bytes(content)
    (folder / "here.bin").symlink_to("sub/four.bin")
    (folder.parent / "way").symlink_to(folder)
    assert len(open_mesh(path).V) == len(open_mesh(folder.parent / "way" / path.name).V) == 6


def test_save_mesh_writes_no_copy_where_its_buffer_would_be_outside(folder):
    path, content = with_buffer(folder, "four.bin")
    (folder / "four.bin").write_bytes(content)
    mesh, target = open_mesh(path), folder / "sub" / "copy.gltf"
    (folder / "sub" / "four.bin").symlink_to(folder.parent / "outside" / "four.bin")
    with pytest.raises(InputError, match=r"copy\.gltf refers to a file outside its folder \(four\.bin\)"):
        save_mesh(mesh, mesh.V, target)
    assert not target.exists()


def test_without_path_leaves_a_mesh_without_a_file_and_so_without_neighbours(folder, monkeypatch):
    (folder / "four.png").write_bytes(image())
    mesh = open_mesh(with_image(folder, "four.png", "image.gltf"))
    monkeypatch.chdir(folder)
    assert mesh.texture[1] is None
    assert mesh.without_path().texture[1].startswith("The texture four.png is missing")


def test_read_buffers_refuses_a_buffer_that_is_shorter_than_it_says(folder):
    path, content = with_buffer(folder, "four.bin")
    (folder / "four.bin").write_bytes(content[:-1])
    with pytest.raises(
        InputError, match=f"declares {len(content):,} bytes, but there are {len(content) - 1:,}"
    ):
        open_mesh(path)


def test_read_buffers_reads_no_more_of_a_buffer_than_it_says(folder):
    path, content = with_buffer(folder, "four.bin")
    (folder / "four.bin").write_bytes(content)
    os.truncate(folder / "four.bin", 4 * regular_files.LARGEST_FILE)  # sparse: on the disk it takes no place
    assert len(open_mesh(path).V) == 6


@pytest.mark.parametrize("kind", ["buffer", "buffers", "image", "library"])
def test_content_beside_does_not_read_files_without_end(folder, kind, monkeypatch):
    with (folder / "huge").open("wb") as stream:
        stream.truncate(regular_files.LARGEST_FILE + 1)
    if kind == "library":
        said = open_mesh(replaced(obj(folder), "a.obj", "square.mtl", "huge")).texture[1]
    elif kind == "image":
        said = open_mesh(replaced(ply(folder), "a.ply", "four.png", "huge")).texture[1]
    else:
        path, content = with_buffer(folder, "huge")
        document = json.loads(path.read_text(encoding="utf-8"))
        if kind == "buffer":
            document["buffers"][0]["byteLength"] = regular_files.LARGEST_FILE + 1
        else:  # each is small enough, but they are many
            (folder / "huge").write_bytes(content)
            document["buffers"] *= 3
            monkeypatch.setattr("apd_viewer.files.gltf.scene.LARGEST_FILE", 2 * len(content))
        path.write_text(json.dumps(document), encoding="utf-8")
        with pytest.raises(InputError) as caught:
            open_mesh(path)
        said = str(caught.value)
    assert said.startswith("The file contains or refers to more than 1 GiB (")
    assert said.endswith("; reduce the mesh first.")


def test_data_uri_content_is_bounded(tmp_path, monkeypatch):
    path = gltf(tmp_path)
    monkeypatch.setattr("apd_viewer.files.gltf.scene.LARGEST_FILE", 100)
    with pytest.raises(InputError, match="contains or refers to more than"):
        open_mesh(path)


def test_open_mesh_opens_the_good_square_that_the_others_were_made_from(tmp_path):
    assert [len(np.unique(open_mesh(make(tmp_path)).F)) for make in (obj, ply, gltf, glb)] == [6] * 4
