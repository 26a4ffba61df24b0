"""The command verify, on coarse cases: table, JSON, figures, status, and what it refuses."""

import csv
import json
from dataclasses import replace

import pytest

from apd_viewer.__main__ import main
from apd_viewer.verification import case_table, verification_run
from apd_viewer.verification.case_table import CASES


@pytest.fixture(autouse=True)
def coarse(monkeypatch):
    """Two cases, one of them coarse and the other not set up."""
    cases = {"C": replace(CASES["K"], letter="C"), "G": replace(CASES["G"], resolutions=(4, 6))}
    monkeypatch.setattr(case_table, "CASES", cases)
    monkeypatch.setattr(verification_run, "recorded_rows", dict)


def test_verify_prints_a_table_of_errors_and_reasons(capsys):
    assert main(["verify", "--case", "g,C"]) == 0
    lines = capsys.readouterr().out.splitlines()
    head, title, volume, distance = lines[:4]
    assert head.split()[:2] == ["quantity", "exact"]
    assert title.startswith("G  Slit sphere")
    assert len(head) == len(volume) == len(distance)
    assert "2.5637" in volume
    assert [line for line in lines if "Not yet" in line]
    assert lines[-1].endswith("of 2 quantities are within their bar.")


def test_verify_prints_json_for_scripts(capsys):
    assert main(["verify", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert [row["case"] for row in rows] == ["C", "G", "G"]
    assert rows[0]["error"] is None
    assert rows[1]["exact"] == pytest.approx(2.563654, abs=1e-6)
    assert rows[1]["error"] == pytest.approx(rows[1]["ours"] / rows[1]["exact"] - 1.0)


def test_verify_ends_with_the_status_1_only_where_a_row_is_worse_than_recorded(monkeypatch, capsys):
    better = {"G": [{"error": 1e-9, "seconds": 1.0}, {"error": 1.0}]}
    monkeypatch.setattr(verification_run, "recorded_rows", lambda: better)
    with pytest.raises(SystemExit) as ended:
        main(["verify", "--case", "G"])
    assert ended.value.code == 1
    assert "1 is worse" in capsys.readouterr().out


def test_verify_writes_a_figure_of_each_case_and_the_table(tmp_path):
    assert main(["verify", "-o", str(tmp_path / "out")]) == 0
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"G.png", "G.svg", "verification.csv"}
    with (tmp_path / "out" / "verification.csv").open(encoding="utf-8") as stream:
        assert [row["case"] for row in csv.DictReader(stream)] == ["C", "G", "G"]


def test_verify_tells_each_finished_case_as_a_line(capsys):
    assert main(["verify", "--progress-lines"]) == 0
    told = [json.loads(line) for line in capsys.readouterr().out.splitlines() if line.startswith('{"done"')]
    rows = [row for line in told for row in line.get("rows", ())]
    assert [row["case"] for row in rows] == ["C", "G", "G"]
    assert [line["done"] for line in told] == sorted(line["done"] for line in told)


@pytest.mark.parametrize(("letters", "named"), [("G,Z", "Z"), (",", ","), ("", "")])
def test_verify_refuses_an_unknown_case_in_a_sentence(letters, named, capsys):
    assert main(["verify", "--case", letters]) == 2
    assert capsys.readouterr().err == f"error: There is no case “{named}”; choose from C, G.\n"


def test_verify_is_interrupted_and_leaves_nothing(monkeypatch, tmp_path, capsys):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(verification_run, "case_rows", interrupted)
    assert main(["verify", "-o", str(tmp_path / "out")]) == 130
    assert list(tmp_path.iterdir()) == []
    assert "interrupted" in capsys.readouterr().err
