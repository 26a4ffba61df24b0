"""Selections and transforms in the survey's text formats."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays

from apd_viewer.errors import InputError
from apd_viewer.files.selections.survey_formats import read_region, read_selection, read_transform


@pytest.fixture
def file(tmp_path):
    def write(content):
        path = tmp_path / "a.txt"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return write


@pytest.mark.parametrize(
    "content",
    [
        "0\n1\n1\n2\n",
        "# survey\n# 0 0 0\n0\n1\n1\n2",
        "\n\n0\n\n1 # free\n1\n   2\n\n",
        "0\r\n1\r\n1\r\n2\r\n",
        "0 1\t1 2\n",
        "\ufeff0\n1\n1\n2\n",
        "#\n0\n#0\n1\n1\n2\n# größe\n",
    ],
)
def test_read_selection_reads_labels_in_the_order_of_the_file(content, file):
    labels = read_selection(file(content), 4)
    assert labels.tolist() == [0, 1, 1, 2]
    assert labels.dtype == np.uint8
    assert not labels.flags.writeable


@given(labels=st.lists(st.integers(0, 9), max_size=40))
def test_read_selection_reads_any_labels(labels, tmp_path_factory):
    path = tmp_path_factory.getbasetemp() / "any.sel"
    path.write_text("# made in a test\n" + "\n".join(map(str, labels)))
    assert read_selection(path, len(labels)).tolist() == labels


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("0\n1\n2\n", r"for a mesh of 3 vertices, but this mesh has 4"),
        ("0\n1\n2\n" * 500, r"for a mesh of 1,500 vertices, but this mesh has 4"),
        ("", "for a mesh of 0 vertices, but this mesh has 4"),
        ("# 0 1 1 2\n", "for a mesh of 0 vertices, but this mesh has 4"),
        ("0 1 1 10", r"a label other than 0 \(base\), 1 \(free\) and 2 to 9 \(handles\)"),
        ("0 1 -1 2", "a label other than"),
        ("0 1 0.5 2", "a label other than"),
        ("0 1 nan 2", "a label other than"),
        ("0 1 inf 2", "a label other than"),
        ("0 1 257 2", "a label other than"),
        ("base free free handle", "is not a selection with one integer"),
        ("0,1,1,2", "is not a selection"),
        (b"\xff\xfe0\x001\x00", "is not a selection"),
        (bytes(range(256)), "is not a selection"),
    ],
)
def test_read_selection_refuses_what_is_no_selection(content, words, file):
    with pytest.raises(InputError, match=words) as caught:
        read_selection(file(content), 4)
    assert "a.txt" in str(caught.value)


MATRIX = np.array([[0.5, -1e-3, 2, 7], [1, 0, 0.1, -8], [0, 1e300, 1, 1 / 3], [0, 0, 0, 1]])


def text(M):
    return "\n".join(" ".join(map(repr, map(float, row))) for row in M) + "\n"


@pytest.mark.parametrize(
    "content",
    [
        text(MATRIX),
        "# handle\n\n" + text(MATRIX).replace("\n", " # row\n\n"),
        text(MATRIX).replace("\n", "\r\n"),
        text(MATRIX).replace("\n", " ").replace(" ", "\t"),
    ],
)
def test_read_transform_reads_row_by_row(content, file):
    np.testing.assert_array_equal(read_transform(file(content)), MATRIX)


@given(top=arrays(float, (3, 4), elements=st.floats(allow_nan=False, allow_infinity=False)))
def test_read_transform_reads_any_affine_transform(top, tmp_path_factory):
    path = tmp_path_factory.getbasetemp() / "any.def"
    M = np.vstack([top, [0, 0, 0, 1]])
    path.write_text(text(M))
    np.testing.assert_array_equal(read_transform(path), M)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0", "is not a 4x4 matrix; write four rows of four numbers"),
        ("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 0", "is not a 4x4 matrix"),
        ("", "is not a 4x4 matrix"),
        ("1 0 0 0 0 1 0 0 0 0 1 nan 0 0 0 1", "is not a 4x4 matrix"),
        ("1 0 0 0 0 1 0 0 0 0 1 -inf 0 0 0 1", "is not a 4x4 matrix"),
        ("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0.1 1", "not an affine transform; its last row must be 0 0 0 1"),
        ("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 2", "not an affine transform"),
        ("1 0 0 0 0 1 0 0 0 0 1 0 5 6 7 1", "not an affine transform"),  # written by columns
        ("one 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "is not a transform"),
        (bytes(range(128, 200)), "is not a transform"),
    ],
)
def test_read_transform_refuses_what_is_no_transform(content, words, file):
    with pytest.raises(InputError, match=words) as caught:
        read_transform(file(content))
    assert "a.txt" in str(caught.value)


@pytest.mark.parametrize("read", [lambda path: read_selection(path, 4), read_transform])
def test_survey_formats_refuse_files_that_cannot_be_read_at_all(read, tmp_path):
    with pytest.raises(InputError, match=r"There is no file .*gone\.txt"):
        read(tmp_path / "gone.txt")
    with pytest.raises(InputError, match="is a folder, a pipe or a device; name a file instead"):
        read(tmp_path)
    with pytest.raises(InputError):
        read(tmp_path / ("x" * 300))


def test_read_region_takes_what_is_not_zero(file):
    assert read_region(file("# neck\n0 1 0 2.5\n-1"), 5).tolist() == [1, 3, 4]
    with pytest.raises(InputError, match="for a mesh of 2 vertices, but this mesh has 5"):
        read_region(file("0 1"), 5)
    with pytest.raises(InputError, match="is not a region with one number"):
        read_region(file("inside"), 1)
