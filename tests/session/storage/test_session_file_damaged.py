"""Sessions that are damaged, or made to do harm: each is refused in a sentence, and nothing else happens."""

import io
import json
import random
import zipfile
from pathlib import Path

import numpy as np
import pytest
from fuzz import FOREIGN

from apd_viewer.errors import InputError
from apd_viewer.files.storage.archive import npy_content
from apd_viewer.session.storage.session_file import open_session

GOOD = Path(__file__).with_name("version-1.apd")


def members() -> dict[str, bytes]:
    with zipfile.ZipFile(GOOD) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def packed(contents: dict[str, bytes]) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in contents.items():
            archive.writestr(name, content)
    return stream.getvalue()


def outcome(path: Path) -> str:
    """What opening says; anything but a sentence is a failure."""
    try:
        state, _ = open_session(path)
    except InputError as error:
        said = str(error)
        assert said.endswith(".")
        assert "\n" not in said
        assert len(said.replace(str(path), "")) < 300
        assert not FOREIGN.search(said), said
        return said
    assert np.isfinite(state.frame.U).all()
    assert np.isfinite(state.frame.area)
    return "opened"


@pytest.fixture
def refused(tmp_path):
    """Open a session with other members than the good one; return what is said."""

    def run(content: bytes | None = None, **other: bytes | None) -> str:
        path = tmp_path / "a.apd"
        changed = {name.replace("_", "."): part for name, part in other.items()}
        contents = {name: part for name, part in (members() | changed).items() if part is not None}
        path.write_bytes(packed(contents) if content is None else content)
        before = sorted(tmp_path.rglob("*"))
        said = outcome(path)
        assert said != "opened"
        assert "a.apd" in said
        assert sorted(tmp_path.rglob("*")) == before
        return said

    return run


def text(change) -> bytes:
    """The JSON of the good session after ``change(said)``."""
    said = json.loads(members()["session.json"])
    change(said)
    return json.dumps(said).encode()


def test_open_session_opens_the_good_one():
    assert outcome(GOOD) == "opened"


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "its archive is damaged"),
        (b"nonsense", "its archive is damaged"),
        (b"PK\5\6" + bytes(18), "“session.json” is missing"),
        (packed({"labels.npy": b""}), "“session.json” is missing"),
        (packed({"session.json": b"{"}), "“session.json” is damaged"),
        (packed({"session.json": b"[" * 100_000}), "“session.json” is damaged"),
        (packed({"session.json": b"\xff\xfe"}), "“session.json” is damaged"),
        (packed({"session.json": b"[1]"}), "“session.json” is damaged"),
        (packed({"session.json": b'{"format": 3}'}), "“format” is damaged"),
        (packed({"session.json": b'{"format": "zip"}'}), "it is another type of file"),
    ],
)
def test_open_session_refuses_what_is_no_session(content, words, refused):
    assert words in refused(content)


def test_open_session_says_that_there_is_no_file_at_all(tmp_path):
    assert "There is no file" in outcome(tmp_path / "gone.apd")
    assert "There is no file" in outcome(tmp_path / ("x" * 300 + ".apd"))
    assert "is not a file" in outcome(tmp_path)


@pytest.mark.parametrize("name", sorted(members()))
def test_open_session_names_a_missing_member(name, refused):
    assert f"“{name}” is missing" in refused(**{name.replace(".", "_"): None})


POSE = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
NO_ITERATIONS = {"most_iterations": 0, "energy_tolerance": 1e-7, "step_tolerance": 1e-5}
NO_END = {"most_iterations": 10, "energy_tolerance": 1e-7, "step_tolerance": 0.0}
WRONG = {
    "newer": (("version",), 2, "saved by a newer version of the program; update"),
    "no version": (("version",), 0, "“version” is damaged"),
    "version of words": (("version",), "1", "“version” is damaged"),
    "version is true": (("version",), True, "“version” is damaged"),
    "no document": (("document",), None, "“document” is damaged"),
    "unknown method": (("document", "method"), "magic", "“method”"),
    "no handle": (("document", "handles"), [], "“labels” in it refer to a handle"),
    "handles of words": (("document", "handles"), "two", "“handles” is damaged"),
    "many handles": (("document", "handles"), [{"name": "a", "pose": POSE}] * 9, "“handles” is damaged"),
    "one handle of two": (
        ("document", "handles"),
        [{"name": "a", "pose": POSE}],
        "refer to a handle that does not",
    ),
    "no regions": (("document", "regions"), [], "“member” in it refers to a region"),
    "no name": (("document", "handles", 0, "name"), "", "“name” is damaged"),
    "long name": (("document", "handles", 0, "name"), "a" * 10**5, "“name” is damaged"),
    "no pose": (("document", "handles", 0, "pose"), None, "“pose” is damaged"),
    "short pose": (("document", "handles", 0, "pose"), POSE[:3], "“pose” is damaged"),
    "a perspective": (("document", "handles", 0, "pose"), [*POSE[:3], [0, 0, 1, 1]], "last row"),
    "pose of words": (("document", "handles", 0, "pose"), [["1"] * 4] * 4, "“pose” is damaged"),
    "infinite pose": (("document", "handles", 0, "pose", 0, 3), float("inf"), "“session.json” is damaged"),
    "NaN in pose": (("document", "handles", 0, "pose", 0, 3), float("nan"), "“session.json” is damaged"),
    "absurd pose": (("document", "handles", 0, "pose", 0, 3), 10**400, "“pose” is damaged"),
    "tolerance of 0": (("document", "tolerance"), 0, "“tolerance” is damaged"),
    "no iterations": (
        ("document", "convergence"),
        NO_ITERATIONS,
        "“convergence” is damaged",
    ),
    "criteria missing": (
        ("document", "convergence"),
        {"most_iterations": 9},
        "“energy_tolerance” is damaged",
    ),
    "endless": (("document", "convergence"), NO_END, "“convergence” is damaged"),
    "stiffness below 0": (("document", "stiffness"), -1.0, "“stiffness” is damaged"),
    "a Poisson ratio above one half": (("document", "poisson"), 0.7, "“poisson” is damaged"),
    "hardening of one": (("document", "hardening"), 1.0, "“hardening” is damaged"),
    "area of words": (("document", "area"), "all", "“area” is damaged"),
    "no volume": (("document", "volume"), 0, "“volume” is damaged"),
    "flag": (("document", "hold_area"), 1, "“hold_area” is damaged"),
    "region's area": (("document", "regions", 1, "area"), -5, "“area” is damaged"),
    "arrays": (("arrays",), {"labels": 1}, "“arrays” is damaged"),
    "arrays of numbers": (("arrays",), [1, 2], "“arrays” is damaged"),
    "iteration": (("frame", "iteration"), -1, "“iteration” is damaged"),
    "settled": (("frame", "settled"), "yes", "“settled” is damaged"),
    "unreached": (("frame", "unreached"), 5, "“unreached” is damaged"),
    "energy": (("frame", "energy"), -1.0, "“energy” is damaged"),
    "unit": (("view", "unit"), "parsec", "“unit”"),
    "up": (("view", "camera", "up"), [0, 0, 0], "has no direction"),
    "focal": (("view", "camera", "focal"), [0.0, -12.0, 4.0], "has no direction"),
    "angle": (("view", "camera", "angle"), 4.0, "“angle” is damaged"),
    "digest": (("mesh", "digest"), "0" * 64, "its copy of the mesh is a different mesh"),
    "mesh's name": (("mesh", "name"), "", "“name” is damaged"),
    "mesh's path": (("mesh", "path"), 3, "“path” is damaged"),
    "traversal": (("mesh", "embedded"), ["../../../../etc/passwd"], "“embedded” is damaged"),
    "absolute": (("mesh", "embedded"), ["/etc/mesh.obj"], "“embedded” is damaged"),
    "another member": (("mesh", "embedded"), ["shape.npy"], "“embedded” is damaged"),
    "no such member": (("mesh", "embedded"), ["mesh.ply"], "“mesh.ply” is missing"),
    "huge arrays": (("mesh", "embedded"), ["V.npy", "F.npy"], "“V.npy” is missing"),
    "nothing embedded": (("mesh", "embedded"), None, "bar.obj, a mesh of a.apd, is missing"),
}


@pytest.mark.parametrize("case", WRONG)
def test_open_session_refuses_wrong_words(case, refused):
    where, value, words = WRONG[case]

    def change(said):
        for key in where[:-1]:
            said = said[key]
        said[where[-1]] = value

    assert words in refused(session_json=text(change))


N = 24
NOT_SHAPES = {
    "too few": (np.zeros((N - 1, 3)), "“shape” in it does not fit the mesh"),
    "too many": (np.zeros((N + 1, 3)), "“shape” in it does not fit the mesh"),
    "flat": (np.zeros(3 * N), "“shape” in it does not fit the mesh"),
    "single precision": (np.zeros((N, 3), "f4"), "“shape” in it does not fit the mesh"),
    "whole numbers": (np.zeros((N, 3), "i8"), "“shape” in it does not fit the mesh"),
    "NaN": (np.full((N, 3), np.nan), "“shape” in it is not a shape of the mesh"),
    "signalling NaN": (
        np.full((N, 3), 0x7FF0000000000001).view("f8"),
        "“shape” in it is not a shape of the mesh",
    ),
    "infinite": (np.full((N, 3), -np.inf), "“shape” in it is not a shape of the mesh"),
    "absurd": (np.full((N, 3), 1e300), "“shape” in it is not a shape of the mesh"),
}


@pytest.mark.parametrize("case", NOT_SHAPES)
def test_open_session_refuses_a_wrong_shape(case, refused):
    array, words = NOT_SHAPES[case]
    assert words in refused(shape_npy=npy_content(array))


def _pickled() -> bytes:
    stream = io.BytesIO()
    np.save(stream, np.array([print] * N, dtype=object), allow_pickle=True)
    return stream.getvalue()


HEAD = b"\x93NUMPY\x01\x00"
NOT_LABELS = {
    "empty": b"",
    "cut": npy_content(np.zeros(N, "u1"))[:-1],
    "longer": npy_content(np.zeros(N, "u1")) + b"\0",
    "words": b"labels",
    "signed": npy_content(np.zeros(N, "i1")),
    "objects": _pickled(),
    "huge": HEAD
    + b"\x60\0"
    + b"{'descr': '|u1', 'fortran_order': False, 'shape': (999999999999,), }".ljust(95)
    + b"\n",
    "deep": HEAD + b"\x00\x40" + b"(" * 0x4000,
    "digits": HEAD + b"\x00\x40" + b"{'descr': '|u1', 'fortran_order': False, 'shape': (" + b"9" * 0x3F00,
}


@pytest.mark.parametrize("case", NOT_LABELS)
def test_open_session_refuses_wrong_labels(case, refused):
    assert "“labels” in it" in refused(labels_npy=NOT_LABELS[case])


def test_open_session_refuses_labels_and_regions_that_are_not_there(refused):
    assert "refer to a handle that does not exist" in refused(labels_npy=npy_content(np.full(N, 4, "u1")))
    assert "refers to a region that does not exist" in refused(member_npy=npy_content(np.full(N, 3, "u1")))


def test_open_session_refuses_a_copy_of_the_mesh_that_is_damaged(refused):
    assert "its copy of the mesh is damaged" in refused(mesh_obj=b"v 0 0 nan\nf 1 1 1\n")
    assert "its copy of the mesh is a different mesh" in refused(
        mesh_obj=members()["mesh.obj"].replace(b"v 0 0 1", b"v 0 0 1.5")
    )


def test_open_session_refuses_a_volume_where_there_is_none(refused):
    open_mesh = members()["mesh.obj"].rsplit(b"f ", 1)[0]
    from apd_viewer.files.meshes import read_mesh

    digest = read_mesh(Path("bar.obj"), open_mesh).digest
    said = text(lambda said: said["mesh"].update(digest=digest))
    assert "“volume” is damaged" in refused(session_json=said, mesh_obj=open_mesh)


def test_open_session_refuses_an_archive_that_would_fill_the_memory(refused):
    assert "“labels.npy” in it is too large" in refused(labels_npy=bytes(80 << 20))


def test_open_session_refuses_a_member_that_is_larger_than_it_says(refused):
    good = packed(members())
    at = good.rindex(b"PK\1\2", 0, good.rindex(b"shape.npy"))
    assert "“shape.npy” in it is damaged" in refused(good[: at + 24] + b"\1\0\0\0" + good[at + 28 :])
    assert "“shape.npy” in it is damaged" in refused(good[: at + 24] + b"\0\0\1\0" + good[at + 28 :])


def test_open_session_refuses_locked_and_foreign_members(refused):
    good = bytearray(packed(members()))
    at = good.rindex(b"PK\1\2", 0, good.rindex(b"shape.npy"))
    locked = good.copy()
    locked[at + 8] |= 1
    assert "“shape.npy” in it is damaged" in refused(bytes(locked))
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_BZIP2) as archive:
        for name, content in members().items():
            archive.writestr(name, content)
    assert "“session.json” in it is damaged" in refused(stream.getvalue())


# Damage of all kinds


def damaged(content: bytes, chance: random.Random) -> bytes:
    """The file with some bytes changed, lost or doubled."""
    body, at = bytearray(content), chance.randrange(len(content))
    match chance.randrange(4):
        case 0:
            return bytes(body[:at])
        case 1:
            return bytes(body[:at] + body[at + chance.choice((1, 4, 100)) :])
        case 2:
            return bytes(body[:at] + body[at - 20 : at] + body[at:])
    for _ in range(chance.choice((1, 1, 2, 8))):
        body[chance.randrange(len(body))] = chance.choice((chance.randrange(256), 0, 255))
    return bytes(body)


VALUES = (None, True, -1, 0, 1e308, 10**30, "", "word", "../x", "\0", [], {}, [[]], [1e-320] * 3, "é" * 300)


def changed(said: object, chance: random.Random) -> object:
    """What JSON says, with another value somewhere."""
    keys = list(said) if isinstance(said, dict) else range(len(said)) if isinstance(said, list) else []
    if not keys or chance.random() < 0.1:
        return chance.choice(VALUES)
    key = chance.choice(keys)
    said[key] = changed(said[key], chance)
    return said


@pytest.mark.parametrize("cases", [150, pytest.param(500, marks=pytest.mark.night)])
@pytest.mark.parametrize("what", ["the archive", "what is in it", "its words"])
def test_open_session_opens_soundly_or_refuses_in_a_sentence_hundreds_of_damaged_files(what, cases, tmp_path):
    path, good, parts = tmp_path / "a.apd", GOOD.read_bytes(), members()
    said = []
    for seed in range(cases):
        chance = random.Random(seed)
        if what == "the archive":
            content = damaged(good, chance)
        elif what == "what is in it":
            name = chance.choice(list(parts))
            content = packed(parts | {name: damaged(parts[name], chance)})
        else:
            words = changed(json.loads(parts["session.json"]), chance)
            content = packed(parts | {"session.json": json.dumps(words).encode()})
        path.write_bytes(content)
        try:
            said.append(outcome(path))
        except Exception as error:
            raise AssertionError(f"{what}, seed {seed}") from error
    refusals = cases - said.count("opened")
    assert refusals > cases / 5
    assert list(tmp_path.iterdir()) == [path]
