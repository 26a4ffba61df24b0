"""Motions of the command deform in words: their ways, their handles, and what is no motion."""

import argparse

import numpy as np
import pytest
import trimesh
from meshes import rotation
from motions import IN_WORDS, in_words
from painted_meshes import write_bar

from apd_viewer.__main__ import main
from apd_viewer.commands.motion_options import add_motion_options


@pytest.fixture
def bar(tmp_path):
    """Vertices of a bar along z from 0 to 5: ``bar.sel`` has one handle on top, ``two.sel`` another below."""
    write_bar(tmp_path)
    V = trimesh.load(tmp_path / "bar.off", process=False).vertices
    labels = np.loadtxt(tmp_path / "bar.sel", dtype=int)
    labels[V[:, 2] == 3] = 3
    np.savetxt(tmp_path / "two.sel", labels, fmt="%d")
    return V


@pytest.fixture
def deformed(bar, capsys, tmp_path):
    """Run the command; its status, what it said of errors, and the vertices written."""

    def run(*words, selection="bar.sel"):
        out = tmp_path / "out.off"
        given = "deform", tmp_path / "bar.off", "--selection", tmp_path / selection, *words, "-o", out
        status = main([str(word) for word in given])
        err = capsys.readouterr().err
        return status, err, trimesh.load(out, process=False).vertices if status == 0 else None

    return run


def test_deform_twists_as_the_matrix_does(deformed, tmp_path):
    pose = np.eye(4)
    pose[:3, :3] = rotation([0, 0, 1], np.radians(60))
    pose[:3, 3] = (c := np.array([1.0, 1.0, 0.0])) - pose[:3, :3] @ c
    np.savetxt(tmp_path / "twist.def", pose)
    (_, _, one), (_, _, other) = deformed("--twist", "60deg"), deformed("--transform", tmp_path / "twist.def")
    np.testing.assert_allclose(one, other, atol=1e-6)


def test_deform_twists_past_half_a_turn(deformed, bar):
    top, middle = bar[:, 2] == 5, bar[:, 2] == 3
    (_, _, back), (_, _, on) = deformed("--twist=-160deg"), deformed("--twist", "200deg")
    np.testing.assert_allclose(back[top], on[top], atol=1e-6)
    apart = np.linalg.norm(on[middle] - back[middle], axis=1)
    assert apart.max() > 1.0, "more than half a turn lies between them there"


def test_deform_takes_words_and_options_for_the_same_motion(deformed):
    shapes = [
        deformed(*words, selection="two.sel")[2]
        for words in (
            ["--twist", "30deg", "--push", "10%", "--handle", 2, "--unit", "cm", "--move", "0 5mm 0"],
            ["--motion", "twist 30deg; push 10%; handle 2: move 0 5mm 0", "--unit", "cm"],
        )
    ]
    assert np.array_equal(*shapes)
    assert np.ptp(shapes[0][:, 2]) < 5.0


def test_deform_takes_a_wall_distribution_for_a_thickness(deformed, tmp_path):
    """Thin at the bottom, the wall gives way there; one thickness for all in a file is that of a number."""
    profiles = {"even": "0,0.1", "uneven": "0,0.04\n5,0.16", "mm": "0,1"}
    for name, rows in profiles.items():
        head = "z,thickness (mm)" if name == "mm" else "z,thickness"
        (tmp_path / f"{name}.csv").write_text(f"{head}\n{rows}\n")
    twist = "--twist", "40deg", "--method", "wall", "--unit", "cm", "--wall-thickness"
    words = "0.1", *(tmp_path / f"{name}.csv" for name in profiles)
    one, even, uneven, millimetres = (deformed(*twist, word)[2] for word in words)
    assert np.array_equal(one, even)
    assert np.array_equal(one, millimetres)
    assert np.abs(one - uneven).max() > 0.01
    status, said, _ = deformed(*twist, tmp_path / "gone.csv")
    assert (status, "There is no file" in said) == (2, True)


WRONG = {
    "both": (["--twist", "9", "--transform", "gone.def"], "Give either --transform or a motion"),
    "more than half a turn at once": (["--twist", "400deg", "--iterations", "5"], "at most half a turn"),
    "a length for an angle": (["--twist", "9mm"], "unit of length"),
    "a length without the mesh's unit": (
        ["--push", "9mm"],
        "add --unit mm, cm, m, in or ft for",
    ),
    "a handle that is not there": (["--handle", "3", "--twist", "9"], "There is no handle 3"),
    "an axis that is missing": (["--turn", "9"], "needs an axis"),
}


@pytest.mark.parametrize("case", WRONG)
def test_deform_says_in_a_sentence_what_is_no_motion(case, deformed):
    words, said = WRONG[case]
    status, err, _ = deformed(*words)
    assert status != 0
    assert said in err
    assert "Traceback" not in err


@pytest.mark.parametrize("name", IN_WORDS)
def test_add_motion_options_has_an_option_for_the_words_of_every_motion(name):
    parser = argparse.ArgumentParser()
    add_motion_options(parser)
    word, _, rest = in_words(name).partition(" ")
    assert parser.parse_args([f"--{word}={rest}"]).motion == [in_words(name)]
    assert f"--{word}" in parser.format_help()


def test_deform_shears_the_handle_and_keeps_the_area(deformed, bar, tmp_path):
    _, _, sheared = deformed("--shear", "0.3 along x")
    top = bar[:, 2] == 5
    np.testing.assert_allclose(sheared[top], bar[top] + [1.5, 0.0, 0.0], atol=1e-6)
    faces = trimesh.load(tmp_path / "bar.off", process=False).faces
    assert trimesh.Trimesh(sheared, faces, process=False).area == pytest.approx(
        trimesh.Trimesh(bar, faces, process=False).area, rel=1e-6
    )
