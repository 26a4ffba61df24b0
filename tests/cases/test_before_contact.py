"""Sessions, plans and half-done studies from before contact was the default: they give what they gave.

The archive was made by the last program without it, which wrote its ``results.csv`` too: never make it anew.
Of the four cases of the plan two were done, and the tube passes through itself in most of them.
"""

import csv
import zipfile
from pathlib import Path

import pytest

from apd_viewer.__main__ import main
from apd_viewer.cases.case_file import case_sizes
from apd_viewer.cases.run_case import case_session
from apd_viewer.commands.replay_command import replay_session
from apd_viewer.session.storage.session_file import open_session

OLD = Path(__file__).with_name("before-contact.zip")
READINGS = ("area_error", "volume_capped", "energy", "crossings")


@pytest.fixture
def old(tmp_path):
    with zipfile.ZipFile(OLD) as archive:
        archive.extractall(tmp_path)
    return tmp_path


def rows(path):
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def test_open_session_gives_a_session_without_the_word_no_contact(old):
    state, _ = open_session(old / "twisted.apd")
    assert state.document.settings.contact is False
    _, result = replay_session(old / "twisted.apd", from_rest=True)
    assert result.volume_capped == pytest.approx(14.552742878085184, rel=1e-7)
    assert result.volume_capped_rest == pytest.approx(14.553841441395733, rel=1e-12)


def test_case_session_shows_results_as_they_were(old):
    done = {row["key"] for row in rows(old / "results.csv")} & case_sizes(old / "study").keys()
    assert len(done) == 2
    for key in done:
        state, _ = case_session(old / "study", key)
        assert state.document.settings.contact is False


@pytest.mark.night
def test_study_goes_on_from_half_done_to_what_it_would_have_given(old, capsys):
    before = rows(old / "results.csv")
    plan = old / "plan.csv"
    first, *others = plan.read_text(encoding="utf-8").splitlines()
    # The second case rested on a saddle on its way, which would be left today. The first left it by rounding,
    # which depends on the processor, and today by being looked at.
    cells = ("", "0", "", "")
    lines = (f"{line},{cell}" for line, cell in zip(others, cells, strict=True))
    plan.write_text("\n".join([f"{first},imperfection", *lines]), encoding="utf-8")
    assert main(["study", str(old / "plan.csv"), "-o", str(old / "study"), "--processes", "1"]) == 0
    now = rows(old / "study" / "results.csv")
    assert [row["status"] for row in now] == ["done"] * 4
    for k, (old_row, row) in enumerate(zip(before, now, strict=True)):
        assert row["key"] != old_row["key"], "rows of different programs are never mixed"
        within = {"rel": 1e-3 if k == 0 else 1e-4, "abs": 1e-9}
        for name in READINGS[:-1]:
            assert float(row[name]) == pytest.approx(float(old_row[name]), **within), name
        crossings = [int(each["crossings"]) for each in (old_row, row)]
        assert (crossings[0] > 0) is (crossings[1] > 0) if k == 0 else crossings[0] == crossings[1]
