"""Damaged files of selections: a selection comes out, or one sentence; never anything else."""

import io
import random
import zipfile

import numpy as np
import pytest
from painted_meshes import MESH, N, painted

from apd_viewer.errors import InputError
from apd_viewer.files.selections.selection import Selection
from apd_viewer.files.selections.selection_files import (
    SELECTION_FORMATS,
    read_selection_file,
    write_selection,
)

CASES = 300
ABSURD = (
    b"nan",
    b"-1",
    b"1e308",
    b"9" * 5000,
    b"99999999999",
    b"0.5",
    b"[",
    b"{",
    b'"',
    b"\x1b[2J",
    b"\n",
    b"",
)


def damaged(content, chance):
    """The content with some bytes flipped, a piece replaced by something absurd, or another piece."""
    body = bytearray(content)
    for _ in range(chance.choice((1, 1, 2, 8))):
        at = chance.randrange(len(body))
        match chance.randrange(4):
            case 0 | 1:
                body[at] = chance.choice((chance.randrange(256), body[at] ^ (1 << chance.randrange(8))))
            case 2:
                body[at : at + chance.randrange(4)] = chance.choice(ABSURD)
            case 3:
                other = chance.randrange(len(body))
                body[at : at + 9] = body[other : other + chance.randrange(20)]
        body = body or bytearray(b"0")
    return bytes(body)


def check(path):
    try:
        selection = read_selection_file(path, MESH)
    except InputError as error:
        said = str(error)
        assert said.endswith(".")
        assert said.isprintable()
        assert len(said) < 300
        return False
    assert isinstance(selection, Selection)
    assert selection.labels.shape == selection.member.shape == (N,)
    assert selection.labels.max() <= 1 + len(selection.handles)
    assert selection.member.max() <= len(selection.regions) == len(selection.areas)
    return True


@pytest.mark.parametrize("suffix", [*SELECTION_FORMATS, "binary.dmat"])
def test_read_selection_file_reads_damaged_files_or_refuses_them_in_one_sentence(suffix, tmp_path):
    path, chance, read = tmp_path / f"a{suffix}", random.Random(0), 0
    write_selection(path, MESH, painted())
    content = path.read_bytes()
    if suffix == "binary.dmat":
        content = b"0 0\n" + b"1 %d\n" % N + np.array(content.split()[2:], dtype="<f8").tobytes()
    for _ in range(CASES):
        path.write_bytes(damaged(content, chance))
        read += check(path)
    # Some damage is none, as to a position of a PLY; most is.
    assert read < CASES


def test_read_npz_reads_damaged_arrays_in_a_whole_archive_or_refuses_them_in_one_sentence(tmp_path):
    """A checksum keeps most damage from what reads the arrays; here it is right."""
    path, chance, read = tmp_path / "a.npz", random.Random(0), 0
    write_selection(path, MESH, painted())
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    for _ in range(CASES):
        name, stream = chance.choice(list(members)), io.BytesIO()
        with zipfile.ZipFile(stream, "w") as archive:
            for each, content in members.items():
                archive.writestr(each, damaged(content, chance) if each == name else content)
        path.write_bytes(stream.getvalue())
        read += check(path)
    assert 0 < read < CASES
