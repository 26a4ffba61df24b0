"""Assemblies from CAD: their parts are regions, have colours, and stay so in sessions."""

import numpy as np
import pytest
from cad_contents import divided_into

from apd_viewer.files.formats import cad
from apd_viewer.session.model.view import View

BLUE, RED = [51, 102, 204], [230, 76, 26]
TRIANGLE = [(1, 1, 1), (5, 1, 1), (1, 5, 1)]


@pytest.fixture
def assembly(tmp_path, monkeypatch):
    """An assembly of parts with names, and perhaps colours, as a library would divide it."""

    def made(names, colors=None):
        monkeypatch.setattr(cad, "find_spec", lambda library: library == "cascadio")
        monkeypatch.setattr(cad, "START_SCRIPT", divided_into(TRIANGLE, names, colors))
        (tmp_path / "a.step").write_bytes(b"ISO-10303-21;")
        return tmp_path / "a.step"

    return made


def opened(session, path):
    session.files.open(path)
    session.settle()
    assert not session.failed
    return session.store.state.document


def test_read_cad_names_regions_after_the_parts(empty, assembly):
    document = opened(empty, assembly(["cup", "lid"]))
    assert [region.name for region in document.regions] == ["cup", "lid"]
    assert document.member.tolist() == [1, 1, 1, 2, 2, 2]
    assert empty.store.state.frame.regions == pytest.approx((8, 32))
    assert document.mesh.colors is None
    assert "Its 2 parts are regions: cup, lid." in document.mesh.remarks
    assert not empty.saved_work.is_unsaved


def test_read_cad_reads_the_colours_of_the_file(empty, assembly):
    document = opened(empty, assembly(["cup", "lid", "seal"], [BLUE, RED, [-1, -1, -1]]))
    assert document.mesh.colors[::3].tolist() == [BLUE, RED, [200, 200, 200]]


def test_read_cad_keeps_parts_and_colours_in_sessions(empty, assembly, tmp_path):
    before = opened(empty, assembly(["cup", "lid"], [BLUE, RED]))
    empty.files.save(tmp_path / "a.apd", View())
    empty.settle()
    (tmp_path / "a.step").unlink()
    after = opened(empty, tmp_path / "a.apd")
    assert after.mesh.digest == before.mesh.digest
    assert np.array_equal(after.mesh.colors, before.mesh.colors)
    assert [region.name for region in after.regions] == ["cup", "lid"]
    assert np.array_equal(after.member, before.member)


def test_read_cad_numbers_names_that_recur(empty, assembly):
    document = opened(empty, assembly(["bolt", "bo\nlt", "", "bolt"]))
    assert [region.name for region in document.regions] == ["bolt", "bolt 2", "Part", "bolt 3"]


def test_read_cad_takes_the_largest_parts_of_many(empty, assembly):
    document = opened(empty, assembly([f"part {k}" for k in range(10)]))
    assert [region.name for region in document.regions] == [f"part {k}" for k in range(2, 10)]
    assert document.member[::3].tolist() == [0, 0, *range(1, 9)]
    assert any("the largest are regions" in remark for remark in document.mesh.remarks)


def test_read_cad_makes_no_region_of_a_single_part(empty, assembly):
    document = opened(empty, assembly(["cup"], [BLUE]))
    assert document.regions == ()
    assert document.mesh.colors[0].tolist() == BLUE
    assert len(document.mesh.remarks) == 1
